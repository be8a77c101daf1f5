//! Core of the broker, shared by all connections: queues, writer, body cache, connection registry.

mod dead_letters;

use std::{
    collections::HashMap,
    net::SocketAddr,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering},
    },
};

use parking_lot::Mutex;
use sqlx::sqlite::SqlitePool;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;

use crate::{
    address::QueueName,
    cache::BodyCache,
    clock,
    config::{BrokerConfig, QueueOptions},
    credentials::CredentialSource,
    dead_letter::TOO_MANY_DELIVERIES,
    disk::{DiskRoom, DiskState, HeldByAll},
    error::BrokerError,
    guesses::Guesses,
    message::AnyMessage,
    queue::{Queue, QueueEntry},
    shares::{ShareTable, UserShare},
    status::{ConnectionStatus, QueueStatus},
    store::{self, StoreCommand, WriterHandle},
    waiting::WaitingRoom,
};

/// Bodies read in one query when one is not in the cache.
const READ_AHEAD: usize = 64;
/// Bytes of those that are read ahead.
const READ_AHEAD_BYTES: u64 = 1024 * 1024;

/// Core of one broker. Queues and connections are in memory; changes go through the writer.
pub(crate) struct Core {
    pub config: BrokerConfig,
    pub credentials: Arc<dyn CredentialSource>,
    pub writer: WriterHandle,
    pub cache: BodyCache,
    pub dead_letters: Arc<Queue>,
    disk: DiskRoom,
    readers: SqlitePool,
    queues: Mutex<HashMap<QueueName, Arc<Queue>>>,
    /// Serialises declarations and deletions: two inserts of one name would fail a transaction that
    /// other commands share.
    declaring: tokio::sync::Mutex<()>,
    next_queue_id: AtomicI64,
    next_message_id: AtomicI64,
    pub waiting: Arc<WaitingRoom>,
    pub guesses: Arc<Guesses>,
    connections: Mutex<HashMap<u64, RegisteredConnection>>,
    shares: ShareTable,
    /// True where dead letters came since the last search for those beyond their bound.
    has_new_dead_letters: Arc<AtomicBool>,
    next_connection: AtomicU64,
}

struct RegisteredConnection {
    status: ConnectionStatus,
    uncommitted: Arc<Semaphore>,
    /// Cancelled to close the connection.
    cut: CancellationToken,
}

/// Registration of a connection; dropping it unregisters.
pub(crate) struct Registration {
    core: Arc<Core>,
    id: u64,
    /// One permit per byte of the user's messages that wait for their commit, shared by all
    /// connections of the user.
    pub uncommitted: Arc<Semaphore>,
    /// Share of the user in sessions and links.
    pub share: Arc<UserShare>,
    /// Cancelled to close the connection.
    pub cut: CancellationToken,
}

impl Core {
    pub(crate) fn new(
        config: BrokerConfig,
        credentials: Arc<dyn CredentialSource>,
        writer: WriterHandle,
        readers: SqlitePool,
        queues: HashMap<QueueName, Arc<Queue>>,
        dead_letters: Arc<Queue>,
        next_message_id: i64,
    ) -> Self {
        let next_queue_id = queues.values().map(|q| q.id).max().unwrap_or(0) + 1;
        Self {
            cache: BodyCache::new(config.limits.cache_bytes_max),
            waiting: Arc::new(WaitingRoom::new(
                config.limits.unauthenticated_max,
                config.limits.unauthenticated_per_address_max,
            )),
            guesses: Arc::default(),
            disk: DiskRoom::new(config.disk.clone(), config.database_path.clone()),
            config,
            credentials,
            writer,
            dead_letters,
            readers,
            queues: Mutex::new(queues),
            declaring: tokio::sync::Mutex::new(()),
            next_queue_id: AtomicI64::new(next_queue_id),
            next_message_id: AtomicI64::new(next_message_id),
            connections: Mutex::new(HashMap::new()),
            shares: ShareTable::default(),
            // At the start, too: the bound may have been another one before.
            has_new_dead_letters: Arc::new(AtomicBool::new(true)),
            next_connection: AtomicU64::new(0),
        }
    }

    pub(crate) fn queue(&self, name: &QueueName) -> Option<Arc<Queue>> {
        self.queues.lock().get(name).cloned()
    }

    pub(crate) fn queues(&self) -> Vec<Arc<Queue>> {
        self.queues.lock().values().cloned().collect()
    }

