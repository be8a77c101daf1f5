//! Heads of the chains, to which entries are appended.

use std::collections::BTreeMap;

use asi_model::{DateTime, OrganisationId};
use sha2::{Digest, Sha256};

use super::{Event, Hash, LedgerEntry};

/// Domain separator: these hashes differ from any other use of SHA-256.
const DOMAIN: &[u8] = b"verbund ledger 1";

/// Computes the hash of an entry over the hash of the one before and the entry's canonical text.
#[must_use]
pub fn chain_hash(previous: &Hash, content: &str) -> Hash {
    let mut hasher = Sha256::new();
    hasher.update(DOMAIN);
    // Nothing between the parts: domain and hash have a fixed length, and the content is the rest.
    hasher.update(previous);
    hasher.update(content.as_bytes());
    hasher.finalize().into()
}

/// The last entry of a chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Head {
    /// Number of the entry; 0 for an empty chain.
    pub number: u64,
    /// Hash of the entry; zeros for an empty chain.
    pub hash: Hash,
}

/// An entry that was appended to its chain and is to be stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkedEntry {
    /// Organisation of the chain.
    pub recipient: OrganisationId,
    /// Number in the chain, from 1.
    pub number: u64,
    pub recorded_at: DateTime,
    /// The canonical text that is hashed.
    pub content: String,
    pub hash: Hash,
}

/// The heads of all chains.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Heads(BTreeMap<OrganisationId, Head>);

impl Heads {
    /// Creates the heads from stored ones.
    #[must_use]
    pub fn new(heads: impl IntoIterator<Item = (OrganisationId, Head)>) -> Self {
        Self(heads.into_iter().collect())
    }

    /// Returns all chains with their heads.
    pub fn iter(&self) -> impl Iterator<Item = (&OrganisationId, &Head)> {
        self.0.iter()
    }

    /// Appends an event to a recipient's chain.
    pub fn append(
        &mut self,
        recipient: &OrganisationId,
        recorded_at: DateTime,
        event: Event,
    ) -> LinkedEntry {
        let head = self.0.entry(recipient.clone()).or_default();
        let number = head.number + 1;
        let content =
            LedgerEntry { recipient: recipient.clone(), number, recorded_at, event }.canonical();
        let hash = chain_hash(&head.hash, &content);
        *head = Head { number, hash };
        LinkedEntry { recipient: recipient.clone(), number, recorded_at, content, hash }
    }
}
