//! Receiving side of a daemon. A message is stored before it is settled: the link settles a message
//! only after [`Inbox::receive`] has answered.

use async_trait::async_trait;
use time::OffsetDateTime;

use crate::{address::LogicalAddress, envelope::Envelope, spool::Rejection};

/// Message as the broker delivered it, with what the broker says about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Delivery {
    pub envelope: Envelope,
    /// True when a consumer may have received it before.
    pub is_redelivered: bool,
    /// Number of earlier deliveries without success, as far as the broker counts them.
    pub delivery_count: u32,
    /// Time of arrival in this process.
    pub received_at: OffsetDateTime,
}

/// Settlement of a received message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Settlement {
    /// Stored, now or earlier: the broker may delete it.
    Accept,
    /// Can never be processed: the broker moves it to its dead letters.
    Reject(Rejection),
    /// Cannot be stored at the moment: the broker delivers it again.
    Release,
}

impl Settlement {
    /// Creates a rejection with its reason.
    #[must_use]
    pub fn reject(code: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Reject(Rejection { code: code.into(), reason: reason.into() })
    }
}

/// The receiving side of a daemon.
#[async_trait]
pub trait Inbox: Send + Sync + 'static {
    /// Stores a batch in the order of its arrival. Returns the settlement of each delivery, by
    /// position.
    ///
    /// Calls for one address never overlap, so the order of messages is that of the broker.
    /// Deliveries without an answer count as released. A released message makes the link pause
    /// before it receives from that address again, and it is delivered *after* those already
    /// delivered: an inbox that needs order releases the remaining batch, too.
    ///
    /// Repeats are normal after every interruption. Discard them by message id in the transaction
    /// of their effect and accept them.
    async fn receive(&self, address: &LogicalAddress, deliveries: Vec<Delivery>)
    -> Vec<Settlement>;
}
