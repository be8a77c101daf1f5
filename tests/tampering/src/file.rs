//! Audit file that is tampered with.

use serde_json::Value;
use transparency_log::{Checkpoint, LeafRange, SignedNote, leaf_hash};

/// An intact file of a whole chain, a checkpoint that was kept elsewhere, older than the file, and
/// the lines of another history of the same chain, if there is one.
#[derive(Debug, Clone)]
pub struct AuditFile {
    pub lines: Vec<String>,
    pub checkpoint: String,
    pub foreign: Vec<String>,
}

impl AuditFile {
    pub(crate) fn line(&self, index: usize) -> Value {
        serde_json::from_str(&self.lines[index]).expect("a line is JSON")
    }

    /// Returns the entry of a line; null for the first, which has none.
    pub(crate) fn entry(&self, index: usize) -> Value {
        let line = self.line(index);
        let entry = line["entry"].as_str().map(serde_json::from_str);
        entry.transpose().expect("an entry is JSON").unwrap_or_default()
    }

    /// Returns what a line is about.
    pub(crate) fn kind(&self, index: usize) -> String {
        let (line, entry) = (self.line(index), self.entry(index));
        let event = entry["event"].as_str().unwrap_or("START");
        match event {
            "QUEUED" if line["report"].is_null() => "QUEUED and emptied",
            "QUEUED" if !line["deliveredAt"].is_null() => "QUEUED and delivered",
            event => event,
        }
        .to_owned()
    }

    /// Returns the lines with one of them replaced.
    pub(crate) fn with(&self, index: usize, line: &Value) -> Vec<String> {
        let mut lines = self.lines.clone();
        lines[index] = line.to_string();
        lines
    }

    /// Returns the leaves of the log up to the line with this index.
    pub(crate) fn leaves_until(&self, index: usize) -> LeafRange {
        let mut leaves = LeafRange::starting_at(0);
        let start = self.line(0);
        leaves.append(leaf_hash(start["logStart"].as_str().expect("a text").as_bytes()));
        for line in (1..index).map(|index| self.line(index)) {
            leaves.append(leaf_hash(line["entry"].as_str().expect("a text").as_bytes()));
        }
        leaves
    }

    /// Returns the name of the log.
    pub(crate) fn origin(&self) -> String {
        self.kept().origin
    }

    /// Returns the checkpoint that was kept elsewhere.
    pub(crate) fn kept(&self) -> Checkpoint {
        let note = SignedNote::parse(&self.checkpoint).expect("a note");
        note.text().parse().expect("a checkpoint")
    }
}
