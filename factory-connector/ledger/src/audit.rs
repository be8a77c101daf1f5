//! Audit of a chain from a file, by those who have neither the factory's program nor its store: one
//! checkpoint that was kept elsewhere proves every entry up to it.
//!
//! The file has one JSON object per line. The first is an [`AuditStart`], each further one an
//! [`AuditEntry`], in the order of the chain. Lines are first checked separately, on several threads
//! if the caller wants ([`Auditor::check`]), and then taken in their order.
//!
//! Entries after the checkpoint count where the file has a newer checkpoint of the same log over them.
//! What neither covers could have been written by anybody: it is a fault, and states nothing.

mod file;
mod line;
#[cfg(test)]
mod tests;

use asi_model::DateTime;
pub use file::{AuditEntry, AuditStart};
pub use line::CheckedLine;
use serde::Serialize;
use transparency_log::{
    Checkpoint, CheckpointError, LeafRange, NoteError, SignedNote, VerifierKey,
};

use super::{LedgerFault, LogStart, history::ReportHistory, values::CheckedValues};

/// Most faults that are listed; further ones are only counted.
const FAULTS_MAX: usize = 100;

const UNSIGNED: &str = "no signature covers the entry";

/// Reason that an audit cannot begin.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AuditError {
    /// The checkpoint is not a note of this key.
    #[error("the checkpoint is not signed with this key")]
    Signature(#[source] NoteError),
    /// The checkpoint is not countersigned with the key of the witness.
    #[error("the checkpoint is not countersigned by this witness")]
    Witness,
    /// The signed text is no checkpoint.
    #[error("the signed text is no checkpoint")]
    Checkpoint(#[source] CheckpointError),
    /// The first line does not say where the entries continue.
    #[error("the first line of the file does not begin a log")]
    Start,
    /// The checkpoint in the file is none of this log and key.
    #[error("the checkpoint in the file is none of this log, signed with this key")]
    FileCheckpoint,
    /// The file is about another log than the checkpoint.
    #[error("the checkpoint is one of {checkpoint}, the file is about {file}")]
    OtherLog {
        /// Origin in the checkpoint.
        checkpoint: String,
        /// Origin of the file's log.
        file: String,
    },
}

/// Result of an audit.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Audit {
    /// Name of the log.
    pub origin: String,
    /// Time at which the witness countersigned the checkpoint, by its own clock; absent where none
    /// was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub witnessed_at: Option<DateTime>,
    /// Number of entries that the checkpoint proves.
    pub entries_proven: u64,
    /// Number of later entries, which the checkpoint in the file covers. A later one that was kept
    /// elsewhere can prove them.
    pub entries_after: u64,
    /// Number of entries that no signature covers. Each is a fault.
    pub entries_unsigned: u64,
    /// Number of reports whose values are those that were committed to.
    pub values_compared: u64,
    /// Number of reports whose values were emptied.
    pub values_emptied: u64,
    /// Number of all faults.
    pub fault_count: u64,
    /// The first hundred faults.
    pub fault_list: Vec<LedgerFault>,
}

impl Audit {
    /// Returns whether there is no fault.
    #[must_use]
    pub const fn is_intact(&self) -> bool {
        self.fault_count == 0
    }
}

/// Checks an audit file line by line.
pub struct Auditor {
    start: LogStart,
    note: SignedNote,
    checkpoint: Checkpoint,
    /// The newer checkpoint in the file; none in files of former versions.
    newest: Option<Checkpoint>,
    leaves: LeafRange,
    /// Number of the last entry.
    number: u64,
    /// Values of reports that were queued before this time may be missing without a statement of
    /// retention.
    emptied_before: Option<DateTime>,
    history: ReportHistory,
    is_proven: bool,
    /// Every entry of the checkpoint in the file was found.
    is_complete: bool,
    outcome: Audit,
}

impl Auditor {
    /// Begins with a signed checkpoint, the key of the log, and the first line of the file. Values
    /// may be missing where an entry of the chain states their retention, and of reports that were
    /// queued before `emptied_before`.
    ///
    /// # Errors
    /// [`AuditError`] where the checkpoint is not signed with the key, or belongs to another log.
    pub fn new(
        checkpoint: &str,
        key: &VerifierKey,
        first_line: &str,
        emptied_before: Option<DateTime>,
    ) -> Result<Self, AuditError> {
        let (note, checkpoint) = signed_checkpoint(checkpoint, key)?;
        let first: AuditStart = serde_json::from_str(first_line).map_err(|_| AuditError::Start)?;
        let start: LogStart =
            serde_json::from_str(&first.log_start).map_err(|_| AuditError::Start)?;
        if start.origin() != checkpoint.origin || checkpoint.origin != key.name() {
            return Err(AuditError::OtherLog {
                checkpoint: checkpoint.origin,
                file: start.origin(),
            });
        }
        let leaves = first.leaves_before(&start).ok_or(AuditError::Start)?;
        let newest = first.checkpoint.as_deref().map(|note| signed_checkpoint(note, key));
        let newest = newest.transpose().map_err(|_| AuditError::FileCheckpoint)?;
        let newest = newest.map(|(_, checkpoint)| checkpoint);
        if newest.as_ref().is_some_and(|newest| newest.origin != checkpoint.origin) {
            return Err(AuditError::FileCheckpoint);
        }
        let mut auditor = Self {
            history: ReportHistory::after(first.number),
            number: first.number,
            is_proven: false,
            is_complete: newest.is_none(),
            outcome: Audit { origin: checkpoint.origin.clone(), ..Audit::default() },
            emptied_before,
            start,
            note,
            checkpoint,
            newest,
            leaves,
        };
        auditor.compare_roots();
        Ok(auditor)
    }

