//! Audit of an access log from a file, by those who have neither the platform's program nor its
//! store: one checkpoint that was kept elsewhere proves every entry up to it.
//!
//! The file has one JSON object per line. The first is an [`AccessAuditStart`], each further one an
//! [`AccessAuditLine`], in the order of the log. Entries after the checkpoint count where the file has
//! a newer one over them; what neither covers could have been written by anybody. It is a fault, and
//! states nothing.

mod file;
#[cfg(test)]
mod tests;

use asi_model::FactoryId;
pub use file::{AccessAuditLine, AccessAuditStart};
use serde::Serialize;
use transparency_log::{
    Checkpoint, CheckpointError, LeafRange, NoteError, SignedNote, VerifierKey, leaf_hash,
};

use crate::{AccessEntry, AccessLogStart, AccessRetentionEntry, retention::AccessRecord};

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
    /// Number of later entries, which the checkpoint in the file covers. A later one that was kept
    /// elsewhere can prove them.
    pub entries_after: u64,
    /// Number of entries that no signature covers. Each is a fault.
    pub entries_unsigned: u64,
    /// Number of earlier entries that the file leaves out.
    pub entries_removed: u64,
    /// The newest statement about what was removed; absent where nothing is stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub retention: Option<AccessRetentionEntry>,
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
    /// The newer checkpoint in the file; none in files of former versions.
    newest: Option<Checkpoint>,
    leaves: LeafRange,
    /// Number of the last entry.
    number: u64,
    is_proven: bool,
    /// Every entry of the checkpoint in the file was found.
    is_complete: bool,
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
        let checkpoint = signed_checkpoint(checkpoint, key)?;
        let first: AccessAuditStart =
            serde_json::from_str(first_line).map_err(|_| AccessAuditError::Start)?;
        let start: AccessLogStart =
            serde_json::from_str(&first.log_start).map_err(|_| AccessAuditError::Start)?;
        let file = start.origin();
        if file != checkpoint.origin || checkpoint.origin != key.name() {
            return Err(AccessAuditError::OtherLog { checkpoint: checkpoint.origin, file });
        }
        let leaves = first.leaves_before(&start).ok_or(AccessAuditError::Start)?;
        let newest = first.checkpoint.as_deref().map(|note| signed_checkpoint(note, key));
        let newest = newest.transpose().map_err(|_| AccessAuditError::FileCheckpoint)?;
        if newest.as_ref().is_some_and(|newest| newest.origin != checkpoint.origin) {
            return Err(AccessAuditError::FileCheckpoint);
        }
        let mut auditor = Self {
            number: first.number,
            is_proven: false,
            is_complete: newest.is_none(),
            outcome: AccessAudit {
                origin: checkpoint.origin.clone(),
                entries_removed: first.number,
                ..AccessAudit::default()
            },
            start,
            checkpoint,
            newest,
            leaves,
        };
        auditor.compare_roots();
        Ok(auditor)
    }

    /// Returns the factory whose values the log is about.
    #[must_use]
    pub const fn factory(&self) -> &FactoryId {
        &self.start.factory_id
    }

    /// Checks the next entry.
    pub fn take(&mut self, line: &str) {
        let _ = self.read(line);
    }

    /// Checks the next entry, and returns the access that it states; `None` for a statement of
    /// retention, and for what no signature covers.
    pub fn read(&mut self, line: &str) -> Option<AccessEntry> {
        self.number += 1;
        if !self.is_signed_next() {
            self.outcome.entries_unsigned += 1;
            self.fault("no signature covers the entry");
            return None;
        }
        let Ok(line) = serde_json::from_str::<AccessAuditLine>(line) else {
            self.fault("the line cannot be read");
            return None;
        };
        self.leaves.append(leaf_hash(line.entry.as_bytes()));
        if self.leaves.end() <= self.checkpoint.size {
            self.outcome.entries_proven += 1;
        } else {
            self.outcome.entries_after += 1;
        }
        self.compare_roots();
        let Ok(record) = serde_json::from_str::<AccessRecord>(&line.entry) else {
            self.fault("the entry cannot be read");
            return None;
        };
        if record.place() != (&self.start.factory_id, self.number) {
            self.fault("the entry stands in another's place");
        }
        match record {
            AccessRecord::Retention(entry) => {
                self.retain(entry);
                None
            }
            AccessRecord::Access(entry) => Some(entry),
        }
    }

    /// Ends the audit.
    #[must_use]
    pub fn finish(mut self) -> AccessAudit {
        if !self.is_proven {
            self.number = self.checkpoint.size.saturating_sub(1);
            self.fault("the checkpoint covers entries that the file does not have");
        }
        if !self.is_complete {
            self.fault("the checkpoint in the file covers entries that it does not have");
        }
        let stated = self.outcome.retention.as_ref();
        let stated = stated.map_or(0, |entry| entry.retention.removed_through);
        if stated != self.outcome.entries_removed {
            self.number = self.outcome.entries_removed;
            self.fault("entries were removed without a statement of retention");
        }
        self.outcome
    }

    fn retain(&mut self, entry: AccessRetentionEntry) {
        let last = self.outcome.retention.as_ref().map(|last| last.retention.removed_through);
        let is_further = last.is_none_or(|last| last < entry.retention.removed_through);
        if !(is_further && entry.is_possible()) {
            self.fault("the statement of retention is about what could not be removed then");
        }
        self.outcome.retention = Some(entry);
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
            let message = message.to_owned();
            self.outcome.fault_list.push(AccessFault { number: self.number, message });
        }
    }
}

/// Reads a checkpoint that this key has signed.
fn signed_checkpoint(note: &str, key: &VerifierKey) -> Result<Checkpoint, AccessAuditError> {
    let note = SignedNote::parse(note).map_err(AccessAuditError::Signature)?;
    note.verify([key]).map_err(AccessAuditError::Signature)?;
    note.text().parse().map_err(AccessAuditError::Checkpoint)
}
