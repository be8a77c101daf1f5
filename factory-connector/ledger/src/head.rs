//! Signed ends of the chains, written with every entry: not even the newest entries can be cut off
//! unnoticed.

use asi_model::{FactoryId, OrganisationId};

use super::{Hash, LedgerKey, LinkedEntry, key::is_signed};

/// The signed end of a chain.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignedHead {
    /// Whose chain.
    pub recipient: OrganisationId,
    /// The number of its last entry.
    pub number: u64,
    /// The hash of its last entry.
    pub hash: Hash,
    /// The Ed25519 signature over number and hash.
    pub signature: [u8; 64],
    /// The key it is verified with.
    pub public_key: [u8; 32],
}

impl SignedHead {
    /// Signs the end of a chain.
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

    /// The ends of all chains that these entries belong to.
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

/// What is signed.
fn text(factory: &str, recipient: &str, number: u64, hash: &[u8]) -> String {
    format!("verbund ledger head 1\n{factory}\n{recipient}\n{number}\n{}", hex::encode(hash))
}

/// Whether a stored end was signed with the secret half of its public key.
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
