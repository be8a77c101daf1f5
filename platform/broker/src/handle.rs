//! The broker as its owner sees it.

use std::{
    collections::{HashMap, HashSet},
    net::SocketAddr,
    sync::Arc,
};

use bytes::Bytes;
use serde::Serialize;
use time::OffsetDateTime;
use tokio_util::sync::CancellationToken;

use crate::{
    address::QueueName,
    config::{BrokerConfig, QueueOptions},
    core::Core,
    credentials::Credentials,
    error::BrokerError,
    listener::{self, BoundListener},
    queue::{Entry, Queue},
    store::{self, Command, Writer},
};

/// The broker; [`run`](Self::run) it.
pub struct Broker {
    core: Arc<Core>,
    writer: Writer,
    listeners: Vec<BoundListener>,
}

/// Speaks to a [`Broker`] that is being run.
#[derive(Clone)]
pub struct BrokerHandle {
    core: Arc<Core>,
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
        let listeners = listener::bind(&config.listeners).await?;
        let addresses = listeners.iter().map(BoundListener::address).collect();
        let path = config.database_path.clone();
        let open = |source| BrokerError::OpenStore { path: path.clone(), source };
        let mut connection = store::open_writer(&path).await.map_err(open)?;
        store::ensure_dead_letters(&mut connection, QueueName::dead_letters().as_str())
            .await
            .map_err(open)?;
        let readers = store::open_readers(&path).await.map_err(open)?;
        let loaded = store::load(&readers).await.map_err(open)?;

