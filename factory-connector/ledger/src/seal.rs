//! Seal of the checkpoints: their signed number, which reveals the removal of the newest one.

use asi_model::FactoryId;

use super::{LedgerKey, key::is_signed};

/// Signed number of a ledger's checkpoints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CheckpointSeal {
    /// Number of the last checkpoint; 0 before the first.
    pub number: u64,
    /// Ed25519 signature over factory and number.
    pub signature: [u8; 64],
    /// Ed25519 key that verifies it.
    pub public_key: [u8; 32],
}

impl CheckpointSeal {
    /// Signs the number of the last checkpoint.
    #[must_use]
    pub fn new(factory: &FactoryId, number: u64, key: &LedgerKey) -> Self {
        let signature = key.sign(&text(factory.as_str(), number));
        Self { number, signature, public_key: key.public() }
    }
}

fn text(factory: &str, number: u64) -> String {
    format!("verbund ledger checkpoints 1\n{factory}\n{number}")
}

/// Returns whether a stored seal was signed with the secret half of its public key.
pub(super) fn is_signed_seal(
    factory: &str,
    number: u64,
    signature: &[u8],
    public_key: &[u8],
) -> bool {
    is_signed(&text(factory, number), signature, public_key)
}
