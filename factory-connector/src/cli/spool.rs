//! `factory-connector spool`.

use std::io::Write;

use anyhow::Context as _;
use clap::Subcommand;
use factory_connector::{
    config::ConnectorConfig,
    store::{SpooledMessage, Store, StoreSession},
};

#[derive(Debug, Subcommand)]
pub(super) enum SpoolCommand {
    /// List what waits, is sent without a receipt, or is set aside; without its content.
    List,
    /// Print one message or report with its content.
    Show {
        /// Number of the message or report, as listed.
        id: i64,
    },
    /// Write everything with its content, one JSON object per line.
    Export,
}

pub(super) async fn run(command: SpoolCommand, config: &ConnectorConfig) -> anyhow::Result<()> {
    let mut session = Store::connect(&config.data_directory).await?;
    let mut output = std::io::BufWriter::new(std::io::stdout());
    match command {
        SpoolCommand::List => {
            writeln!(
                output,
                "{:>10} {:8} {:>10} {:20} {:>8} about",
                "number", "state", "bytes", "made at", "attempts"
            )?;
            let mut after = 0;
            while let Some(last) = for_block(&mut session, after, |message| {
                writeln!(
                    output,
                    "{:>10} {:8} {:>10} {:20} {:>8} {}",
                    message.id,
                    message.state,
                    message.bytes,
                    message.created_at,
                    message.attempts,
                    message.about
                )
            })
            .await?
            {
                after = last;
            }
        }
        SpoolCommand::Show { id } => {
            let found =
                session.spool().list(id - 1, 1).await?.into_iter().find(|message| message.id == id);
            let found =
                found.with_context(|| format!("the spool holds nothing with the number {id}"))?;
            writeln!(output, "{}", serde_json::to_string_pretty(&found)?)?;
        }
        SpoolCommand::Export => {
            let mut after = 0;
            while let Some(last) = for_block(&mut session, after, |message| {
                writeln!(output, "{}", serde_json::to_string(message)?)
            })
            .await?
            {
                after = last;
            }
        }
    }
    output.flush().context("writing to standard output")
}

/// Hands out the next messages and returns the number of the last one.
async fn for_block(
    session: &mut StoreSession,
    after: i64,
    mut each: impl FnMut(&SpooledMessage) -> std::io::Result<()>,
) -> anyhow::Result<Option<i64>> {
    const BLOCK: u32 = 500;
    let block = session.spool().list(after, BLOCK).await?;
    for message in &block {
        each(message).context("writing to standard output")?;
    }
    Ok(block.last().map(|message| message.id))
}
