//! `asi access`: the record of who read a factory's values at the platform, checked by those whom
//! it concerns, without the platform's program.

mod coverage;
mod ledgers;
mod left_values;

use std::{io::Write, path::PathBuf};

use ::ledger::audit::Audit;
use access_log::{AccessAudit, AccessAuditor};
use asi_model::FactoryId;
use coverage::{CoverageAudit, CoverageCheck};
use left_values::{LeftIndex, LeftValues};
use serde::Serialize;
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
    /// An audit file of the factory's ledger, with which accesses are compared: one of each recipient,
    /// written after the access log was exported. May be given several times.
    #[arg(long, value_name = "AUDIT", requires = "ledger_key")]
    ledger: Vec<PathBuf>,
    /// The key of the factory's ledger, as any of its logs names it: name+id+key. May be given several
    /// times, where the ledger had another one before.
    #[arg(long, value_name = "VKEY", requires = "ledger")]
    ledger_key: Vec<VerifierKey>,
}

/// Result of the check of an access log.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct AccessLogAudit {
    #[serde(flatten)]
    audit: AccessAudit,
    /// The comparison with what left; absent where no file of a ledger was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    left: Option<CoverageAudit>,
    /// The audits of the files of the ledger.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ledger_list: Vec<Audit>,
}

impl AccessLogAudit {
    fn is_intact(&self) -> bool {
        self.audit.is_intact()
            && self.left.as_ref().is_none_or(CoverageAudit::is_intact)
            && self.ledger_list.iter().all(Audit::is_intact)
    }
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
    let (index, ledger_list) = read_ledgers(&options, auditor.factory())?;
    let mut check = index.map(CoverageCheck::new);
    while let Some(line) = next_line(&mut lines)? {
        let access = auditor.read(&line);
        if let (Some(check), Some(access)) = (&mut check, access) {
            check.take(&access);
        }
    }
    let left = check.map(CoverageCheck::finish);
    let audit = AccessLogAudit { audit: auditor.finish(), left, ledger_list };
    writeln!(out, "{}", serde_json::to_string_pretty(&audit)?)?;
    Ok(if audit.is_intact() { CommandOutcome::Valid } else { CommandOutcome::Invalid })
}

fn read_ledgers(
    options: &AccessAuditOptions,
    factory: &FactoryId,
) -> anyhow::Result<(Option<LeftIndex>, Vec<Audit>)> {
    if options.ledger.is_empty() {
        return Ok((None, Vec::new()));
    }
    let mut left = LeftValues::default();
    let audits = options
        .ledger
        .iter()
        .map(|file| ledgers::read(file, factory, &options.ledger_key, &mut left))
        .collect::<anyhow::Result<_>>()?;
    Ok((Some(LeftIndex::new(left)), audits))
}
