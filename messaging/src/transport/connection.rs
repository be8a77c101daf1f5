//! Traits and faults of a transport: connections, with one sender or receiver per address.

use async_trait::async_trait;
use futures::future::BoxFuture;

use crate::{
    config::BrokerUrl,
    envelope::Envelope,
    inbox::{Delivery, Settlement},
    profile::Terminus,
    spool::Rejection,
};

/// Why there is no connection, or no more.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub(crate) struct ConnectionFault {
    /// A sentence for people.
    pub reason: String,
    /// Whether somebody must act before another attempt can succeed.
    pub is_permanent: bool,
}

impl ConnectionFault {
    pub(crate) fn passing(reason: impl Into<String>) -> Self {
        Self { reason: reason.into(), is_permanent: false }
    }

    pub(crate) fn permanent(reason: impl Into<String>) -> Self {
        Self { reason: reason.into(), is_permanent: true }
    }
}

/// Why a lane cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum LaneFault {
    /// The broker refused this address; others may work.
    #[error("{0}")]
    Refused(Rejection),
    /// The lane or the connection broke; whether the connection did shows there.
    #[error("{0}")]
    Broken(String),
    /// The broker does not answer any more: the connection must be taken down.
    #[error("{0}")]
    Stalled(String),
}

/// What the broker said about a sent message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Stored.
    Accepted,
    /// Not taken, with the reason.
    Rejected(Rejection),
    /// Not taken at the moment.
    Released,
}

/// Makes connections.
#[async_trait]
pub(crate) trait Transport: Send + Sync {
    /// Resolves the address anew, connects and signs in.
    async fn connect(&self, broker: &BrokerUrl) -> Result<Box<dyn Connection>, ConnectionFault>;
}

/// A connection that is up.
#[async_trait]
pub(crate) trait Connection: Send + Sync {
    /// Opens a lane to send to an address.
    async fn outgoing(&self, terminus: &Terminus) -> Result<Box<dyn Outgoing>, LaneFault>;

    /// Opens a lane to receive from an address.
    async fn incoming(&self, terminus: &Terminus) -> Result<Box<dyn Incoming>, LaneFault>;

    /// Waits until the connection is lost, and tells why.
    async fn lost(&self) -> ConnectionFault;

    /// Says goodbye, within a short time.
    async fn close(&self);
}

/// The future of a sent message's outcome. Resolves at the latest when the lane is dropped.
pub(crate) type OutcomeFuture = BoxFuture<'static, Result<Outcome, LaneFault>>;

/// A lane to send to one address.
#[async_trait]
pub(crate) trait Outgoing: Send {
    /// Hands a message over; waits while the broker gives no room. What cannot be sent at all is an
    /// outcome, too.
    async fn send(&mut self, envelope: &Envelope) -> Result<OutcomeFuture, LaneFault>;
}

/// A lane to receive from one address.
#[async_trait]
pub(crate) trait Incoming: Send {
    /// Waits for messages and takes those that have arrived, at most `limit`. Safe to cancel.
    async fn receive(&mut self, limit: usize) -> Result<Vec<(Token, Delivery)>, LaneFault>;

    /// Tells the broker what became of messages.
    async fn settle(&mut self, settlements: Vec<(Token, Settlement)>) -> Result<(), LaneFault>;

    /// The address is not wanted any more: nothing need be kept for it.
    async fn leave(&mut self);
}

/// Names a received message to its lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Token(pub u64);