    /// Demands that the checkpoint is countersigned with this key of a witness.
    ///
    /// # Errors
    /// [`AuditError::Witness`].
    pub fn demand_witness(&mut self, witness: &VerifierKey) -> Result<(), AuditError> {
        let verified = self.note.verify([witness]).map_err(|_| AuditError::Witness)?;
        let seconds = verified.first().and_then(|signature| signature.cosigned_at);
        let micros = seconds.and_then(|at| i64::try_from(at).ok()?.checked_mul(1_000_000));
        self.outcome.witnessed_at =
            Some(DateTime::from_unix_micros(micros.ok_or(AuditError::Witness)?));
        Ok(())
    }

    /// Returns the start of the log, which names its factory and recipient.
    #[must_use]
    pub const fn start(&self) -> &LogStart {
        &self.start
    }

    /// Checks a line for itself; lines may be checked in any order.
    #[must_use]
    pub fn check(&self, line: &str) -> CheckedLine {
        CheckedLine::new(line, self.start.recipient.as_str())
    }

    /// Checks and takes the next line.
    pub fn take(&mut self, line: &str) {
        let checked = self.check(line);
        self.take_checked(checked);
    }

    /// Takes the next line after it was checked for itself. Returns whether a signature covers it: what
    /// it says counts only then.
    pub fn take_checked(&mut self, line: CheckedLine) -> bool {
        self.number += 1;
        if !self.is_signed_next() {
            self.outcome.entries_unsigned += 1;
            self.fault(UNSIGNED);
            return false;
        }
        let CheckedLine { leaf, number, recorded_at, faults, values, event } = line;
        if let Some(leaf) = leaf {
            self.leaves.append(leaf);
            if self.leaves.end() <= self.checkpoint.size {
                self.outcome.entries_proven += 1;
            } else {
                self.outcome.entries_after += 1;
            }
            self.compare_roots();
        }
        match values {
            CheckedValues::None => {}
            CheckedValues::Compared => self.outcome.values_compared += 1,
            CheckedValues::Emptied => self.outcome.values_emptied += 1,
        }
        for fault in faults {
            self.fault(fault);
        }
        if number.is_some_and(|number| number != self.number) {
            self.fault("the entry stands in another's place");
        }
        if let Err(fault) = self.history.take(self.number, recorded_at, event) {
            self.fault(fault);
        }
        true
    }

    /// Ends the audit.
    #[must_use]
    pub fn finish(mut self) -> Audit {
        let granted = self.emptied_before.map(DateTime::unix_micros);
        for (number, fault) in std::mem::take(&mut self.history).finish(granted) {
            self.number = number;
            self.fault(fault);
        }
        if !self.is_proven {
            self.number = self.checkpoint.size.saturating_sub(1);
            self.fault("the checkpoint covers entries that the file does not have");
        }
        if !self.is_complete {
            self.fault("the checkpoint in the file covers entries that it does not have");
        }
        self.outcome
    }

    /// Returns whether a checkpoint covers the next entry.
    fn is_signed_next(&self) -> bool {
        let next = self.leaves.end();
        next < self.checkpoint.size || self.newest.as_ref().is_some_and(|newest| next < newest.size)
    }

    /// Compares the root with those of the checkpoints over as many leaves.
    fn compare_roots(&mut self) {
        let size = self.leaves.end();
        if size == self.checkpoint.size {
            self.is_proven = true;
            if self.leaves.root() != self.checkpoint.root {
                self.fault("the entries up to here are not those of the checkpoint");
            }
        }
        let newest = self.newest.as_ref().filter(|newest| newest.size == size);
        if let Some(root) = newest.map(|newest| newest.root) {
            self.is_complete = true;
            if self.leaves.root() != root {
                self.fault("the entries up to here are not those of the checkpoint in the file");
            }
        }
    }

    fn fault(&mut self, message: &str) {
        self.outcome.fault_count += 1;
        if self.outcome.fault_list.len() < FAULTS_MAX {
            self.outcome.fault_list.push(LedgerFault {
                recipient: self.start.recipient.to_string(),
                number: self.number,
                message: message.to_owned(),
            });
        }
    }
}

/// Reads a checkpoint that this key has signed.
fn signed_checkpoint(
    note: &str,
    key: &VerifierKey,
) -> Result<(SignedNote, Checkpoint), AuditError> {
    let note = SignedNote::parse(note).map_err(AuditError::Signature)?;
    note.verify([key]).map_err(AuditError::Signature)?;
    let checkpoint = note.text().parse().map_err(AuditError::Checkpoint)?;
    Ok((note, checkpoint))
}
