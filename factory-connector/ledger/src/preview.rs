//! Commitment to the preview that a decision was made on.

use sha2::{Digest, Sha256};

/// Domain separator: these hashes differ from any other use of SHA-256.
const DOMAIN: &[u8] = b"verbund preview 1";

/// Computes the salted hash of a preview's text, hexadecimal. A preview has values of machines that
/// never leave; the salt forbids to confirm guessed ones by the hash.
#[must_use]
pub fn preview_hash(text: &str, salt: &[u8]) -> String {
    let mut hasher = Sha256::new();
    hasher.update(DOMAIN);
    hasher.update(u64::try_from(salt.len()).unwrap_or(u64::MAX).to_be_bytes());
    hasher.update(salt);
    hasher.update(text.as_bytes());
    hex::encode(hasher.finalize())
}
