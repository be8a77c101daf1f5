//! Audit of an access log from a file, by those who have neither the platform's program nor its
//! store: one checkpoint that was kept elsewhere proves every entry up to it.
//!
//! The file has one JSON object per line. The first is an [`AccessAuditStart`], each further one an
//! [`AccessAuditLine`], in the order of the log.

mod file;
#[cfg(test)]
mod tests;

pub use file::{AccessAuditLine, AccessAuditStart};
use serde::Serialize;
use transparency_log::{
    Checkpoint, CheckpointError, LeafRange, NoteError, SignedNote, VerifierKey, leaf_hash,
};

use crate::{AccessEntry, AccessLogStart};

/// Most faults that are listed; further ones are only counted.
const FAULTS_MAX: usize = 100;

/// Reason that an audit cannot begin.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AccessAuditError {
    /// The checkpoint is not a note of this key.
    #[error("the checkpoint is not signed with this key")]
    Signature(#[source] NoteError),
    /// The signed text is no checkpoint.
    #[error("the signed text is no checkpoint")]
    Checkpoint(#[source] CheckpointError),
    /// The first line does not say where the entries continue.
    #[error("the first line of the file does not begin an access log")]
    Start,
    /// The file is about another log than the checkpoint.
    #[error("the checkpoint is one of {checkpoint}, the file is about {file}")]
    OtherLog {
        /// Origin in the checkpoint.
        checkpoint: String,
        /// Origin of the file's log.
        file: String,
    },
}

/// Fault of an entry.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct AccessFault {
    /// Number of the entry.
    pub number: u64,
    /// Sentence without a full stop.
    pub message: String,
}

/// Result of an audit.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct AccessAudit {
    /// Name of the log.
    pub origin: String,
    /// Number of entries in the file that the checkpoint proves.
    pub entries_proven: u64,
    /// Number of later entries, which a later checkpoint can prove.
    pub entries_after: u64,
    /// Number of earlier entries that the file leaves out, as retention removed them.
    pub entries_removed: u64,
    /// Number of all faults.
    pub fault_count: u64,
    /// The first hundred faults.
    pub fault_list: Vec<AccessFault>,
}

impl AccessAudit {
    /// Returns whether there is no fault.
    #[must_use]
    pub const fn is_intact(&self) -> bool {
        self.fault_count == 0
    }
}

/// Checks an audit file line by line.
pub struct AccessAuditor {
    start: AccessLogStart,
    checkpoint: Checkpoint,
    leaves: LeafRange,
    /// Number of the last entry.
    number: u64,
    is_proven: bool,
    outcome: AccessAudit,
}

impl AccessAuditor {
    /// Begins with a signed checkpoint, the key of the log, and the first line of the file.
    ///
    /// # Errors
    /// [`AccessAuditError`] where the checkpoint is not signed with the key, or belongs to another
    /// log.
    pub fn new(
        checkpoint: &str,
        key: &VerifierKey,
        first_line: &str,
    ) -> Result<Self, AccessAuditError> {
        let note = SignedNote::parse(checkpoint).map_err(AccessAuditError::Signature)?;
        note.verify([key]).map_err(AccessAuditError::Signature)?;
        let checkpoint: Checkpoint = note.text().parse().map_err(AccessAuditError::Checkpoint)?;
        let first: AccessAuditStart =
            serde_json::from_str(first_line).map_err(|_| AccessAuditError::Start)?;
        let start: AccessLogStart =
            serde_json::from_str(&first.log_start).map_err(|_| AccessAuditError::Start)?;
        let file = start.origin();
        if file != checkpoint.origin || checkpoint.origin != key.name() {
            return Err(AccessAuditError::OtherLog { checkpoint: checkpoint.origin, file });
        }
        let leaves = first.leaves_before(&start).ok_or(AccessAuditError::Start)?;
        let mut auditor = Self {
            number: first.number,
            is_proven: false,
            outcome: AccessAudit {
                origin: checkpoint.origin.clone(),
                entries_removed: first.number,
                ..AccessAudit::default()
            },
            start,
            checkpoint,
            leaves,
        };
        auditor.compare_root();
        Ok(auditor)
    }

    /// Checks the next entry.
    pub fn take(&mut self, line: &str) {
        self.number += 1;
        let Ok(line) = serde_json::from_str::<AccessAuditLine>(line) else {
            return self.fault("the line cannot be read");
        };
        self.leaves.append(leaf_hash(line.entry.as_bytes()));
        if self.leaves.end() <= self.checkpoint.size {
            self.outcome.entries_proven += 1;
        } else {
            self.outcome.entries_after += 1;
        }
        self.compare_root();
        match serde_json::from_str::<AccessEntry>(&line.entry) {
            Err(_) => self.fault("the entry cannot be read"),
            Ok(entry)
                if entry.factory_id != self.start.factory_id || entry.number != self.number =>
            {
                self.fault("the entry stands in another's place");
            }
            Ok(_) => {}
        }
    }

    /// Ends the audit.
    #[must_use]
    pub fn finish(mut self) -> AccessAudit {
        if !self.is_proven {
            self.number = self.checkpoint.size.saturating_sub(1);
            self.fault("the checkpoint covers entries that the file does not have");
        }
        self.outcome
    }

    fn compare_root(&mut self) {
        if self.leaves.end() != self.checkpoint.size {
            return;
        }
        self.is_proven = true;
        if self.leaves.root() != self.checkpoint.root {
            self.fault("the entries up to here are not those of the checkpoint");
        }
    }

    fn fault(&mut self, message: &str) {
        self.outcome.fault_count += 1;
        if self.outcome.fault_list.len() < FAULTS_MAX {
            let message = message.to_owned();
            self.outcome.fault_list.push(AccessFault { number: self.number, message });
        }
    }
}