    pub(crate) fn statuses(&self) -> Vec<QueueStatus> {
        let mut all: Vec<_> = self.queues().iter().map(|q| q.status()).collect();
        all.sort_by(|a, b| a.queue.cmp(&b.queue));
        all
    }

    /// Creates a queue or changes its bounds, durably.
    pub(crate) async fn declare(
        &self,
        name: &QueueName,
        options: QueueOptions,
    ) -> Result<Arc<Queue>, BrokerError> {
        let _turn = self.declaring.lock().await;
        self.declare_in_turn(name, options).await
    }

    async fn declare_in_turn(
        &self,
        name: &QueueName,
        options: QueueOptions,
    ) -> Result<Arc<Queue>, BrokerError> {
        let known = self.queue(name);
        let limit = self.config.limits.queues_max;
        if known.is_none() && self.queues.lock().len() >= limit {
            return Err(BrokerError::TooManyQueues { limit });
        }
        let id = known
            .as_ref()
            .map_or_else(|| self.next_queue_id.fetch_add(1, Ordering::Relaxed), |queue| queue.id);
        let answer = self
            .writer
            .ask(|done| StoreCommand::DeclareQueue { id, name: name.to_string(), options, done })
            .await;
        answer
            .ok_or(BrokerError::Stopped)?
            .map_err(|source| BrokerError::Store { action: "declare a queue", source })?;
        let queue = known.unwrap_or_else(|| Arc::new(Queue::new(id, name.clone(), options)));
        queue.set_options(options);
        self.queues.lock().insert(name.clone(), Arc::clone(&queue));
        Ok(queue)
    }

    /// Returns the queue, created with these bounds when it does not exist.
    pub(crate) async fn queue_or_declare(
        &self,
        name: &QueueName,
        options: QueueOptions,
    ) -> Result<Arc<Queue>, BrokerError> {
        let _turn = self.declaring.lock().await;
        match self.queue(name) {
            Some(queue) => Ok(queue),
            None => self.declare_in_turn(name, options).await,
        }
    }

    /// Deletes a queue with its dead letters, durably; returns the number of its messages.
    pub(crate) async fn delete(&self, name: &QueueName) -> Result<u64, BrokerError> {
        let _turn = self.declaring.lock().await;
        let queue =
            self.queue(name).ok_or_else(|| BrokerError::UnknownQueue { queue: name.clone() })?;
        let answer = self
            .writer
            .ask(|done| StoreCommand::DeleteQueue { id: queue.id, name: name.to_string(), done })
            .await;
        answer
            .ok_or(BrokerError::Stopped)?
            .map_err(|source| BrokerError::Store { action: "delete a queue", source })?;
        self.queues.lock().remove(name);
        Ok(queue.delete())
    }

    /// Looks at the disk.
    pub(crate) fn disk(&self) -> DiskState {
        self.disk.look(|| self.held_by_all())
    }

