//! Commands to the writer, and the handle that sends them.

use std::sync::Arc;

use tokio::sync::{OwnedSemaphorePermit, mpsc, oneshot};

use crate::{
    config::QueueOptions,
    message::Features,
    queue::{Queue, QueueEntry},
};

/// A message to insert.
#[derive(Debug)]
pub(crate) struct NewMessage {
    pub queue: Arc<Queue>,
    pub entry: QueueEntry,
    /// Message as AMQP bytes, in the form in which it is stored.
    pub wire: Vec<u8>,
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
    /// Delete a queue with its messages.
    DeleteQueue { id: i64, done: Done<()> },
    /// Move dead letters back to queues: old message id, new message id, queue id.
    ReplayDeadLetters { moves: Vec<(i64, i64, i64)>, done: Done<()> },
    /// Delete dead letters by message id.
    PurgeDeadLetters { ids: Vec<i64>, done: Done<()> },
}

impl StoreCommand {
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
