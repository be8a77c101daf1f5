//! Lines of an audit file.

use serde::{Deserialize, Serialize};
use transparency_log::LeafRange;

use crate::{AccessLog, AccessLogKey, AccessLogStart, RemovedEntries};

/// First line of an audit file: where the present entries continue.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct AccessAuditStart {
    /// The text of the log's first leaf.
    pub log_start: String,
    /// Number of the last entry before those of the file; 0 where it has all.
    pub number: u64,
    /// Hashes of the largest perfect subtrees over the entries before, hexadecimal. Leaf 0 is not
    /// among them, so that its text is proven, too.
    pub leaves: Vec<String>,
    /// The log's checkpoint over all entries of the file, a C2SP signed note; none in files of
    /// former versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checkpoint: Option<String>,
}

/// An entry in the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct AccessAuditLine {
    /// The canonical text of the entry.
    pub entry: String,
}

impl AccessAuditStart {
    /// Begins the file of a log after the entries that were removed from it.
    #[must_use]
    pub fn of(log: &AccessLog, removed: &RemovedEntries, key: &AccessLogKey) -> Self {
        Self {
            log_start: log.start().canonical(),
            number: removed.last_number(),
            leaves: removed.edge_hashes(),
            checkpoint: Some(log.sign_checkpoint(key)),
        }
    }

    /// Returns the line in the file, with its line feed.
    #[must_use]
    pub fn line(&self) -> String {
        line(self)
    }

    /// Returns the leaves before those of the entries; `None` where they are not those of the log.
    pub(super) fn leaves_before(&self, start: &AccessLogStart) -> Option<LeafRange> {
        // The text that is hashed has one form only.
        if start.canonical() != self.log_start {
            return None;
        }
        let hash = |text: &String| hex::decode(text).ok()?.try_into().ok();
        let hashes = self.leaves.iter().map(hash).collect::<Option<Vec<_>>>()?;
        let removed = RemovedEntries::from_hashes(self.number, hashes)?;
        Some(AccessLog::after(start.clone(), &removed).into_leaves())
    }
}

impl AccessAuditLine {
    /// Returns the line in the file, with its line feed.
    #[must_use]
    pub fn line(&self) -> String {
        line(self)
    }
}

fn line(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string(value).expect("a line has text keys only");
    text.push('\n');
    text
}
