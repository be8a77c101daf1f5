//! The broker as its owner sees it.

use std::{net::SocketAddr, sync::Arc};

use bytes::Bytes;
use serde::Serialize;
use time::OffsetDateTime;
use tokio_util::sync::CancellationToken;

use crate::{
    address::QueueName,
    config::{BrokerConfig, QueueOptions},
    credentials::Credentials,
    error::BrokerError,
};

/// The broker; [`run`](Self::run) it.
pub struct Broker {
    config: BrokerConfig,
    credentials: Arc<dyn Credentials>,
}

/// Speaks to a running [`Broker`].
#[derive(Clone)]
pub struct BrokerHandle {
    addresses: Arc<[SocketAddr]>,
}

/// How a queue stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct QueueStatus {
    /// Its name.
    pub queue: QueueName,
    /// Messages that wait for a consumer.
    pub ready: u64,
    /// Messages delivered and not settled yet.
    pub unsettled: u64,
    /// Bytes of both.
    pub bytes: u64,
    /// Consumers attached.
    pub consumers: u64,
}

/// A connected peer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ConnectionStatus {
    /// Who signed in.
    pub user_name: String,
    /// From where.
    pub peer: SocketAddr,
    /// Since when.
    #[serde(with = "time::serde::rfc3339")]
    pub since: OffsetDateTime,
}

/// A message that was rejected or delivered too often.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct DeadLetter {
    /// Its number.
    pub id: i64,
    /// The queue it was in.
    pub queue: QueueName,
    /// Its message id, where it has one.
    pub message_id: Option<String>,
    /// Its subject, where it has one.
    pub subject: Option<String>,
    /// Who sent it.
    pub principal: Option<String>,
    /// A stable code: the receiver's error condition, or `verbund:too-many-deliveries`.
    pub code: String,
    /// Why, for people.
    pub reason: String,
    /// When it was set aside.
    #[serde(with = "time::serde::rfc3339")]
    pub at: OffsetDateTime,
    /// Its size, in bytes.
    pub bytes: u64,
}

impl Broker {
    /// Opens the database and the listeners, so that a start that cannot work fails here.
    ///
    /// # Errors
    /// [`BrokerError::Listen`], [`BrokerError::Tls`] or [`BrokerError::OpenStore`].
    pub async fn new(
        config: BrokerConfig,
        credentials: Arc<dyn Credentials>,
    ) -> Result<(Self, BrokerHandle), BrokerError> {
        let handle = BrokerHandle { addresses: Arc::new([]) };
        Ok((Self { config, credentials }, handle))
    }

    /// Serves until `shutdown`, then closes all connections; what is accepted is committed.
    ///
    /// # Errors
    /// [`BrokerError::Store`] when the database fails for good.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), BrokerError> {
        let Self { config: _, credentials: _ } = self;
        shutdown.cancelled().await;
        Ok(())
    }
}

impl BrokerHandle {
    /// The addresses listened on, in the order of the configuration.
    #[must_use]
    pub fn local_addresses(&self) -> &[SocketAddr] {
        &self.addresses
    }

    /// Makes a queue, or gives an existing one new bounds.
    ///
    /// # Errors
    /// [`BrokerError::TooManyQueues`] or [`BrokerError::Store`].
    pub async fn declare_queue(&self, _queue: &QueueName, _options: QueueOptions) -> Result<(), BrokerError> {
        Err(BrokerError::Stopped)
    }

    /// Removes a queue with everything in it; its links end. Returns how many messages went with it.
    ///
    /// # Errors
    /// [`BrokerError::UnknownQueue`] or [`BrokerError::Store`].
    pub async fn delete_queue(&self, _queue: &QueueName) -> Result<u64, BrokerError> {
        Err(BrokerError::Stopped)
    }

    /// All queues, by name.
    #[must_use]
    pub fn queues(&self) -> Vec<QueueStatus> {
        Vec::new()
    }

    /// All connections.
    #[must_use]
    pub fn connections(&self) -> Vec<ConnectionStatus> {
        Vec::new()
    }

    /// Cuts all connections of a user; returns how many there were.
    pub fn disconnect_user(&self, _user_name: &str) -> usize {
        0
    }

    /// Dead letters with a greater number than `after`, oldest first.
    ///
    /// # Errors
    /// [`BrokerError::Store`].
    pub async fn dead_letters(&self, _after: i64, _limit: u32) -> Result<Vec<DeadLetter>, BrokerError> {
        Err(BrokerError::Stopped)
    }

    /// The body of a dead letter; none when it is gone.
    ///
    /// # Errors
    /// [`BrokerError::Store`].
    pub async fn dead_letter_body(&self, _id: i64) -> Result<Option<Bytes>, BrokerError> {
        Err(BrokerError::Stopped)
    }

    /// Puts dead letters back at the end of their queues; returns how many.
    ///
    /// # Errors
    /// [`BrokerError::Store`].
    pub async fn replay_dead_letters(&self, _ids: &[i64]) -> Result<u64, BrokerError> {
        Err(BrokerError::Stopped)
    }

    /// Removes dead letters for good; returns how many.
    ///
    /// # Errors
    /// [`BrokerError::Store`].
    pub async fn purge_dead_letters(&self, _ids: &[i64]) -> Result<u64, BrokerError> {
        Err(BrokerError::Stopped)
    }
}
