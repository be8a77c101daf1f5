//! The only writer. Commands that arrive while a transaction is being committed share the next one,
//! so that many publishers cost one synchronisation.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use sqlx::{ConnectOptions as _, Connection as _, SqliteConnection, sqlite::SqliteConnectOptions};
use tokio::sync::mpsc;
use tokio_util::sync::CancellationToken;
use tracing::{error, warn};

use super::{
    command::{StoreCommand, WriteFailed, WriterHandle},
    space,
    statements::apply,
};
use crate::queue::{Queue, QueueEntry};

/// Commands that wait for the writer.
const COMMANDS_MAX: usize = 8192;
/// Commands in one transaction, which bounds the time until the first of them is answered.
const GROUP_MAX: usize = 2048;
/// Pause before a failed transaction is tried again.
const RETRY_AFTER: Duration = Duration::from_secs(1);
/// Pause between two portions of free space that are given back.
const GIVE_BACK_EVERY: Duration = Duration::from_secs(1);

/// The writer, to be driven by [`run`](Self::run) on a task of its own.
pub(crate) struct StoreWriter {
    connection: SqliteConnection,
    /// Options to open another connection with.
    options: SqliteConnectOptions,
    commands: mpsc::Receiver<StoreCommand>,
    dead_letters: Arc<Queue>,
    /// Failed commands to be tried again. Never inserts: their publishers still have the message.
    retained: Vec<StoreCommand>,
    /// True where messages were deleted since all free space was given back.
    has_free_space: bool,
    gave_back_at: Instant,
}

impl StoreWriter {
    pub(crate) fn new(
        connection: SqliteConnection,
        options: SqliteConnectOptions,
        dead_letters: Arc<Queue>,
    ) -> (Self, WriterHandle) {
        let (sender, commands) = mpsc::channel(COMMANDS_MAX);
        (
            Self {
                connection,
                options,
                commands,
                dead_letters,
                retained: Vec::new(),
                // Of the former process.
                has_free_space: true,
                gave_back_at: Instant::now(),
            },
            WriterHandle { commands: sender },
        )
    }

    /// Writes until `stop`, then all commands enqueued by then, and closes the database.
    pub(crate) async fn run(mut self, stop: CancellationToken) {
        let mut group = Vec::with_capacity(GROUP_MAX);
        loop {
            let is_retry_due = !self.retained.is_empty();
            let received = tokio::select! {
                // Waiting commands come before the stop, which closes the channel to further ones.
                biased;
                received = self.commands.recv_many(&mut group, GROUP_MAX) => received,
                () = stop.cancelled(), if !self.commands.is_closed() => {
                    self.commands.close();
                    continue;
                }
                () = tokio::time::sleep(RETRY_AFTER), if is_retry_due => 1,
                () = tokio::time::sleep(GIVE_BACK_EVERY), if self.has_free_space => {
                    self.give_back(true).await;
                    continue;
                }
            };
            if received == 0 {
                break;
            }
            let commands =
                std::mem::take(&mut self.retained).into_iter().chain(group.drain(..)).collect();
            self.write(commands).await;
            if self.has_free_space && self.gave_back_at.elapsed() >= GIVE_BACK_EVERY {
                self.give_back(false).await;
            }
        }
        if !self.retained.is_empty() {
            let commands = std::mem::take(&mut self.retained);
            self.write(commands).await;
        }
        if let Err(error) = self.connection.close().await {
            warn!(%error, "the broker's database did not close cleanly");
        }
    }

    async fn write(&mut self, commands: Vec<StoreCommand>) {
        // They waited here before their link knew of the failure.
        let (refused, commands): (Vec<_>, Vec<_>) =
            commands.into_iter().partition(StoreCommand::is_refused);
        for command in refused {
            self.failed(command, &mut None);
        }
        if commands.is_empty() {
            return;
        }
        let started = Instant::now();
        match apply(&mut self.connection, &commands, &self.dead_letters).await {
            Ok(()) => {
                metrics::histogram!("broker_commit_seconds")
                    .record(started.elapsed().as_secs_f64());
                self.has_free_space |= commands.iter().any(StoreCommand::deletes);
                for command in commands {
                    self.committed(command);
                }
            }
            Err(error) => {
                error!(
                    %error, commands = commands.len(),
                    "the broker's database refused a transaction; publishers keep their messages"
                );
                metrics::counter!("broker_commit_failures_total").increment(1);
                self.replace_connection().await;
                let mut error = Some(error);
                for command in commands {
                    self.failed(command, &mut error);
                }
            }
        }
    }

    /// Gives back a portion of the space of deleted messages. `is_idle` says that nobody waits for the
    /// writer.
    async fn give_back(&mut self, is_idle: bool) {
        self.gave_back_at = Instant::now();
        match space::give_back(&mut self.connection, is_idle).await {
            Ok(has_more) => self.has_free_space = has_more,
            Err(error) => {
                warn!(%error, "the broker's database could not give back free space");
                // Until messages are deleted again.
                self.has_free_space = false;
            }
        }
    }

    /// Replaces a connection that failed. A full disk makes SQLite roll back by itself, which the
    /// driver takes for a transaction that stays open for ever.
    async fn replace_connection(&mut self) {
        match self.options.connect().await {
            Ok(fresh) => drop(std::mem::replace(&mut self.connection, fresh).close_hard().await),
            Err(error) => warn!(%error, "the broker's database cannot be opened again yet"),
        }
    }

    /// Makes the effects of a committed command visible and answers it.
    fn committed(&self, command: StoreCommand) {
        match command {
            StoreCommand::Insert(new) => {
                // Only now: no consumer gets what a failed transaction takes away again.
                new.queue.add([new.entry]);
                // The publisher may have left; its message is stored all the same.
                drop(new.uncommitted);
                let _ = new.done.send(Ok(()));
            }
            StoreCommand::DeadLetter(letter) => {
                letter.origin.settle(&letter.entry);
                self.dead_letters.adopt(QueueEntry {
                    delivery_count: 0,
                    expires_at_ms: None,
                    ..letter.entry
                });
            }
            StoreCommand::DeclareQueue { done, .. }
            | StoreCommand::DeleteQueue { done, .. }
            | StoreCommand::ReplayDeadLetters { done, .. }
            | StoreCommand::PurgeDeadLetters { done, .. } => {
                let _ = done.send(Ok(()));
            }
            StoreCommand::Remove(_) | StoreCommand::CountDelivery { .. } => {}
        }
    }

    /// Answers a command whose transaction failed, or retains it for the next one.
    fn failed(&mut self, command: StoreCommand, error: &mut Option<sqlx::Error>) {
        let mut cause = || error.take().unwrap_or(sqlx::Error::WorkerCrashed);
        match command {
            StoreCommand::Insert(new) => {
                new.order.refuse_later();
                new.queue.release_reservation(new.entry.bytes);
                drop(new.uncommitted);
                let _ = new.done.send(Err(WriteFailed));
            }
            StoreCommand::DeclareQueue { done, .. }
            | StoreCommand::DeleteQueue { done, .. }
            | StoreCommand::ReplayDeadLetters { done, .. }
            | StoreCommand::PurgeDeadLetters { done, .. } => {
                let _ = done.send(Err(cause()));
            }
            unanswered @ (StoreCommand::Remove(_)
            | StoreCommand::CountDelivery { .. }
            | StoreCommand::DeadLetter(_)) => {
                self.retained.push(unanswered);
            }
        }
    }
}
