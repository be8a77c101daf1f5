//! Log of one factory, as far as it is needed to extend it and to sign its checkpoints.

use asi_model::FactoryId;
use serde::{Deserialize, Serialize};
use transparency_log::{Checkpoint, Hash, KeyError, KeyKind, LeafRange, VerifierKey, leaf_hash};

use crate::{Access, AccessEntry, AccessLogKey, AccessRetention, AccessRetentionEntry};

/// First leaf of a log: the factory that it is about, and a random number by which two logs of the
/// same factory are told apart, as after a store was lost.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct AccessLogStart {
    pub factory_id: FactoryId,
    /// Random bytes, hexadecimal; the same for the life of the log.
    pub log_id: String,
}

impl AccessLogStart {
    /// Returns the text that is hashed.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("a start has text keys only")
    }

    /// Returns the name of the log, as its checkpoints carry it.
    #[must_use]
    pub fn origin(&self) -> String {
        origin(&self.factory_id)
    }

    /// Returns the tree of a log without entries.
    #[must_use]
    pub fn leaves(&self) -> LeafRange {
        let mut leaves = LeafRange::starting_at(0);
        leaves.append(leaf_hash(self.canonical().as_bytes()));
        leaves
    }
}

fn origin(factory: &FactoryId) -> String {
    format!("{factory}/accesses")
}

/// Names the key of a platform as the key of one factory's log.
///
/// # Errors
/// [`KeyError`] where the bytes are no key, or a weak one.
pub fn access_log_verifier(
    factory: &FactoryId,
    public_key: &[u8; 32],
) -> Result<VerifierKey, KeyError> {
    VerifierKey::new(&origin(factory), KeyKind::Ed25519, public_key)
}

/// The oldest entries of a log, which retention removed: what proves the others without them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RemovedEntries(LeafRange);

impl RemovedEntries {
    /// Creates the beginning of a log that has all its entries.
    #[must_use]
    pub const fn none() -> Self {
        // Leaf 0 is the start, which is never removed.
        Self(LeafRange::starting_at(1))
    }

    /// Creates them as they were stored: the number of the last one, and their hashes. `None` where
    /// those do not belong together.
    #[must_use]
    pub fn stored(last_number: u64, edge: &[u8]) -> Option<Self> {
        LeafRange::from_bytes(1, last_number.checked_add(1)?, edge).map(Self)
    }

    /// Creates them from the hashes of an audit file.
    pub(crate) fn from_hashes(last_number: u64, hashes: Vec<Hash>) -> Option<Self> {
        LeafRange::from_hashes(1, last_number.checked_add(1)?, hashes).map(Self)
    }

    /// Returns the number of the last one; 0 where none was removed.
    #[must_use]
    pub const fn last_number(&self) -> u64 {
        self.0.end() - 1
    }

    /// Returns the hashes of the largest perfect subtrees over them, 32 bytes each.
    #[must_use]
    pub fn edge(&self) -> Vec<u8> {
        self.0.to_bytes()
    }

    /// Returns these hashes, hexadecimal, as an audit file begins with them.
    #[must_use]
    pub fn edge_hashes(&self) -> Vec<String> {
        self.0.hashes().iter().map(hex::encode).collect()
    }

    /// Adds the text of the entry that follows.
    pub fn append_text(&mut self, content: &str) {
        self.0.append(leaf_hash(content.as_bytes()));
    }
}

/// The log of one factory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AccessLog {
    start: AccessLogStart,
    leaves: LeafRange,
}

impl AccessLog {
    /// Begins a log without entries.
    #[must_use]
    pub fn new(start: AccessLogStart) -> Self {
        Self { leaves: start.leaves(), start }
    }

    /// Continues a log after the entries that were removed from it.
    #[must_use]
    pub fn after(start: AccessLogStart, removed: &RemovedEntries) -> Self {
        let mut log = Self::new(start);
        let is_joined = log.leaves.join(&removed.0);
        is_joined.then_some(log).expect("removed entries follow leaf 0")
    }

    /// Creates a log as it was stored: the number of its last entry and the edge of its tree. `None`
    /// where they do not belong together.
    #[must_use]
    pub fn stored(start: AccessLogStart, last_number: u64, edge: &[u8]) -> Option<Self> {
        let leaves = LeafRange::from_bytes(0, last_number.checked_add(1)?, edge)?;
        Some(Self { start, leaves })
    }

    /// Returns the first leaf.
    #[must_use]
    pub const fn start(&self) -> &AccessLogStart {
        &self.start
    }

    /// Returns the number of the last entry; 0 without entries.
    #[must_use]
    pub const fn last_number(&self) -> u64 {
        self.leaves.end() - 1
    }

    /// Returns the edge of the tree, from which it is extended.
    #[must_use]
    pub fn edge(&self) -> Vec<u8> {
        self.leaves.to_bytes()
    }

    /// Returns the tree over the start and all entries.
    pub(crate) fn into_leaves(self) -> LeafRange {
        self.leaves
    }

    /// Appends an access, and returns its entry.
    pub fn append(&mut self, access: Access, recorded_at: asi_model::DateTime) -> AccessEntry {
        let entry = AccessEntry {
            factory_id: self.start.factory_id.clone(),
            number: self.last_number() + 1,
            recorded_at,
            access,
        };
        self.append_text(&entry.canonical());
        entry
    }

    /// Appends a statement of what retention removed, and returns its entry.
    pub fn append_retention(
        &mut self,
        retention: AccessRetention,
        recorded_at: asi_model::DateTime,
    ) -> AccessRetentionEntry {
        let entry = AccessRetentionEntry {
            factory_id: self.start.factory_id.clone(),
            number: self.last_number() + 1,
            recorded_at,
            retention,
        };
        self.append_text(&entry.canonical());
        entry
    }

    /// Appends the text of a stored entry.
    pub fn append_text(&mut self, content: &str) {
        self.leaves.append(leaf_hash(content.as_bytes()));
    }

    /// Signs a checkpoint over all entries so far: a C2SP signed note.
    #[must_use]
    pub fn sign_checkpoint(&self, key: &AccessLogKey) -> String {
        let checkpoint = Checkpoint {
            origin: self.start.origin(),
            size: self.leaves.end(),
            root: self.leaves.root(),
        };
        let note = checkpoint.sign(&key.note_key(&checkpoint.origin));
        note.expect("an origin of an id, and a key for texts").to_string()
    }
}
