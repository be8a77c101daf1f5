//! `factory-connector ledger`.

mod audit;

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::PathBuf,
};

use anyhow::Context as _;
use asi_model::{DateTime, OrganisationId};
use clap::{Subcommand, ValueEnum};
use disclosure::Language;
use factory_connector::{
    config::ConnectorConfig,
    ledger_export::{ExportFormat, Exporter},
    ledger_key::{self, LEDGER_KEY_FILE},
    store::{LedgerCursor, LedgerFilter, Store, Trusted},
};
use ledger::Hash;

use super::output::print;

#[derive(Debug, Subcommand)]
pub(super) enum LedgerCommand {
    /// Find any change, deletion or reordering; exit status 1 where there is one.
    Verify {
        /// The public key that everything must be signed with, hexadecimal, as an earlier
        /// verification named it. Without it, that of the key beside the ledger.
        #[arg(long, value_parser = public_key)]
        public_key: Option<Hash>,
        /// A checkpoint of a log that was kept elsewhere, which reveals a store that was set back;
        /// may be given several times.
        #[arg(long, value_name = "FILE")]
        checkpoint: Vec<PathBuf>,
    },
    /// Write a recipient's chain with all that proves it, for `asi ledger verify`.
    Audit {
        /// The recipient whose chain is written.
        #[arg(long)]
        recipient: OrganisationId,
        /// The file to write; standard output without it.
        #[arg(long, short)]
        output: Option<PathBuf>,
    },
    /// Print the last signed checkpoint of a recipient's log, to be kept elsewhere.
    Checkpoint {
        /// The recipient whose log it is.
        #[arg(long)]
        recipient: OrganisationId,
        /// Print the key that verifies it in its place.
        #[arg(long)]
        key: bool,
    },
    /// Write out every value that left, with its consent.
    Export {
        /// Form of the file.
        #[arg(long, value_enum, default_value = "jsonl")]
        format: FormatArgument,
        /// Restrict to this recipient's chain.
        #[arg(long)]
        recipient: Option<OrganisationId>,
        /// Recorded at this time or later (RFC 3339).
        #[arg(long, value_parser = time)]
        from: Option<DateTime>,
        /// Recorded before this time (RFC 3339).
        #[arg(long, value_parser = time)]
        until: Option<DateTime>,
        /// The language of a page to print.
        #[arg(long, value_enum, default_value = "en")]
        language: PageLanguage,
        /// The file to write; standard output without it.
        #[arg(long, short)]
        output: Option<PathBuf>,
    },
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum FormatArgument {
    /// One JSON object per line, with the exact hashed text.
    Jsonl,
    /// A table for spreadsheets.
    Csv,
    /// A page to print.
    Html,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum PageLanguage {
    En,
    De,
}

fn public_key(text: &str) -> Result<Hash, String> {
    let bytes = hex::decode(text.trim()).ok().and_then(|bytes| bytes.try_into().ok());
    bytes.ok_or_else(|| "a public key has 64 hexadecimal digits".to_owned())
}

fn time(text: &str) -> Result<DateTime, String> {
    text.parse().map_err(|_| "a time looks like 2026-11-22T06:00:00Z".to_owned())
}

pub(super) async fn run(command: LedgerCommand, config: &ConnectorConfig) -> anyhow::Result<()> {
    match command {
        LedgerCommand::Verify { public_key, checkpoint } => {
            verify(config, public_key, &checkpoint).await
        }
        LedgerCommand::Audit { recipient, output } => {
            audit::write_audit_file(config, &recipient, output).await
        }
        LedgerCommand::Checkpoint { recipient, key } => {
            audit::print_checkpoint(config, &recipient, key).await
        }
        LedgerCommand::Export { format, recipient, from, until, language, output } => {
            let format = match format {
                FormatArgument::Jsonl => ExportFormat::Jsonl,
                FormatArgument::Csv => ExportFormat::Csv,
                FormatArgument::Html => ExportFormat::Html,
            };
            let language = match language {
                PageLanguage::En => Language::En,
                PageLanguage::De => Language::De,
            };
            let filter = LedgerFilter { recipient, from, until, ..LedgerFilter::default() };
            let mut output: Box<dyn Write> = match output {
                Some(path) => {
                    let file = File::create(&path)
                        .with_context(|| format!("making {}", path.display()))?;
                    Box::new(BufWriter::new(file))
                }
                None => Box::new(BufWriter::new(std::io::stdout())),
            };
            export(config, filter, Exporter::new(format, language), &mut output).await
        }
    }
}

async fn verify(
    config: &ConnectorConfig,
    public_key: Option<Hash>,
    checkpoints: &[PathBuf],
) -> anyhow::Result<()> {
    let read = |path: &PathBuf| {
        std::fs::read_to_string(path).with_context(|| format!("reading {}", path.display()))
    };
    let checkpoints = checkpoints.iter().map(read).collect::<Result<_, _>>()?;
    let mut session = Store::connect(&config.data_directory).await?;
    let key = match public_key {
        Some(key) => Some(key),
        None => ledger_key::public_half(&config.data_directory.join(LEDGER_KEY_FILE))?,
    };
    let outcome = session.ledger().verify_against(Trusted { key, checkpoints }).await?;
    print(&serde_json::to_string_pretty(&outcome)?)?;
    anyhow::ensure!(
        outcome.is_intact(),
        "the ledger was changed: {} fault(s)",
        outcome.fault_count
    );
    Ok(())
}

async fn export(
    config: &ConnectorConfig,
    filter: LedgerFilter,
    exporter: Exporter,
    output: &mut dyn Write,
) -> anyhow::Result<()> {
    let writing = "writing the export";
    let mut session = Store::connect(&config.data_directory).await?;
    let enrolment = session.enrolments().current().await?;
    let factory = enrolment.map(|enrolment| enrolment.factory_id).unwrap_or_default();
    output.write_all(exporter.begin(&factory).as_bytes()).context(writing)?;
    let mut cursor = LedgerCursor::new(filter);
    loop {
        let rows = session.ledger().next(&mut cursor).await?;
        if rows.is_empty() {
            break;
        }
        for row in rows {
            output.write_all(exporter.entry(&row).as_bytes()).context(writing)?;
        }
    }
    output.write_all(exporter.end().as_bytes()).context(writing)?;
    output.flush().context(writing)
}
