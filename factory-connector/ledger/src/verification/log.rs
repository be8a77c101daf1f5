//! Verification of a chain's log: its tree is computed again from the entries.

use transparency_log::{Checkpoint, LeafRange, SignedNote};

use super::super::{Anchor, Hash, LogStart};

/// A chain's log as stored.
#[derive(Debug, Clone, Default)]
pub struct StoredLog {
    /// Organisation of the chain.
    pub recipient: String,
    /// Text of the first leaf; empty as long as a chain of a former version has no log yet.
    pub start: String,
    /// Number of leaves.
    pub size: i64,
    /// Root over them.
    pub root: Vec<u8>,
    /// Hashes of the subtrees that cover all leaves.
    pub leaves: Vec<u8>,
    /// The last checkpoint, a signed note.
    pub checkpoint: String,
}

impl StoredLog {
    /// Returns whether a chain of a former version has no log yet.
    pub(super) fn is_empty(&self) -> bool {
        self.start.is_empty()
            && self.size == 0
            && self.root.is_empty()
            && self.leaves.is_empty()
            && self.checkpoint.is_empty()
    }
}

/// The tree that is computed from the entries, and what it has to be.
pub(super) struct LogCheck {
    stored: StoredLog,
    leaves: LeafRange,
    checkpoint: Checkpoint,
    /// Checkpoints that were kept where the store's owner cannot change them.
    kept: Vec<Checkpoint>,
    /// The first leaves stand for entries that were removed.
    first_size: u64,
}

impl LogCheck {
    /// Starts with the leaves before the present entries, for which the anchor stands.
    pub(super) fn new(
        stored: StoredLog,
        factory_id: &str,
        (anchor, kept): (Option<&Anchor>, Vec<Checkpoint>),
        key: Option<&Hash>,
    ) -> Result<Self, &'static str> {
        let start: LogStart =
            serde_json::from_str(&stored.start).map_err(|_| "the log's start cannot be read")?;
        let is_own = start.recipient.as_str() == stored.recipient
            && start.factory_id.as_str() == factory_id
            && start.canonical() == stored.start;
        if !is_own {
            return Err("the log's start was changed");
        }
        let leaves = start
            .leaves_before(anchor)
            .ok_or("the log does not continue from the anchor of its chain")?;
        let verified = SignedNote::parse(&stored.checkpoint).ok().and_then(|note| {
            let verifier = start.verifier(key?).ok()?;
            note.verify([&verifier]).ok()?;
            // One line only: the text of another key is no part of what was signed.
            (note.to_string() == stored.checkpoint && note.signature_count() == 1)
                .then(|| note.text().parse::<Checkpoint>().ok())?
        });
        let checkpoint = verified
            .filter(|checkpoint| checkpoint.origin == start.origin())
            .ok_or("the log's checkpoint was changed")?;
        let first_size = leaves.end();
        if kept.iter().any(|kept| kept.origin != start.origin()) {
            return Err("a checkpoint that was kept elsewhere is one of another log of the chain");
        }
        if kept.iter().any(|kept| kept.size < first_size) {
            return Err("a checkpoint that was kept elsewhere is older than what retention left");
        }
        let check = Self { stored, leaves, checkpoint, kept, first_size };
        check.compare()?;
        Ok(check)
    }

    /// Adds the leaf of the next entry.
    pub(super) fn take(&mut self, leaf: Hash) -> Result<(), &'static str> {
        self.leaves.append(leaf);
        self.compare()
    }

    /// Compares the end of the log.
    pub(super) fn finish(self) -> Result<(), &'static str> {
        let Self { stored, leaves, checkpoint, kept, first_size } = self;
        let is_same = u64::try_from(stored.size) == Ok(leaves.end())
            && stored.root == leaves.root()
            && stored.leaves == leaves.to_bytes();
        if !is_same {
            return Err("the log is not the one over the entries of its chain");
        }
        if kept.iter().any(|kept| kept.size > leaves.end()) {
            return Err("entries are missing that a checkpoint kept elsewhere covers");
        }
        let is_reached = checkpoint.size <= leaves.end();
        // What was pruned after the checkpoint is proven by the root of the whole log.
        if is_reached || checkpoint.size < first_size {
            Ok(())
        } else {
            Err("entries are missing that the log's checkpoint covers")
        }
    }

    /// Compares the root with those of the checkpoints over as many leaves.
    fn compare(&self) -> Result<(), &'static str> {
        let is_refuted = |checkpoint: &Checkpoint| {
            self.leaves.end() == checkpoint.size && self.leaves.root() != checkpoint.root
        };
        if is_refuted(&self.checkpoint) {
            Err("the log's checkpoint states another root over these entries")
        } else if self.kept.iter().any(is_refuted) {
            Err("a checkpoint that was kept elsewhere states another root over these entries")
        } else {
            Ok(())
        }
    }
}
