//! Lines of an audit file.

use asi_model::{DateTime, MessageId};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use transparency_log::{LeafRange, leaf_hash};

use crate::LogStart;

/// First line of an audit file: where the present entries continue.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct AuditStart {
    /// The text of the log's first leaf.
    pub log_start: String,
    /// Number of the last entry before those of the file.
    pub number: u64,
    /// Hashes of the largest perfect subtrees over the leaves before, hexadecimal.
    pub leaves: Vec<String>,
    /// The log's checkpoint over all entries of the file, a C2SP signed note; none in files of
    /// former versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checkpoint: Option<String>,
}

/// An entry with what belongs to it.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct AuditEntry {
    /// The canonical text of the entry.
    pub entry: String,
    /// The DataSetMessage of a QUEUED entry, byte by byte; none once retention has emptied it.
    pub report: Option<Box<RawValue>>,
    /// The salt of its hashes, hexadecimal.
    pub salt: Option<String>,
    /// Time at which the broker accepted the report last.
    pub sent_at: Option<DateTime>,
    /// The message in which it left last.
    pub message_id: Option<MessageId>,
    /// Time at which the platform receipted it last.
    pub delivered_at: Option<DateTime>,
}

impl AuditStart {
    /// Returns the leaves before those of the entries; `None` where they are not those of the log.
    pub(super) fn leaves_before(&self, start: &LogStart) -> Option<LeafRange> {
        // The text that is hashed has one form only.
        if start.canonical() != self.log_start {
            return None;
        }
        let hash = |text: &String| hex::decode(text).ok()?.try_into().ok();
        let hashes = self.leaves.iter().map(hash).collect::<Option<Vec<_>>>()?;
        let size = self.number.checked_sub(start.number)?.checked_add(1)?;
        let leaves = LeafRange::from_hashes(0, size, hashes)?;
        let is_first = size == 1 && leaves.root() != leaf_hash(self.log_start.as_bytes());
        (!is_first).then_some(leaves)
    }
}
