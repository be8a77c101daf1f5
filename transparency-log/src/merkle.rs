//! Merkle tree of RFC 6962, section 2.1, over SHA-256, with the verification of RFC 9162, sections
//! 2.1.3.2 and 2.1.4.2.

mod leaf_range;
mod proof;
#[cfg(test)]
mod tests;

pub use leaf_range::LeafRange;
pub use proof::{
    ProofError, consistency_proof, inclusion_proof, verify_consistency, verify_inclusion,
};
use sha2::{Digest as _, Sha256};

/// A SHA-256 digest.
pub type Hash = [u8; 32];

/// Returns the root of a log without entries: the digest of nothing.
#[must_use]
pub fn empty_root() -> Hash {
    Sha256::digest([]).into()
}

/// Computes the hash of an entry: `SHA-256(00 || entry)`.
#[must_use]
pub fn leaf_hash(entry: &[u8]) -> Hash {
    Sha256::new().chain_update([0]).chain_update(entry).finalize().into()
}

/// Computes the hash over two neighbouring subtrees: `SHA-256(01 || left || right)`.
#[must_use]
pub fn node_hash(left: &Hash, right: &Hash) -> Hash {
    Sha256::new().chain_update([1]).chain_update(left).chain_update(right).finalize().into()
}
