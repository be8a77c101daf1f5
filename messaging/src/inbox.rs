//! What receives. A message is stored before it is settled: the link settles only what
//! [`Inbox::receive`] has answered.

use async_trait::async_trait;
use time::OffsetDateTime;

use crate::{address::LogicalAddress, envelope::Envelope, spool::Rejection};

/// A received message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Delivery {
    /// The message.
    pub envelope: Envelope,
    /// The user that the broker vouches for as the sender, where it does (`x-opt-principal`).
    pub principal: Option<String>,
    /// Whether somebody may have received it before.
    pub is_redelivered: bool,
    /// How often it was delivered before without success, as far as the broker counts.
    pub delivery_count: u32,
    /// When it arrived here.
    pub received_at: OffsetDateTime,
}

/// What becomes of a received message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Settlement {
    /// Stored, or stored before: the broker may forget it.
    Accept,
    /// Will never be of use here: the broker moves it to its dead letters.
    Reject(Rejection),
    /// Cannot be stored at the moment: the broker keeps it and delivers it again.
    Release,
}

impl Settlement {
    /// A rejection with its reason.
    #[must_use]
    pub fn reject(code: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Reject(Rejection { code: code.into(), reason: reason.into() })
    }
}

/// The receiving side of a daemon.
#[async_trait]
pub trait Inbox: Send + Sync + 'static {
    /// Takes a batch in the order of its arrival and answers for each delivery, by position.
    ///
    /// Calls for one address never overlap, so the order of messages is that of the broker. What is
    /// missing in the answer counts as released. A released message makes the link pause before it
    /// goes on with that address, and it comes again *behind* those already delivered: a receiver
    /// that needs order releases the rest of the batch, too.
    ///
    /// Repeats are normal after every interruption. Discard them by message id in the transaction
    /// of their effect and accept them.
    async fn receive(&self, address: &LogicalAddress, deliveries: Vec<Delivery>)
    -> Vec<Settlement>;
}
