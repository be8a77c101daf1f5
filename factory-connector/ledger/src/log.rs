//! Transparency log over a chain: a Merkle tree whose leaves are the chain's entries, so that one
//! checkpoint kept elsewhere proves all of them.

use std::collections::BTreeMap;

use asi_model::{DateTime, FactoryId, OrganisationId, messages::ledger_log_origin};
use serde::{Deserialize, Serialize};
use transparency_log::{
    AddCheckpoint, Checkpoint, KeyError, KeyKind, LeafRange, NoteKey, SignedNote, VerifierKey,
    leaf_hash,
};

use super::{Anchor, Hash, Head, LedgerKey, LinkedEntry, Witnessing};

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
    /// Number of the log among those that replaced each other, from 1.
    #[serde(default = "first_epoch", skip_serializing_if = "is_first_epoch")]
    pub epoch: u32,
    /// The log that this one replaced; none for the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predecessor: Option<Predecessor>,
}

/// Statement why a log replaced another one, for all who audit the new one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Predecessor {
    /// The last checkpoint of the former log that the platform holds, a signed note; none where it
    /// showed none.
    pub checkpoint: Option<String>,
    /// Name of the user who decided.
    pub decided_by: String,
    pub decided_at: DateTime,
    /// Reason in the user's words.
    pub reason: String,
}

const fn first_epoch() -> u32 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
const fn is_first_epoch(epoch: &u32) -> bool {
    *epoch == 1
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
        ledger_log_origin(&self.factory_id, &self.recipient, self.epoch)
    }

    /// Names the key of a ledger as the key of this log.
    ///
    /// # Errors
    /// [`KeyError`] where the bytes are no key, or a weak one.
    pub fn verifier(&self, public_key: &Hash) -> Result<VerifierKey, KeyError> {
        VerifierKey::new(&self.origin(), KeyKind::Ed25519, public_key)
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

/// Names the key of a ledger as the key of a chain's first log.
///
/// # Errors
/// [`KeyError`] where the bytes are no key, or a weak one.
pub fn log_verifier(
    factory: &FactoryId,
    recipient: &OrganisationId,
    public_key: &Hash,
) -> Result<VerifierKey, KeyError> {
    VerifierKey::new(&ledger_log_origin(factory, recipient, 1), KeyKind::Ed25519, public_key)
}

/// The log of one chain, as far as it is needed to extend it and to sign its checkpoints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Log {
    start: LogStart,
    leaves: LeafRange,
    /// The last checkpoint as a signed note, with its size; none before the first.
    checkpoint: Option<(u64, String)>,
    witnessing: Witnessing,
}

impl Log {
    /// Begins the first log of a chain, after an entry of it or at its beginning.
    #[must_use]
    pub fn new(factory_id: FactoryId, recipient: OrganisationId, previous: &Head) -> Self {
        let (number, hash) = (previous.number, hex::encode(previous.hash));
        Self::beginning(LogStart {
            factory_id,
            recipient,
            number,
            hash,
            epoch: first_epoch(),
            predecessor: None,
        })
    }

    /// Begins a log with its first leaf.
    #[must_use]
    pub fn beginning(start: LogStart) -> Self {
        let mut leaves = LeafRange::starting_at(0);
        leaves.append(leaf_hash(start.canonical().as_bytes()));
        let witnessing = Witnessing::new(leaves.clone());
        Self { start, leaves, checkpoint: None, witnessing }
    }

    /// Creates a log as it was stored, of which nothing is known to be countersigned.
    #[must_use]
    pub fn stored(start: LogStart, leaves: LeafRange, checkpoint: Option<(u64, String)>) -> Self {
        let witnessing = Witnessing::new(leaves.clone());
        Self { start, leaves, checkpoint, witnessing }
    }

    /// Returns the log with what the platform has countersigned of it.
    #[must_use]
    pub fn with(self, witnessing: Witnessing) -> Self {
        Self { witnessing, ..self }
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

    /// Returns what the platform has countersigned.
    #[must_use]
    pub const fn witnessing(&self) -> &Witnessing {
        &self.witnessing
    }

    /// Returns what the platform has countersigned, to be changed by its answer.
    pub(crate) const fn witnessing_mut(&mut self) -> &mut Witnessing {
        &mut self.witnessing
    }

    /// Appends the entry that follows in the chain, given its canonical text.
    pub fn append(&mut self, content: &str) {
        let leaf = leaf_hash(content.as_bytes());
        self.leaves.append(leaf);
        self.witnessing.append(leaf);
    }

    /// Makes the request to countersign the whole log, and signs a checkpoint for it where it grew
    /// since the last one.
    pub fn submit(&mut self, key: &LedgerKey, now: DateTime) -> AddCheckpoint {
        if self.has_grown() {
            self.sign_checkpoint(key);
        }
        let note = self.checkpoint().and_then(|note| SignedNote::parse(note).ok());
        let (old_size, proof) = self.witnessing.submit(now);
        AddCheckpoint { old_size, proof, checkpoint: note.expect("it was signed here") }
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
    pub fn iter(&self) -> impl Iterator<Item = &Log> {
        self.0.values()
    }

    /// Returns all logs, by their recipients, to sign their checkpoints.
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
