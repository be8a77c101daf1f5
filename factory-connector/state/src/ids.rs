//! Ids of messages and receipts, and salts.

use asi_model::MessageId;
use ledger::SALT_BYTES;
use sha2::{Digest as _, Sha256};
use uuid::Uuid;

/// Source of UUIDs of version 4 (RFC 9562, 5.4) from a seed of the caller, so that a test repeats
/// what it did. They say nothing about the time: what an id tells must not be finer than the time
/// step of the message that has it.
#[derive(Debug, Clone)]
pub struct IdSource {
    seed: [u8; 32],
    count: u64,
}

impl IdSource {
    /// Starts from a seed. Two sources with equal seeds yield equal ids.
    #[must_use]
    pub const fn new(seed: [u8; 32]) -> Self {
        Self { seed, count: 0 }
    }

    /// Returns the next id.
    pub fn next_uuid(&mut self) -> Uuid {
        uuid::Builder::from_random_bytes(self.next_bytes()).into_uuid()
    }

    /// Returns the next salt of a hash.
    pub fn next_salt(&mut self) -> [u8; SALT_BYTES] {
        self.next_bytes()
    }

    fn next_bytes(&mut self) -> [u8; SALT_BYTES] {
        self.count += 1;
        let digest = Sha256::new().chain_update(self.seed).chain_update(self.count.to_be_bytes());
        let mut random = [0_u8; SALT_BYTES];
        random.copy_from_slice(&digest.finalize()[..SALT_BYTES]);
        random
    }

    /// Returns the next message id.
    pub fn next_message_id(&mut self) -> MessageId {
        MessageId::from(self.next_uuid())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_follow_the_seed_and_show_no_time() {
        let mut ids = IdSource::new([1; 32]);
        let (one, two) = (ids.next_uuid(), ids.next_uuid());
        assert_ne!(one, two);
        assert_eq!((one.get_version_num(), one.get_timestamp()), (4, None));
        assert_eq!(IdSource::new([1; 32]).next_uuid(), one);
        assert_ne!(IdSource::new([2; 32]).next_uuid(), one);
    }
}