    /// Takes room on the disk for a message whose space in its queue is reserved.
    ///
    /// # Errors
    /// The reason for which there is none at the moment.
    pub(crate) fn take_room(&self, queue: &Queue, bytes: u64) -> Result<(), &'static str> {
        let held = queue.bytes().saturating_sub(bytes);
        self.disk.take(bytes, held, || self.held_by_all())
    }

    /// Counts what all queues hold, but for that of the dead letters.
    fn held_by_all(&self) -> HeldByAll {
        let queues = self.queues();
        let held = queues.iter().filter(|queue| queue.id != self.dead_letters.id);
        held.fold(HeldByAll::default(), |all, queue| HeldByAll {
            queues: all.queues + 1,
            bytes: all.bytes + queue.bytes(),
        })
    }

    pub(crate) fn next_message_id(&self) -> i64 {
        self.next_message_id.fetch_add(1, Ordering::Relaxed)
    }

    pub(crate) const fn readers(&self) -> &SqlitePool {
        &self.readers
    }

    /// Returns the body of a leased message, from the cache or from the file; none when the stored
    /// message is gone or damaged. Reads ahead what will probably be delivered next.
    pub(crate) async fn body(
        &self,
        queue: &Queue,
        entry: &QueueEntry,
    ) -> Result<Option<Arc<AnyMessage>>, sqlx::Error> {
        if let Some(message) = self.cache.get(entry.id) {
            return Ok(Some(message));
        }
        let mut ids = queue.upcoming(entry.id, READ_AHEAD, READ_AHEAD_BYTES);
        ids.retain(|id| !self.cache.contains(*id));
        ids.push(entry.id);
        let mut body = None;
        for (id, bytes, message) in store::bodies(&self.readers, &ids).await? {
            let Some(message) = message else { continue };
            let message = Arc::new(message);
            if id == entry.id {
                body = Some(Arc::clone(&message));
            }
            self.cache.insert(id, bytes, message);
        }
        Ok(body)
    }

    /// Removes a leased message that was settled or has expired.
    pub(crate) async fn remove(&self, queue: &Queue, entry: &QueueEntry) {
        self.cache.remove(entry.id);
        queue.settle(entry);
        self.write(StoreCommand::Remove(entry.id)).await;
    }

    /// Counts a failed delivery: the message is requeued, or dead-lettered at the queue's limit.
    pub(crate) async fn fail(
        &self,
        queue: &Arc<Queue>,
        mut entry: QueueEntry,
        message: &AnyMessage,
    ) {
        entry.delivery_count = entry.delivery_count.saturating_add(1);
        let limit = queue.options().deliveries_max;
        if entry.delivery_count >= limit && queue.id != self.dead_letters.id {
            let reason = format!("delivered {} times without success", entry.delivery_count);
            self.dead_letter(queue, entry, message, TOO_MANY_DELIVERIES.to_owned(), reason).await;
        } else {
            self.write(StoreCommand::CountDelivery {
                id: entry.id,
                delivery_count: entry.delivery_count,
            })
            .await;
            queue.requeue(QueueEntry { is_redelivered: true, ..entry });
        }
    }

    /// Looks at the disk, and removes expired messages and the oldest dead letters beyond their bound.
    pub(crate) async fn sweep(&self, now_ms: i64) {
        self.disk();
        for queue in self.queues() {
            for entry in queue.withdraw_expired(now_ms) {
                metrics::counter!("broker_messages_expired_total").increment(1);
                self.cache.remove(entry.id);
                self.write(StoreCommand::Remove(entry.id)).await;
            }
        }
        self.forget_dead_letters().await;
    }

    async fn write(&self, command: StoreCommand) {
        if self.writer.send(command).await.is_err() {
            // Only while the broker stops: a settlement that is not recorded means one more delivery.
            tracing::debug!("the broker's writer has stopped before a settlement was recorded");
        }
    }

    /// Registers a signed-in peer; none when its user has too many connections.
    pub(crate) fn register(
        self: &Arc<Self>,
        user_name: &str,
        peer: SocketAddr,
        cut: CancellationToken,
    ) -> Option<Registration> {
        let limits = &self.config.limits;
        let user = self.credentials.user(user_name).unwrap_or_default();
        let share = self.shares.of(user_name, &user, limits);
        let mut connections = self.connections.lock();
        let of_user: Vec<_> =
            connections.values().filter(|c| c.status.user_name == user_name).collect();
        if of_user.len() >= limits.connections_per_user_max {
            share.count_refusal("connections");
            return None;
        }
        let uncommitted = of_user.first().map_or_else(
            || Arc::new(Semaphore::new(limits.uncommitted_bytes_per_user_max as usize)),
            |other| Arc::clone(&other.uncommitted),
        );
        let id = self.next_connection.fetch_add(1, Ordering::Relaxed);
        let status =
            ConnectionStatus { user_name: user_name.to_owned(), peer, since: clock::now() };
        let registered = RegisteredConnection {
            status,
            uncommitted: Arc::clone(&uncommitted),
            cut: cut.clone(),
        };
        connections.insert(id, registered);
        Some(Registration { core: Arc::clone(self), id, uncommitted, share, cut })
    }

    pub(crate) fn connections(&self) -> Vec<ConnectionStatus> {
        let mut all: Vec<_> =
            self.connections.lock().iter().map(|(id, c)| (*id, c.status.clone())).collect();
        all.sort_by_key(|(id, _)| *id);
        all.into_iter().map(|(_, status)| status).collect()
    }

    pub(crate) fn disconnect(&self, user_name: &str) -> usize {
        let connections = self.connections.lock();
        let of_user = connections.values().filter(|c| c.status.user_name == user_name);
        of_user.map(|c| c.cut.cancel()).count()
    }
}

impl Drop for Registration {
    fn drop(&mut self) {
        self.core.connections.lock().remove(&self.id);
    }
}
