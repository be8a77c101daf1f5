//! The broker as a component: opening, running, and the handle of its owner.

use std::{
    collections::{HashMap, HashSet},
    fmt::Debug,
    net::SocketAddr,
    sync::Arc,
};

use bytes::Bytes;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio_util::sync::CancellationToken;

use crate::{
    address::QueueName,
    config::{BrokerConfig, QueueOptions},
    connection,
    core::Core,
    credentials::CredentialSource,
    dead_letter::BrokerDeadLetter,
    disk::DiskState,
    error::BrokerError,
    listener::{self, BoundListener},
    queue::{Queue, QueueEntry},
    status::{ConnectionStatus, QueueStatus},
    store::{self, StoreCommand, StoreWriter},
};

/// An opened broker, to be driven by [`run`](Self::run).
pub struct Broker {
    core: Arc<Core>,
    writer: StoreWriter,
    listeners: Vec<BoundListener>,
}

/// Handle to a running [`Broker`]; clones share it.
#[derive(Clone)]
pub struct BrokerHandle {
    core: Arc<Core>,
    addresses: Arc<[SocketAddr]>,
}

impl Broker {
    /// Opens the database and the listeners; everything that can fail at a start fails here.
    ///
    /// # Errors
    /// [`BrokerError::Listen`], [`BrokerError::Tls`] or [`BrokerError::OpenStore`].
    pub async fn new(
        config: BrokerConfig,
        credentials: Arc<dyn CredentialSource>,
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
            StoreWriter::new(connection, store::options(&path), Arc::clone(&dead_letters));
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

    /// Serves until `shutdown`, then closes all connections and commits what was accepted. A handle
    /// that outlives the broker can still read the queues but change nothing.
    ///
    /// # Errors
    /// [`BrokerError::Stopped`] when the writer ended early, which only a panic can cause.
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
    /// Addresses of the listeners, in the order of the configuration, with the real ports.
    #[must_use]
    pub fn local_addresses(&self) -> &[SocketAddr] {
        &self.addresses
    }

    /// Serves a peer over a stream that is open already, to its end; as strictly as one that came
    /// by a listener.
    pub async fn serve_stream(
        &self,
        stream: impl AsyncRead + AsyncWrite + Debug + Send + Unpin + 'static,
    ) {
        connection::serve_stream(Arc::clone(&self.core), stream, CancellationToken::new()).await;
    }

    /// Creates a queue, or changes the bounds of an existing one.
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

    /// Deletes a queue with its messages and dead letters, and ends its links. Returns the number of its messages.
    ///
    /// # Errors
    /// [`BrokerError::UnknownQueue`], [`BrokerError::Store`] or [`BrokerError::Stopped`].
    pub async fn delete_queue(&self, queue: &QueueName) -> Result<u64, BrokerError> {
        self.core.delete(queue).await
    }

    /// Returns the status of all queues, sorted by name.
    #[must_use]
    pub fn queues(&self) -> Vec<QueueStatus> {
        self.core.statuses()
    }

    /// Returns the status of one queue; none when it does not exist.
    #[must_use]
    pub fn queue(&self, queue: &QueueName) -> Option<QueueStatus> {
        self.core.queue(queue).map(|q| q.status())
    }

    /// Returns how much room is on the disk of the database.
    #[must_use]
    pub fn disk(&self) -> DiskState {
        self.core.disk()
    }

    /// Returns all connections, oldest first.
    #[must_use]
    pub fn connections(&self) -> Vec<ConnectionStatus> {
        self.core.connections()
    }

    /// Closes all connections of a user; returns their number.
    pub fn disconnect_user(&self, user_name: &str) -> usize {
        self.core.disconnect(user_name)
    }

    /// Returns at most `limit` dead letters with ids above `after`, oldest first.
    ///
    /// # Errors
    /// [`BrokerError::Store`].
    pub async fn dead_letters(
        &self,
        after: i64,
        limit: u32,
    ) -> Result<Vec<BrokerDeadLetter>, BrokerError> {
        let read = store::dead_letters(self.core.readers(), after, limit).await;
        read.map_err(|source| BrokerError::Store { action: "read the dead letters", source })
    }

    /// Returns the body of a dead letter; none when it is gone.
    ///
    /// # Errors
    /// [`BrokerError::Store`].
    pub async fn dead_letter_body(&self, id: i64) -> Result<Option<Bytes>, BrokerError> {
        let read = store::dead_letter_body(self.core.readers(), id).await;
        let read =
            read.map_err(|source| BrokerError::Store { action: "read a dead letter", source })?;
        Ok(read.map(Bytes::from))
    }

    /// Appends dead letters to their former queues; returns their number. Letters stay whose queue
    /// was deleted, or which a consumer has leased.
    ///
    /// # Errors
    /// [`BrokerError::Store`] or [`BrokerError::Stopped`].
    pub async fn replay_dead_letters(&self, ids: &[i64]) -> Result<u64, BrokerError> {
        let requested: HashSet<i64> = ids.iter().copied().collect();
        let first = requested.iter().copied().min().unwrap_or(0);
        let limit = self.core.config.limits.dead_letters_max.try_into().unwrap_or(u32::MAX);
        let mut letters = self.dead_letters(first - 1, limit).await?;
        letters.retain(|letter| requested.contains(&letter.id));
        let mut moves = Vec::new();
        for letter in letters {
            let Some(queue) = self.core.queue(&letter.queue) else { continue };
            let Some(entry) = self.core.dead_letters.withdraw(letter.id) else { continue };
            moves.push((
                entry,
                QueueEntry { id: self.core.next_message_id(), delivery_count: 0, ..entry },
                queue,
            ));
        }
        let numbers = moves.iter().map(|(old, new, queue)| (old.id, new.id, queue.id)).collect();
        let answer = self
            .core
            .writer
            .ask(|done| StoreCommand::ReplayDeadLetters { moves: numbers, done })
            .await;
        let is_moved = matches!(answer, Some(Ok(())));
        let count = moves.len() as u64;
        for (old, new, queue) in moves {
            if is_moved { queue.adopt(new) } else { self.core.dead_letters.adopt(old) }
        }
        answered(answer, "replay dead letters").map(|()| count)
    }

    /// Removes dead letters for good; returns their number.
    ///
    /// # Errors
    /// [`BrokerError::Store`] or [`BrokerError::Stopped`].
    pub async fn purge_dead_letters(&self, ids: &[i64]) -> Result<u64, BrokerError> {
        let gone: Vec<_> =
            ids.iter().filter_map(|id| self.core.dead_letters.withdraw(*id)).collect();
        let numbers = gone.iter().map(|entry| entry.id).collect();
        let answer = self
            .core
            .writer
            .ask(|done| StoreCommand::PurgeDeadLetters { ids: numbers, done })
            .await;
        if !matches!(answer, Some(Ok(()))) {
            gone.iter().for_each(|entry| self.core.dead_letters.adopt(*entry));
        }
        answered(answer, "purge dead letters").map(|()| gone.len() as u64)
    }
}

/// Turns the writer's reply into the result of the operation that `action` names.
fn answered(
    answer: Option<Result<(), sqlx::Error>>,
    action: &'static str,
) -> Result<(), BrokerError> {
    answer.ok_or(BrokerError::Stopped)?.map_err(|source| BrokerError::Store { action, source })
}