        let next_message_id =
            loaded.iter().flat_map(|q| &q.entries).map(|e| e.id).max().unwrap_or(0) + 1;
        let mut queues = HashMap::with_capacity(loaded.len());
        for stored in loaded {
            let queue = Arc::new(Queue::new(stored.id, stored.name.clone(), stored.options));
            for entry in stored.entries {
                queue.adopt(entry);
            }
            queues.insert(stored.name, queue);
        }
        let dead_letters = queues.get(&QueueName::dead_letters()).cloned();
        let dead_letters = dead_letters.ok_or_else(|| open(sqlx::Error::RowNotFound))?;
        let (writer, writer_handle) =
            Writer::new(connection, store::options(&path), Arc::clone(&dead_letters));
        let core = Core::new(
            config,
            credentials,
            writer_handle,
            readers,
            queues,
            dead_letters,
            next_message_id,
        );
        let core = Arc::new(core);
        let handle = BrokerHandle { core: Arc::clone(&core), addresses };
        Ok((Self { core, writer, listeners }, handle))
    }

    /// Serves until `shutdown`, then closes all connections; what is accepted is committed. A
    /// handle that outlives this keeps its view of the queues but can change nothing.
    ///
    /// # Errors
    /// [`BrokerError::Stopped`] when the writer ended before it should, which only a panic can
    /// cause.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), BrokerError> {
        let Self { core, writer, listeners } = self;
        let stop_writing = CancellationToken::new();
        let mut writing = tokio::spawn(writer.run(stop_writing.clone()));
        let serving = listener::serve(Arc::clone(&core), listeners, shutdown.clone());
        tokio::select! {
            () = serving => {
                stop_writing.cancel();
                let written = writing.await.map_err(|_| BrokerError::Stopped);
                core.readers().close().await;
                written
            }
            _ = &mut writing => Err(BrokerError::Stopped),
        }
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
    /// [`BrokerError::TooManyQueues`], [`BrokerError::Store`] or [`BrokerError::Stopped`].
    pub async fn declare_queue(
        &self,
        queue: &QueueName,
        options: QueueOptions,
    ) -> Result<(), BrokerError> {
        self.core.declare(queue, options).await.map(drop)
    }

    /// Removes a queue with everything in it; its links end. Returns how many messages went with
    /// it.
    ///
    /// # Errors
    /// [`BrokerError::UnknownQueue`], [`BrokerError::Store`] or [`BrokerError::Stopped`].
    pub async fn delete_queue(&self, queue: &QueueName) -> Result<u64, BrokerError> {
        self.core.delete(queue).await
    }

    /// All queues, by name.
    #[must_use]
    pub fn queues(&self) -> Vec<QueueStatus> {
        self.core.statuses()
    }

    /// One queue.
    #[must_use]
    pub fn queue(&self, queue: &QueueName) -> Option<QueueStatus> {
        self.core.queue(queue).map(|q| q.status())
    }

    /// All connections, oldest first.
    #[must_use]
    pub fn connections(&self) -> Vec<ConnectionStatus> {
        self.core.connections()
    }

    /// Cuts all connections of a user; returns how many there were.
    pub fn disconnect_user(&self, user_name: &str) -> usize {
        self.core.disconnect(user_name)
    }

    /// Dead letters with a greater number than `after`, oldest first.
    ///
    /// # Errors
    /// [`BrokerError::Store`].
    pub async fn dead_letters(
        &self,
        after: i64,
        limit: u32,
    ) -> Result<Vec<DeadLetter>, BrokerError> {
        let read = store::dead_letters(self.core.readers(), after, limit).await;
        read.map_err(|source| BrokerError::Store { action: "read the dead letters", source })
    }

    /// The body of a dead letter; none when it is gone.
    ///
    /// # Errors
    /// [`BrokerError::Store`].
    pub async fn dead_letter_body(&self, id: i64) -> Result<Option<Bytes>, BrokerError> {
        let read = store::dead_letter_body(self.core.readers(), id).await;
        let read =
            read.map_err(|source| BrokerError::Store { action: "read a dead letter", source })?;
        Ok(read.map(Bytes::from))
    }

    /// Puts dead letters back at the end of their queues; returns how many. Those whose queue is
    /// gone, or which somebody consumes at the moment, stay.
    ///
    /// # Errors
    /// [`BrokerError::Store`] or [`BrokerError::Stopped`].
    pub async fn replay_dead_letters(&self, ids: &[i64]) -> Result<u64, BrokerError> {
        let wanted: HashSet<i64> = ids.iter().copied().collect();
        let first = wanted.iter().copied().min().unwrap_or(0);
        let limit = self.core.config.limits.dead_letters_max.try_into().unwrap_or(u32::MAX);
        let mut letters = self.dead_letters(first - 1, limit).await?;
        letters.retain(|letter| wanted.contains(&letter.id));
        let mut moves = Vec::new();
        for letter in letters {
            let Some(queue) = self.core.queue(&letter.queue) else { continue };
            let Some(entry) = self.core.dead_letters.withdraw(letter.id) else { continue };
            moves.push((
                entry,
                Entry { id: self.core.next_message_id(), delivery_count: 0, ..entry },
                queue,
            ));
        }
        let numbers = moves.iter().map(|(old, new, queue)| (old.id, new.id, queue.id)).collect();
        let answer = self.core.writer.ask(|done| Command::Unbury { moves: numbers, done }).await;
        let is_moved = matches!(answer, Some(Ok(())));
        let count = moves.len() as u64;
        for (old, new, queue) in moves {
            if is_moved { queue.adopt(new) } else { self.core.dead_letters.adopt(old) }
        }
        answered(answer, "replay dead letters").map(|()| count)
    }

    /// Removes dead letters for good; returns how many.
    ///
    /// # Errors
    /// [`BrokerError::Store`] or [`BrokerError::Stopped`].
    pub async fn purge_dead_letters(&self, ids: &[i64]) -> Result<u64, BrokerError> {
        let gone: Vec<_> =
            ids.iter().filter_map(|id| self.core.dead_letters.withdraw(*id)).collect();
        let numbers = gone.iter().map(|entry| entry.id).collect();
        let answer = self.core.writer.ask(|done| Command::Purge { ids: numbers, done }).await;
        if !matches!(answer, Some(Ok(()))) {
            gone.iter().for_each(|entry| self.core.dead_letters.adopt(*entry));
        }
        answered(answer, "purge dead letters").map(|()| gone.len() as u64)
    }
}

fn answered(
    answer: Option<Result<(), sqlx::Error>>,
    action: &'static str,
) -> Result<(), BrokerError> {
    answer.ok_or(BrokerError::Stopped)?.map_err(|source| BrokerError::Store { action, source })
}
