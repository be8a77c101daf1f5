//! Ids of messages and receipts.

use asi_model::{DateTime, MessageId};
use sha2::{Digest as _, Sha256};
use uuid::Uuid;

/// Source of UUIDs of version 7 (RFC 9562, 5.7): time from the caller, random bits from a seed of
/// the caller. So the state needs no clock, and a test repeats what it did.
#[derive(Debug, Clone)]
pub struct IdSource {
    seed: [u8; 32],
    count: u64,
    /// Millisecond of the last id, and the number of ids within it.
    last: (u64, u16),
}

impl IdSource {
    /// Starts from a seed. Two sources with equal seeds yield equal ids.
    #[must_use]
    pub const fn new(seed: [u8; 32]) -> Self {
        Self { seed, count: 0, last: (0, 0) }
    }

    /// Returns the next id.
    pub fn next(&mut self, now: DateTime) -> Uuid {
        self.count += 1;
        let digest = Sha256::new().chain_update(self.seed).chain_update(self.count.to_be_bytes());
        let mut random = [0_u8; 10];
        random.copy_from_slice(&digest.finalize()[..10]);
        let millis = u64::try_from(now.unix_millis()).unwrap_or(0);
        self.last = if self.last.0 == millis {
            (millis, self.last.1.wrapping_add(1) % 0x1000)
        } else {
            (millis, 0)
        };
        // A counter first (RFC 9562, 6.2): the ids of a millisecond are in the order of their making.
        random[..2].copy_from_slice(&self.last.1.to_be_bytes());
        uuid::Builder::from_unix_timestamp_millis(millis, &random).into_uuid()
    }

    /// Returns the next message id.
    pub fn next_message_id(&mut self, now: DateTime) -> MessageId {
        MessageId::from(self.next(now))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_follow_time_and_seed_and_never_repeat() {
        let at = |seconds: i64| DateTime::from_unix_micros(seconds * 1_000_000);
        let mut ids = IdSource::new([1; 32]);
        let (one, two, later) = (ids.next(at(5)), ids.next(at(5)), ids.next(at(6)));
        assert!(one < two && two < later, "in order, within a millisecond as well");
        assert_eq!(one.get_version_num(), 7);
        assert_eq!(IdSource::new([1; 32]).next(at(5)), one);
        assert_ne!(IdSource::new([2; 32]).next(at(5)), one);
    }
}
