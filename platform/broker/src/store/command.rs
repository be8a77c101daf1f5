//! Commands to the writer, and the handle that sends them.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use tokio::sync::{OwnedSemaphorePermit, mpsc, oneshot};

use crate::{
    config::QueueOptions,
    message::Features,
    queue::{Queue, QueueEntry},
};

/// Order of the messages of one publisher's link: once one of them could not be stored, none behind it is. The publisher
/// sends them all again, on another link.
#[derive(Debug, Clone, Default)]
pub(crate) struct LinkOrder(Arc<AtomicBool>);

impl LinkOrder {
    /// Refuses all messages behind one that could not be stored.
    pub(super) fn refuse_later(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Returns a number that all messages of the link have, and those of no other.
    pub(super) fn link(&self) -> usize {
        Arc::as_ptr(&self.0).addr()
    }

    /// Returns true behind a message that could not be stored.
    pub(super) fn is_refused(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A message to insert.
#[derive(Debug)]
pub(crate) struct NewMessage {
    pub queue: Arc<Queue>,
    pub entry: QueueEntry,
    /// Message as AMQP bytes, in the form in which it is stored.
    pub wire: Vec<u8>,
    /// Order of the link that it came by.
    pub order: LinkOrder,
    /// Share of what the user may have uncommitted, given back with the command.
    pub uncommitted: OwnedSemaphorePermit,
    /// Notified after the commit.
    pub done: oneshot::Sender<Result<(), WriteFailed>>,
}

/// A message on its way to the dead letters.
#[derive(Debug)]
pub(crate) struct DeadLettering {
    pub entry: QueueEntry,
    pub origin: Arc<Queue>,
    pub features: Features,
    pub code: String,
    pub reason: String,
    /// Set after the commit. Set before, a sweep in between would take the letter for one that was looked at.
    pub is_new: Arc<AtomicBool>,
}

/// The transaction failed or the writer has stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct WriteFailed;

/// Reply channel of a command with an answer.
type Done<T> = oneshot::Sender<Result<T, sqlx::Error>>;

/// One change of the database.
#[derive(Debug)]
pub(crate) enum StoreCommand {
    /// Insert a message; after the commit it becomes ready.
    Insert(NewMessage),
    /// Delete a message by its id.
    Remove(i64),
    /// Record the number of failed deliveries.
    CountDelivery { id: i64, delivery_count: u32 },
    /// Move a message to the dead letters; after the commit it becomes ready there.
    DeadLetter(Box<DeadLettering>),
    /// Create a queue or change its bounds.
    DeclareQueue { id: i64, name: String, options: QueueOptions, done: Done<()> },
    /// Delete a queue with its messages and dead letters.
    DeleteQueue { id: i64, name: String, done: Done<()> },
    /// Move dead letters back to queues: old message id, new message id, queue id.
    ReplayDeadLetters { moves: Vec<(i64, i64, i64)>, done: Done<()> },
    /// Delete dead letters by message id.
    PurgeDeadLetters { ids: Vec<i64>, done: Done<()> },
}

impl StoreCommand {
    /// Returns true for a message behind one of the same link that could not be stored.
    pub(super) fn is_refused(&self) -> bool {
        matches!(self, Self::Insert(new) if new.order.is_refused())
    }

    /// Returns whether the command frees space.
    pub(super) const fn deletes(&self) -> bool {
        matches!(self, Self::Remove(_) | Self::DeleteQueue { .. } | Self::PurgeDeadLetters { .. })
    }
}

/// Sender of commands to the writer; clones share its queue.
#[derive(Debug, Clone)]
pub(crate) struct WriterHandle {
    pub(super) commands: mpsc::Sender<StoreCommand>,
}

impl WriterHandle {
    /// Enqueues a command; waits while the queue is full. Fails when the writer has stopped.
    pub(crate) async fn send(&self, command: StoreCommand) -> Result<(), WriteFailed> {
        self.commands.send(command).await.map_err(|_| WriteFailed)
    }

    /// Waits for the place of one command. Fails when the writer has stopped.
    pub(crate) async fn place(&self) -> Result<mpsc::Permit<'_, StoreCommand>, WriteFailed> {
        self.commands.reserve().await.map_err(|_| WriteFailed)
    }

    /// Enqueues a command and waits for its answer; none when the writer has stopped.
    pub(crate) async fn ask<T>(
        &self,
        command: impl FnOnce(Done<T>) -> StoreCommand,
    ) -> Option<Result<T, sqlx::Error>> {
        let (done, answer) = oneshot::channel();
        self.send(command(done)).await.ok()?;
        answer.await.ok()
    }
}
