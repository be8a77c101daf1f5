//! Signed heads of the chains, written with every entry: they reveal the removal of the newest
//! entries.

use asi_model::{FactoryId, OrganisationId};

use super::{Hash, LedgerKey, LinkedEntry, key::is_signed};

/// The signed head of a chain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignedHead {
    /// Organisation of the chain.
    pub recipient: OrganisationId,
    /// Number of its last entry.
    pub number: u64,
    /// Hash of its last entry.
    pub hash: Hash,
    /// Ed25519 signature over factory, organisation, number and hash.
    pub signature: [u8; 64],
    /// The Ed25519 key that verifies it.
    pub public_key: [u8; 32],
}

impl SignedHead {
    /// Signs the head of a chain.
    #[must_use]
    pub fn new(
        factory: &FactoryId,
        recipient: OrganisationId,
        number: u64,
        hash: Hash,
        key: &LedgerKey,
    ) -> Self {
        let signature = key.sign(&text(factory.as_str(), recipient.as_str(), number, &hash));
        Self { recipient, number, hash, signature, public_key: key.public() }
    }

    /// Signs the heads of all chains of these entries.
    #[must_use]
    pub fn of<'a>(
        factory: &FactoryId,
        entries: impl IntoIterator<Item = &'a LinkedEntry>,
        key: &LedgerKey,
    ) -> Vec<Self> {
        let mut last: std::collections::BTreeMap<&OrganisationId, &LinkedEntry> =
            std::collections::BTreeMap::new();
        for entry in entries {
            last.insert(&entry.recipient, entry);
        }
        last.into_values()
            .map(|entry| Self::new(factory, entry.recipient.clone(), entry.number, entry.hash, key))
            .collect()
    }
}

/// Returns the text that is signed.
fn text(factory: &str, recipient: &str, number: u64, hash: &[u8]) -> String {
    format!("verbund ledger head 1\n{factory}\n{recipient}\n{number}\n{}", hex::encode(hash))
}

/// Returns whether a stored head was signed with the secret half of its public key.
pub(super) fn is_signed_head(
    factory: &str,
    recipient: &str,
    number: u64,
    hash: &[u8],
    signature: &[u8],
    public_key: &[u8],
) -> bool {
    is_signed(&text(factory, recipient, number, hash), signature, public_key)
}
