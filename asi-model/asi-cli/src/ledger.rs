//! `asi ledger`: a disclosure ledger checked by those it concerns, without the factory's program.

mod receipt;
mod shown;

use std::{
    io::{Read as _, Write},
    path::PathBuf,
};

use ::ledger::audit::{Audit, AuditStart, Auditor};
use asi_model::DateTime;
use serde::Serialize;
use shown::{Export, ShownAudit, compare};
use transparency_log::VerifierKey;

use crate::{
    audit_lines::take_all,
    lines::{checkpoint, next_line, open},
    outcome::CommandOutcome,
};

/// Longest receipt that is read, in bytes.
const RECEIPT_BYTES_MAX: u64 = 1024 * 1024;

/// Commands on disclosure ledgers.
#[derive(Debug, clap::Subcommand)]
pub enum LedgerCommand {
    /// Check an audit file against a checkpoint that was kept elsewhere.
    Verify(Box<AuditOptions>),
    /// Check the signed receipt of a revocation, as the platform lists it, and print it.
    Receipt(Box<ReceiptOptions>),
}

/// Options of the check of an audit file.
#[derive(Debug, clap::Args)]
pub struct AuditOptions {
    /// The file that `factory-connector ledger audit` wrote.
    file: PathBuf,
    /// A checkpoint of the same log, kept where the factory cannot change it.
    #[arg(long, value_name = "FILE")]
    checkpoint: PathBuf,
    /// The key of the log, as noted at the beginning: name+id+key.
    #[arg(long, value_name = "VKEY")]
    key: VerifierKey,
    /// The key of a witness that must have countersigned the checkpoint: name+id+key.
    #[arg(long, value_name = "VKEY")]
    witness: Option<VerifierKey>,
    /// Values of reports that were queued before this time (RFC 3339) may be missing without an
    /// entry about their retention: a time that the factory names in another way.
    #[arg(long, value_name = "TIME")]
    emptied_before: Option<DateTime>,
    /// Reports of the factory as the platform showed them, to be compared with what left: pages of the
    /// history as its API answers them, one after another. Save them before the audit file is written.
    #[arg(long, value_name = "FILE")]
    shown: Option<PathBuf>,
}

/// Result of the check of an audit file.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct LedgerAudit {
    #[serde(flatten)]
    audit: Audit,
    /// The comparison with what was shown; absent where none was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    shown: Option<ShownAudit>,
}

/// Options of the check of a revocation's receipt.
#[derive(Debug, clap::Args)]
pub struct ReceiptOptions {
    /// The receipt with its signature, a JSON object.
    file: PathBuf,
    /// The key of the factory's log for this organisation: name+id+key.
    #[arg(long, value_name = "VKEY")]
    key: VerifierKey,
}

/// Carries out a command.
pub fn run(command: LedgerCommand, out: &mut dyn Write) -> anyhow::Result<CommandOutcome> {
    match command {
        LedgerCommand::Verify(options) => verify(&options, out),
        LedgerCommand::Receipt(options) => {
            let mut receipt = Vec::new();
            open(&options.file)?.take(RECEIPT_BYTES_MAX).read_to_end(&mut receipt)?;
            receipt::verify(&receipt, &options.key, out)
        }
    }
}

fn verify(options: &AuditOptions, out: &mut dyn Write) -> anyhow::Result<CommandOutcome> {
    let note = checkpoint(&options.checkpoint)?;
    let mut lines = open(&options.file)?;
    let first = next_line(&mut lines)?.unwrap_or_default();
    let begun = Auditor::new(&note, &options.key, &first, options.emptied_before).and_then(
        |mut auditor| {
            options.witness.as_ref().map_or(Ok(()), |witness| auditor.demand_witness(witness))?;
            Ok(auditor)
        },
    );
    let mut auditor = match begun {
        Ok(auditor) => auditor,
        Err(error) => {
            writeln!(out, "{:#}", anyhow::Error::new(error))?;
            return Ok(CommandOutcome::Invalid);
        }
    };
    let shown = match &options.shown {
        Some(export) => {
            let begin: AuditStart = serde_json::from_str(&first)?;
            let export = Export::read(open(export)?, &auditor.start().factory_id)?;
            Some(compare(&export, &mut auditor, &mut lines, begin.number > 0)?)
        }
        None => {
            take_all(&mut auditor, &mut lines, &|_| (), |()| ())?;
            None
        }
    };
    let outcome = LedgerAudit { audit: auditor.finish(), shown };
    writeln!(out, "{}", serde_json::to_string_pretty(&outcome)?)?;
    let is_shown_intact = outcome.shown.as_ref().is_none_or(ShownAudit::is_intact);
    Ok(if outcome.audit.is_intact() && is_shown_intact {
        CommandOutcome::Valid
    } else {
        CommandOutcome::Invalid
    })
}
