//! Portions of a batch: as much of it as is decoded at a time. What is small on its way may be large in memory:
//! a message of a kilobyte unpacks to hundreds, and its values take some forty times as much again.

use std::vec::IntoIter;

use asi_model::messages::MESSAGE_BYTES_MAX;
use bytes::Bytes;
use messaging::{BodyError, Delivery};

/// Unpacked bytes behind which a portion ends. It has one message at least.
pub(super) const PORTION_BYTES_MAX: usize = 1024 * 1024;

/// A delivery with its body as the sender wrote it.
#[derive(Debug)]
pub struct Unpacked {
    pub(super) delivery: Delivery,
    pub(super) text: Result<Bytes, BodyError>,
}

impl Unpacked {
    fn bytes(&self) -> usize {
        let text = self.text.as_ref().map_or(0, Bytes::len);
        text.max(self.delivery.envelope.body.len())
    }
}

impl From<Delivery> for Unpacked {
    fn from(delivery: Delivery) -> Self {
        let text = delivery.envelope.unpacked(MESSAGE_BYTES_MAX);
        Self { delivery, text }
    }
}

/// Messages that are decoded and written together.
#[derive(Debug, Default)]
pub(super) struct BatchPortion {
    pub(super) messages: Vec<Unpacked>,
    /// Unpacked bytes of all of them.
    pub(super) bytes: usize,
}

/// Takes the next portion of a batch, in its order; an empty one at its end.
pub(super) fn next(batch: &mut IntoIter<Delivery>) -> BatchPortion {
    let mut portion = BatchPortion::default();
    while portion.bytes < PORTION_BYTES_MAX
        && let Some(delivery) = batch.next()
    {
        let message = Unpacked::from(delivery);
        portion.bytes += message.bytes();
        portion.messages.push(message);
    }
    portion
}
