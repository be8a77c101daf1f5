//! Lines of an audit file.

use serde::{Deserialize, Serialize};
use transparency_log::LeafRange;

use crate::{AccessLog, AccessLogStart};

/// First line of an audit file: where the present entries continue.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct AccessAuditStart {
    /// The text of the log's first leaf.
    pub log_start: String,
    /// Number of the last entry before those of the file; 0 where it has all.
    pub number: u64,
    /// Hashes of the largest perfect subtrees over the leaves before, hexadecimal.
    pub leaves: Vec<String>,
}

/// An entry in the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct AccessAuditLine {
    /// The canonical text of the entry.
    pub entry: String,
}

impl AccessAuditStart {
    /// Begins the file of a log after those entries that it was given so far.
    #[must_use]
    pub fn after(log: &AccessLog) -> Self {
        Self {
            log_start: log.start().canonical(),
            number: log.last_number(),
            leaves: log.edge_hashes(),
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
        let leaves = LeafRange::from_hashes(0, self.number.checked_add(1)?, hashes)?;
        let is_other = self.number == 0 && leaves != start.leaves();
        (!is_other).then_some(leaves)
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
