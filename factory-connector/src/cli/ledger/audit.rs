//! `factory-connector ledger audit` and `factory-connector ledger checkpoint`.

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::PathBuf,
};

use anyhow::Context as _;
use asi_model::OrganisationId;
use factory_connector::{
    config::ConnectorConfig,
    ledger_key::{self, LEDGER_KEY_FILE},
    store::Store,
};

use super::super::output::print;

/// Writes a recipient's chain with everything that its verification needs, from the first entry
/// that retention left.
pub(super) async fn write_audit_file(
    config: &ConnectorConfig,
    recipient: &OrganisationId,
    output: Option<PathBuf>,
) -> anyhow::Result<()> {
    let writing = "writing the audit file";
    let mut session = Store::connect(&config.data_directory).await?;
    // Entries about a delivery may come while its report is written.
    session.begin_view().await?;
    let key = ledger_key::existing(&config.data_directory.join(LEDGER_KEY_FILE))?;
    let start = session.ledger().audit_start(recipient, key.as_ref()).await?;
    let start = start.with_context(|| format!("there is no log for {recipient}"))?;
    anyhow::ensure!(
        start.checkpoint.is_some(),
        "the newest entries are not signed yet, and the key is not beside the ledger"
    );
    let mut output: Box<dyn Write> = match output {
        Some(path) => Box::new(BufWriter::new(
            File::create(&path).with_context(|| format!("making {}", path.display()))?,
        )),
        None => Box::new(BufWriter::new(std::io::stdout())),
    };
    writeln!(output, "{}", serde_json::to_string(&start)?).context(writing)?;
    let mut number = start.number;
    loop {
        let entries = session.ledger().audit_entries(recipient, number).await?;
        if entries.is_empty() {
            break;
        }
        number += entries.len() as u64;
        for entry in entries {
            writeln!(output, "{}", serde_json::to_string(&entry)?).context(writing)?;
        }
    }
    output.flush().context(writing)
}

/// Prints the last checkpoint of a recipient's log, or the key that verifies it.
pub(super) async fn print_checkpoint(
    config: &ConnectorConfig,
    recipient: &OrganisationId,
    is_key: bool,
) -> anyhow::Result<()> {
    let mut session = Store::connect(&config.data_directory).await?;
    let found = session.ledger().log_checkpoint(recipient).await?;
    let found = found.with_context(|| format!("there is no checkpoint for {recipient}"))?;
    if is_key { print(&found.key.to_string()) } else { print(found.note.trim_end_matches('\n')) }
}
