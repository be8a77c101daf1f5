//! `asi access`: the record of who read a factory's values at the platform, checked by those whom
//! it concerns, without the platform's program.

use std::{io::Write, path::PathBuf};

use access_log::AccessAuditor;
use transparency_log::VerifierKey;

use crate::{
    lines::{checkpoint, next_line, open},
    outcome::CommandOutcome,
};

/// Commands on access logs.
#[derive(Debug, clap::Subcommand)]
pub enum AccessCommand {
    /// Check an audit file against a checkpoint that was kept elsewhere.
    Verify(Box<AccessAuditOptions>),
}

/// Options of the check of an audit file.
#[derive(Debug, clap::Args)]
pub struct AccessAuditOptions {
    /// The file that the platform exported.
    file: PathBuf,
    /// A checkpoint of the same log, kept where the platform cannot change it.
    #[arg(long, value_name = "FILE")]
    checkpoint: PathBuf,
    /// The key of the log, as noted at the beginning: name+id+key.
    #[arg(long, value_name = "VKEY")]
    key: VerifierKey,
}

/// Carries out a command.
pub fn run(command: AccessCommand, out: &mut dyn Write) -> anyhow::Result<CommandOutcome> {
    let AccessCommand::Verify(options) = command;
    let note = checkpoint(&options.checkpoint)?;
    let mut lines = open(&options.file)?;
    let first = next_line(&mut lines)?.unwrap_or_default();
    let mut auditor = match AccessAuditor::new(&note, &options.key, &first) {
        Ok(auditor) => auditor,
        Err(error) => {
            writeln!(out, "{:#}", anyhow::Error::new(error))?;
            return Ok(CommandOutcome::Invalid);
        }
    };
    while let Some(line) = next_line(&mut lines)? {
        auditor.take(&line);
    }
    let audit = auditor.finish();
    writeln!(out, "{}", serde_json::to_string_pretty(&audit)?)?;
    Ok(if audit.is_intact() { CommandOutcome::Valid } else { CommandOutcome::Invalid })
}
