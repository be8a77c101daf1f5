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

/// Fault for which there is no connection, or none any more.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub(crate) struct ConnectionFault {
    /// A sentence for people.
    pub reason: String,
    /// True when a person must act before another attempt can succeed.
    pub is_permanent: bool,
}

impl ConnectionFault {
    pub(crate) fn transient(reason: impl Into<String>) -> Self {
        Self { reason: reason.into(), is_permanent: false }
    }

    pub(crate) fn permanent(reason: impl Into<String>) -> Self {
        Self { reason: reason.into(), is_permanent: true }
    }
}

/// Fault of a sender or receiver.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum EndpointFault {
    /// The broker refused this address; others may work.
    #[error("{0}")]
    Refused(Rejection),
    /// The endpoint or the connection broke; [`Connection::lost`] tells the two apart.
    #[error("{0}")]
    Broken(String),
    /// The broker does not answer any more: the connection must be closed.
    #[error("{0}")]
    Stalled(String),
}

/// The broker's settlement of a sent message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum BrokerOutcome {
    /// Stored by the broker.
    Accepted,
    /// Refused, with the reason.
    Rejected(Rejection),
    /// Refused at the moment; another attempt may succeed.
    Released,
}

/// A protocol with its configuration: establishes connections.
#[async_trait]
pub(crate) trait Transport: Send + Sync {
    /// Resolves the address again, connects and signs in.
    async fn connect(&self, broker: &BrokerUrl) -> Result<Box<dyn Connection>, ConnectionFault>;
}

/// A connection that is up.
#[async_trait]
pub(crate) trait Connection: Send + Sync {
    /// Opens a sender to an address.
    async fn sender(&self, terminus: &Terminus) -> Result<Box<dyn MessageSender>, EndpointFault>;

    /// Opens a receiver from an address.
    async fn receiver(
        &self,
        terminus: &Terminus,
    ) -> Result<Box<dyn MessageReceiver>, EndpointFault>;

    /// Waits until the connection is lost, and returns the cause.
    async fn lost(&self) -> ConnectionFault;

    /// Returns what waits until the broker has answered what it is asked from then on; false where the connection is
    /// lost before. `None` where a broker accepts a message only when it has stored it.
    fn answers(&self) -> Option<BoxFuture<'static, bool>> {
        None
    }

    /// Closes the connection in order, within a short time.
    async fn close(&self);
}

/// The future of a sent message's outcome. Resolves at the latest when the sender is dropped.
pub(crate) type OutcomeFuture = BoxFuture<'static, Result<BrokerOutcome, EndpointFault>>;

/// A sender to one address.
#[async_trait]
pub(crate) trait MessageSender: Send {
    /// Sends a message; waits while the broker grants no credit. A message that can never be sent
    /// is rejected in its outcome.
    async fn send(&mut self, envelope: &Envelope) -> Result<OutcomeFuture, EndpointFault>;

    /// Waits until the broker ends this endpoint alone, and returns the cause. For ever where the whole connection is
    /// lost, which [`Connection::lost`] says. Cancel safe.
    async fn ended(&mut self) -> EndpointFault;
}

/// A receiver from one address.
#[async_trait]
pub(crate) trait MessageReceiver: Send {
    /// Waits for messages and returns those that have arrived, at most `limit`. Cancel safe.
    async fn receive(
        &mut self,
        limit: usize,
    ) -> Result<Vec<(DeliveryToken, Delivery)>, EndpointFault>;

    /// Settles messages at the broker.
    async fn settle(
        &mut self,
        settlements: Vec<(DeliveryToken, Settlement)>,
    ) -> Result<(), EndpointFault>;

    /// Leaves the address for good: the broker need not store messages for this receiver.
    async fn leave(&mut self);
}

/// Identifies a received message to its receiver until it is settled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct DeliveryToken(pub u64);
