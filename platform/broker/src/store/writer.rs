//! The only writer. Commands that arrive while a transaction is being committed share the next one,
//! so that many publishers cost one synchronisation.

use std::{
    collections::{HashMap, HashSet},
    sync::{Arc, atomic::Ordering},
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
        let Err((commands, error)) = self.commit(commands).await else { return };
        if !is_of_a_row(&error) {
            return self.all_failed(commands, error);
        }
        // One link's message that the store refuses is no reason to refuse those of others.
        let mut parts = by_link(commands);
        let only = if parts.len() == 1 { parts.pop() } else { None };
        if let Some(only) = only {
            return self.all_failed(only, error);
        }
        for part in parts {
            if let Err((part, error)) = self.commit(part).await {
                self.all_failed(part, error);
            }
        }
    }

    /// Commits commands in one transaction, and answers them. Gives them back with the error where there is one.
    async fn commit(
        &mut self,
        commands: Vec<StoreCommand>,
    ) -> Result<(), (Vec<StoreCommand>, sqlx::Error)> {
        let started = Instant::now();
        match apply(&mut self.connection, &commands, &self.dead_letters).await {
            Ok(with_their_queue) => {
                metrics::histogram!("broker_commit_seconds")
                    .record(started.elapsed().as_secs_f64());
                self.has_free_space |= commands.iter().any(StoreCommand::deletes);
                for id in &with_their_queue {
                    self.dead_letters.forget(*id);
                }
                for command in commands {
                    self.committed(command, &with_their_queue);
                }
                Ok(())
            }
            Err(error) => {
                error!(
                    %error, commands = commands.len(),
                    "the broker's database refused a transaction; publishers keep their messages"
                );
                metrics::counter!("broker_commit_failures_total").increment(1);
                self.replace_connection().await;
                Err((commands, error))
            }
        }
    }

    /// Answers commands whose transaction failed, or retains them.
    fn all_failed(&mut self, commands: Vec<StoreCommand>, error: sqlx::Error) {
        let mut error = Some(error);
        for command in commands {
            self.failed(command, &mut error);
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

    /// Makes the effects of a committed command visible and answers it. Messages that went with their queue are no dead
    /// letters.
    fn committed(&self, command: StoreCommand, with_their_queue: &HashSet<i64>) {
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
                if !with_their_queue.contains(&letter.entry.id) {
                    self.dead_letters.adopt(QueueEntry {
                        delivery_count: 0,
                        expires_at_ms: None,
                        ..letter.entry
                    });
                    letter.is_new.store(true, Ordering::Relaxed);
                }
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

/// Returns true for an error of what is written, which is none of the store: others can be written.
fn is_of_a_row(error: &sqlx::Error) -> bool {
    // Too big, against a constraint or a trigger, of another type.
    const OF_A_ROW: [i32; 3] = [18, 19, 20];
    match error {
        sqlx::Error::Database(error) => {
            let code = error.code().and_then(|code| code.parse::<i32>().ok());
            // The upper bytes of a code say more of the same.
            code.is_some_and(|code| OF_A_ROW.contains(&(code & 0xff)))
        }
        sqlx::Error::Encode(_) => true,
        _ => false,
    }
}

/// Returns commands in parts that can fail each by itself: declarations, the messages of each link, and all else.
fn by_link(commands: Vec<StoreCommand>) -> Vec<Vec<StoreCommand>> {
    let (mut declarations, mut others) = (Vec::new(), Vec::new());
    let mut links: HashMap<usize, Vec<StoreCommand>> = HashMap::new();
    for command in commands {
        match &command {
            StoreCommand::DeclareQueue { .. } => declarations.push(command),
            StoreCommand::Insert(new) => links.entry(new.order.link()).or_default().push(command),
            _ => others.push(command),
        }
    }
    let parts = std::iter::once(declarations).chain(links.into_values());
    parts.chain([others]).filter(|part| !part.is_empty()).collect()
}

#[cfg(test)]
mod tests;
