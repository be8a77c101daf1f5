//! Transparency log over a chain: a Merkle tree whose leaves are the chain's entries, so that one
//! checkpoint kept elsewhere proves all of them.

use std::collections::BTreeMap;

use asi_model::{FactoryId, OrganisationId};
use serde::{Deserialize, Serialize};
use transparency_log::{Checkpoint, KeyError, KeyKind, LeafRange, NoteKey, VerifierKey, leaf_hash};

use super::{Anchor, Hash, Head, LedgerKey, LinkedEntry};

/// First leaf of a log: the chain that it is about, and the entry that its second leaf follows.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct LogStart {
    pub factory_id: FactoryId,
    /// Organisation of the chain.
    pub recipient: OrganisationId,
    /// Number of the last entry before the log; 0 where the log has all entries.
    pub number: u64,
    /// Hash of that entry in the chain, hexadecimal; zeros where the log has all entries.
    pub hash: String,
}

impl LogStart {
    /// Returns the text that is hashed.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("a start has text keys only")
    }

    /// Returns the name of the log, unique among all logs.
    #[must_use]
    pub fn origin(&self) -> String {
        origin(&self.factory_id, &self.recipient)
    }

    /// Returns the leaves before those of the present entries: the start itself, and the entries
    /// that an anchor stands for. `None` where the anchor is not one of this log.
    #[must_use]
    pub fn leaves_before(&self, anchor: Option<&Anchor>) -> Option<LeafRange> {
        match anchor.filter(|anchor| anchor.number != self.number) {
            Some(anchor) => {
                let size = anchor.number.checked_sub(self.number)?.checked_add(1)?;
                let hash = |text: &String| hex::decode(text).ok()?.try_into().ok();
                let hashes: Option<Vec<Hash>> = anchor.leaves.iter().map(hash).collect();
                LeafRange::from_hashes(0, size, hashes?)
            }
            None => {
                let mut leaves = LeafRange::starting_at(0);
                leaves.append(leaf_hash(self.canonical().as_bytes()));
                Some(leaves)
            }
        }
    }
}

/// Returns the name of the log of what a factory discloses to an organisation. Both ids have letters,
/// digits, `_` and `-` only.
fn origin(factory: &FactoryId, recipient: &OrganisationId) -> String {
    format!("{factory}/to/{recipient}")
}

/// Names the key of a ledger as the key of one log.
///
/// # Errors
/// [`KeyError`] where the bytes are no key, or a weak one.
pub fn log_verifier(
    factory: &FactoryId,
    recipient: &OrganisationId,
    public_key: &Hash,
) -> Result<VerifierKey, KeyError> {
    VerifierKey::new(&origin(factory, recipient), KeyKind::Ed25519, public_key)
}

/// The log of one chain, as far as it is needed to extend it and to sign its checkpoints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Log {
    start: LogStart,
    leaves: LeafRange,
    /// The last checkpoint as a signed note, with its size; none before the first.
    checkpoint: Option<(u64, String)>,
}

impl Log {
    /// Begins a log after an entry of the chain, or at its beginning.
    #[must_use]
    pub fn new(factory_id: FactoryId, recipient: OrganisationId, previous: &Head) -> Self {
        let (number, hash) = (previous.number, hex::encode(previous.hash));
        let start = LogStart { factory_id, recipient, number, hash };
        let mut leaves = LeafRange::starting_at(0);
        leaves.append(leaf_hash(start.canonical().as_bytes()));
        Self { start, leaves, checkpoint: None }
    }

    /// Creates a log as it was stored.
    #[must_use]
    pub const fn stored(
        start: LogStart,
        leaves: LeafRange,
        checkpoint: Option<(u64, String)>,
    ) -> Self {
        Self { start, leaves, checkpoint }
    }

    /// Returns the first leaf.
    #[must_use]
    pub const fn start(&self) -> &LogStart {
        &self.start
    }

    /// Returns the leaves of all entries so far; their root is that of the log.
    #[must_use]
    pub const fn leaves(&self) -> &LeafRange {
        &self.leaves
    }

    /// Returns the number in the chain of the last entry that the log has.
    #[must_use]
    pub const fn last_number(&self) -> u64 {
        // The first leaf is no entry.
        self.start.number + self.leaves.end() - 1
    }

    /// Returns the last signed checkpoint, a C2SP signed note; none before the first.
    #[must_use]
    pub fn checkpoint(&self) -> Option<&str> {
        self.checkpoint.as_ref().map(|(_, note)| note.as_str())
    }

    /// Returns whether the log grew since its last checkpoint.
    #[must_use]
    pub fn has_grown(&self) -> bool {
        self.checkpoint.as_ref().is_none_or(|(size, _)| *size < self.leaves.end())
    }

    /// Appends the entry that follows in the chain, given its canonical text.
    pub fn append(&mut self, content: &str) {
        self.leaves.append(leaf_hash(content.as_bytes()));
    }

    /// Signs a checkpoint over all entries so far.
    pub fn sign_checkpoint(&mut self, key: &LedgerKey) {
        let checkpoint = Checkpoint {
            origin: self.start.origin(),
            size: self.leaves.end(),
            root: self.leaves.root(),
        };
        let note = checkpoint
            .sign(&key.note_key(&checkpoint.origin))
            .expect("an origin of two ids, and a key for texts");
        self.checkpoint = Some((checkpoint.size, note.to_string()));
    }
}

/// The logs of all chains.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Logs(BTreeMap<OrganisationId, Log>);

impl Logs {
    /// Adds a stored log.
    pub fn insert(&mut self, log: Log) {
        self.0.insert(log.start.recipient.clone(), log);
    }

    /// Returns the log of a recipient's chain; `None` before its first entry.
    #[must_use]
    pub fn get(&self, recipient: &OrganisationId) -> Option<&Log> {
        self.0.get(recipient)
    }

    /// Returns the log of a recipient's chain, to sign its checkpoint.
    pub fn get_mut(&mut self, recipient: &OrganisationId) -> Option<&mut Log> {
        self.0.get_mut(recipient)
    }

    /// Returns all logs, by their recipients.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Log> {
        self.0.values_mut()
    }

    /// Appends an entry that was appended to its chain.
    pub fn append(&mut self, factory: &FactoryId, entry: &LinkedEntry) {
        if !self.0.contains_key(&entry.recipient) {
            self.insert(Log::new(factory.clone(), entry.recipient.clone(), &Head::default()));
        }
        if let Some(log) = self.0.get_mut(&entry.recipient) {
            log.append(&entry.content);
        }
    }
}

impl LedgerKey {
    /// Names the key as that of a log.
    pub(crate) fn note_key(&self, origin: &str) -> NoteKey {
        NoteKey::new(origin, KeyKind::Ed25519, self.signing_key())
            .expect("an origin of two ids, and a key that is not weak")
    }
}
