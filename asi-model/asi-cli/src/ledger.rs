//! `asi ledger`: a disclosure ledger checked by those it concerns, without the factory's program.

mod lines;

use std::{
    fs::File,
    io::{BufReader, Read as _, Write},
    path::{Path, PathBuf},
};

use ::ledger::audit::Auditor;
use anyhow::Context as _;
use asi_model::DateTime;
use lines::{next_line, take_all};
use transparency_log::VerifierKey;

use crate::outcome::CommandOutcome;

/// Bytes that are read from the file at once.
const BUFFER_BYTES: usize = 1 << 20;
/// Longest checkpoint that is read, in bytes.
const CHECKPOINT_BYTES_MAX: u64 = 64 * 1024;

/// Commands on disclosure ledgers.
#[derive(Debug, clap::Subcommand)]
pub enum LedgerCommand {
    /// Check an audit file against a checkpoint that was kept elsewhere.
    Verify {
        /// The file that `factory-connector ledger audit` wrote.
        file: PathBuf,
        /// A checkpoint of the same log, kept where the factory cannot change it.
        #[arg(long, value_name = "FILE")]
        checkpoint: PathBuf,
        /// The key of the log, as noted at the beginning: name+id+key.
        #[arg(long, value_name = "VKEY")]
        key: VerifierKey,
        /// Values of reports that were queued before this time (RFC 3339) may be missing without an
        /// entry about their retention: a time that the factory names in another way.
        #[arg(long, value_name = "TIME")]
        emptied_before: Option<DateTime>,
    },
}

/// Carries out a command.
pub fn run(command: LedgerCommand, out: &mut dyn Write) -> anyhow::Result<CommandOutcome> {
    let LedgerCommand::Verify { file, checkpoint, key, emptied_before } = command;
    let open =
        |path: &Path| File::open(path).with_context(|| format!("cannot read {}", path.display()));
    let mut note = String::new();
    open(&checkpoint)?.take(CHECKPOINT_BYTES_MAX).read_to_string(&mut note)?;
    let mut lines = BufReader::with_capacity(BUFFER_BYTES, open(&file)?);
    let first = next_line(&mut lines)?.unwrap_or_default();
    let mut auditor = match Auditor::new(&note, &key, &first, emptied_before) {
        Ok(auditor) => auditor,
        Err(error) => {
            writeln!(out, "{:#}", anyhow::Error::new(error))?;
            return Ok(CommandOutcome::Invalid);
        }
    };
    take_all(&mut auditor, &mut lines)?;
    let outcome = auditor.finish();
    writeln!(out, "{}", serde_json::to_string_pretty(&outcome)?)?;
    Ok(if outcome.is_intact() { CommandOutcome::Valid } else { CommandOutcome::Invalid })
}
