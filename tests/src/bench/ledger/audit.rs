//! Duration of an audit by `asi ledger verify`, from the file of a chain and a checkpoint of it.

use std::{
    fs::File,
    io::{BufWriter, Write as _},
    path::Path,
    process::Command,
    time::Instant,
};

use anyhow::Context as _;
use factory_connector::store::StoreSession;
use serde_json::Value;

use super::super::figures::result;
use crate::harness::binary;

/// Least entries of the chain that is audited.
const ENTRIES: u64 = 1_000_000;

/// Writes the audit file of the first recipient's chain and measures its audit: half of the entries of
/// the ledger, each with its report.
pub(super) async fn measure(
    folder: &Path,
    session: &mut StoreSession,
) -> anyhow::Result<Vec<Value>> {
    let recipients = session.ledger().recipients().await?;
    let recipient = recipients.first().context("a chain")?.parse()?;
    let kept = session.ledger().log_checkpoint(&recipient).await?.context("a checkpoint")?;
    let (file, checkpoint) = (folder.join("audit.jsonl"), folder.join("checkpoint"));
    std::fs::write(&checkpoint, &kept.note)?;
    let mut output = BufWriter::new(File::create(&file)?);
    let start = session.ledger().audit_start(&recipient, None).await?.context("a log")?;
    writeln!(output, "{}", serde_json::to_string(&start)?)?;
    let mut number = start.number;
    loop {
        let entries = session.ledger().audit_entries(&recipient, number).await?;
        if entries.is_empty() {
            break;
        }
        number += entries.len() as u64;
        for entry in entries {
            writeln!(output, "{}", serde_json::to_string(&entry)?)?;
        }
    }
    output.flush()?;
    let began = Instant::now();
    let audited = Command::new(binary("asi")?)
        .args(["ledger", "verify"])
        .arg(&file)
        .arg("--checkpoint")
        .arg(&checkpoint)
        .args(["--key", &kept.key.to_string()])
        .output()?;
    let took = began.elapsed().as_secs_f64();
    let outcome = String::from_utf8_lossy(&audited.stdout);
    anyhow::ensure!(audited.status.success(), "the file is not intact: {outcome}");
    let outcome: Value = serde_json::from_str(&outcome)?;
    let entries = outcome["entriesProven"].as_u64().context("a number")?;
    anyhow::ensure!(entries >= ENTRIES, "only {entries} entries were audited");
    anyhow::ensure!(outcome["valuesCompared"].as_u64() >= Some(ENTRIES / 2), "{outcome}");
    let millions = entries as f64 / 1e6;
    Ok(vec![
        result("chain audited from its file, with all values", millions, "million entries"),
        result("audit of a million entries", took / millions, "s"),
    ])
}
