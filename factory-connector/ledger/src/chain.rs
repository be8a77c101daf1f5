//! The chains' heads: where the next entry goes and what it follows.

use std::collections::BTreeMap;

use asi_model::{DateTime, OrganisationId};
use sha2::{Digest, Sha256};

use super::{Entry, Event, Hash};

/// Sets our hashes apart from any other use of SHA-256.
const DOMAIN: &[u8] = b"verbund ledger 1";

/// The hash of an entry: over the hash of the one before and the entry's canonical text.
#[must_use]
pub fn chain_hash(previous: &Hash, content: &str) -> Hash {
    let mut hasher = Sha256::new();
    hasher.update(DOMAIN);
    hasher.update(previous);
    hasher.update(content.as_bytes());
    hasher.finalize().into()
}

/// The last entry of a chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Head {
    /// Its number; 0 for an empty chain.
    pub number: u64,
    /// Its hash; zeros for an empty chain.
    pub hash: Hash,
}

/// An entry in its place, ready to be stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkedEntry {
    /// Whose chain.
    pub recipient: OrganisationId,
    /// Its place.
    pub number: u64,
    /// When it was recorded.
    pub recorded_at: DateTime,
    /// The hashed text.
    pub content: String,
    /// Its hash.
    pub hash: Hash,
}

/// The heads of all chains.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Heads(BTreeMap<OrganisationId, Head>);

impl Heads {
    /// The heads as stored.
    #[must_use]
    pub fn new(heads: impl IntoIterator<Item = (OrganisationId, Head)>) -> Self {
        Self(heads.into_iter().collect())
    }

    /// Every chain with its head.
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
            Entry { recipient: recipient.clone(), number, recorded_at, event }.canonical();
        let hash = chain_hash(&head.hash, &content);
        *head = Head { number, hash };
        LinkedEntry { recipient: recipient.clone(), number, recorded_at, content, hash }
    }
}
