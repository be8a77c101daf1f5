//! `asi ledger`: a disclosure ledger checked by those it concerns, without the factory's program.

use std::{
    fs::File,
    io::{BufRead, BufReader, Read as _, Write},
    path::{Path, PathBuf},
};

use ::ledger::audit::Auditor;
use anyhow::{Context as _, bail};
use asi_model::DateTime;
use transparency_log::VerifierKey;

use crate::outcome::CommandOutcome;

/// Longest line that is read: an entry with its report, in bytes.
const LINE_BYTES_MAX: u64 = 16 * 1024 * 1024;
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
        /// Values may be missing of reports that were queued before this time (RFC 3339); without
        /// it none may.
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
    let mut lines = BufReader::new(open(&file)?);
    let first = next_line(&mut lines)?.unwrap_or_default();
    let mut auditor = match Auditor::new(&note, &key, &first, emptied_before) {
        Ok(auditor) => auditor,
        Err(error) => {
            writeln!(out, "{:#}", anyhow::Error::new(error))?;
            return Ok(CommandOutcome::Invalid);
        }
    };
    while let Some(line) = next_line(&mut lines)? {
        auditor.take(&line);
    }
    let outcome = auditor.finish();
    writeln!(out, "{}", serde_json::to_string_pretty(&outcome)?)?;
    Ok(if outcome.is_intact() { CommandOutcome::Valid } else { CommandOutcome::Invalid })
}

/// Reads the next line; `None` at the end. What is no UTF-8 fails in the check of its line.
fn next_line(lines: &mut impl BufRead) -> anyhow::Result<Option<String>> {
    let mut line = Vec::new();
    let length = lines.by_ref().take(LINE_BYTES_MAX).read_until(b'\n', &mut line)?;
    if length as u64 == LINE_BYTES_MAX {
        bail!("a line is longer than {LINE_BYTES_MAX} bytes");
    }
    Ok((length > 0).then(|| String::from_utf8_lossy(&line).trim_end_matches('\n').to_owned()))
}
