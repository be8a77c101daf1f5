//! The only writer. Commands that arrive while a transaction is being committed share the next one,
//! so that many publishers cost one synchronisation.

use std::sync::Arc;

use sqlx::{
    ConnectOptions as _, Connection as _, QueryBuilder, Sqlite, SqliteConnection,
    sqlite::SqliteConnectOptions,
};
use tokio::sync::{mpsc, oneshot};
use tokio_util::sync::CancellationToken;
use tracing::{error, warn};

use super::reader::json_list;
use crate::{
    config::QueueOptions,
    message::{self, Features},
    queue::{Entry, Queue},
};

/// Commands that wait for the writer.
const COMMANDS_MAX: usize = 8192;
/// Commands in one transaction.
const GROUP_MAX: usize = 2048;
/// Pause before changes that failed are tried again.
const RETRY_AFTER: std::time::Duration = std::time::Duration::from_secs(1);
/// Rows in one INSERT.
const ROWS_PER_INSERT: usize = 64;

/// A message to store.
#[derive(Debug)]
pub(crate) struct NewMessage {
    pub queue: Arc<Queue>,
    pub entry: Entry,
    pub wire: Vec<u8>,
    pub done: oneshot::Sender<Result<(), WriteFailed>>,
}

/// Why a message moves to the dead letters.
#[derive(Debug)]
pub(crate) struct Letter {
    pub entry: Entry,
    pub origin: Arc<Queue>,
    pub features: Features,
    pub code: String,
    pub reason: String,
}

/// The database did not take it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct WriteFailed;

type Done<T> = oneshot::Sender<Result<T, sqlx::Error>>;

/// What to write.
#[derive(Debug)]
pub(crate) enum Command {
    /// Store a message; then it becomes ready.
    Insert(NewMessage),
    /// Forget a message.
    Remove(i64),
    /// Record how often receivers failed on a message.
    Count { id: i64, delivery_count: u32 },
    /// Move a message to the dead letters; then it becomes ready there.
    Bury(Box<Letter>),
    /// Make a queue or change its bounds.
    DeclareQueue { id: i64, name: String, options: QueueOptions, done: Done<()> },
    /// Remove a queue with its messages.
    DeleteQueue { id: i64, done: Done<()> },
    /// Move dead letters back: old id, new id, queue.
    Unbury { moves: Vec<(i64, i64, i64)>, done: Done<()> },
    /// Remove dead letters.
    Purge { ids: Vec<i64>, done: Done<()> },
}

/// Sends to the writer.
#[derive(Debug, Clone)]
pub(crate) struct WriterHandle {
    commands: mpsc::Sender<Command>,
}

impl WriterHandle {
    /// Hands a command over; waits while too many wait. Fails when the writer has stopped.
    pub(crate) async fn send(&self, command: Command) -> Result<(), WriteFailed> {
        self.commands.send(command).await.map_err(|_| WriteFailed)
    }

    /// Hands over a command that answers, and waits for the answer. None when the writer has
    /// stopped.
    pub(crate) async fn ask<T>(
        &self,
        command: impl FnOnce(Done<T>) -> Command,
    ) -> Option<Result<T, sqlx::Error>> {
        let (done, answer) = oneshot::channel();
        self.send(command(done)).await.ok()?;
        answer.await.ok()
    }
}

/// The writer; [`run`](Self::run) it on a task of its own.
pub(crate) struct Writer {
    connection: SqliteConnection,
    /// How the connection was opened.
    options: SqliteConnectOptions,
    commands: mpsc::Receiver<Command>,
    dead_letters: Arc<Queue>,
    /// Changes that failed and are tried again; inserts never are, their publishers keep them.
    retained: Vec<Command>,
}

impl Writer {
    pub(crate) fn new(
        connection: SqliteConnection,
        options: SqliteConnectOptions,
        dead_letters: Arc<Queue>,
    ) -> (Self, WriterHandle) {
        let (sender, commands) = mpsc::channel(COMMANDS_MAX);
        (
            Self { connection, options, commands, dead_letters, retained: Vec::new() },
            WriterHandle { commands: sender },
        )
    }

    /// Writes until `stop`, then what has been handed over by then, and closes the database.
    pub(crate) async fn run(mut self, stop: CancellationToken) {
        let mut group = Vec::with_capacity(GROUP_MAX);
        loop {
            let is_retry_due = !self.retained.is_empty();
            let received = tokio::select! {
                biased;
                received = self.commands.recv_many(&mut group, GROUP_MAX) => received,
                () = stop.cancelled(), if !self.commands.is_closed() => {
                    self.commands.close();
                    continue;
                }
                () = tokio::time::sleep(RETRY_AFTER), if is_retry_due => 1,
            };
            if received == 0 {
                break;
            }
            let commands =
                std::mem::take(&mut self.retained).into_iter().chain(group.drain(..)).collect();
            self.write(commands).await;
        }
        if !self.retained.is_empty() {
            let commands = std::mem::take(&mut self.retained);
            self.write(commands).await;
        }
        if let Err(error) = self.connection.close().await {
            warn!(%error, "the broker's database did not close cleanly");
        }
    }

    async fn write(&mut self, commands: Vec<Command>) {
        let started = std::time::Instant::now();
        match apply(&mut self.connection, &commands, &self.dead_letters).await {
            Ok(()) => {
                metrics::histogram!("broker_commit_seconds")
                    .record(started.elapsed().as_secs_f64());
                for command in commands {
                    self.committed(command);
                }
            }
            Err(error) => {
                error!(%error, commands = commands.len(), "the broker's database refused a transaction; publishers keep their messages");
                metrics::counter!("broker_commit_failures_total").increment(1);
                self.replace_connection().await;
                let mut error = Some(error);
                for command in commands {
                    self.failed(command, &mut error);
                }
            }
        }
    }

    /// A full disk makes SQLite roll back by itself, which the driver takes for an open transaction
    /// for ever: the connection that failed is given up for a fresh one.
    async fn replace_connection(&mut self) {
        match self.options.connect().await {
            Ok(fresh) => drop(std::mem::replace(&mut self.connection, fresh).close_hard().await),
            Err(error) => warn!(%error, "the broker's database cannot be opened again yet"),
        }
    }

    fn committed(&self, command: Command) {
        match command {
            Command::Insert(new) => {
                new.queue.add([new.entry]);
                // The publisher may be gone; the message stays.
                let _ = new.done.send(Ok(()));
            }
            Command::Bury(letter) => {
                letter.origin.settle(&letter.entry);
                self.dead_letters.adopt(Entry {
                    delivery_count: 0,
                    expires_at_ms: None,
                    ..letter.entry
                });
            }
            Command::DeclareQueue { done, .. }
            | Command::DeleteQueue { done, .. }
            | Command::Unbury { done, .. }
            | Command::Purge { done, .. } => {
                let _ = done.send(Ok(()));
            }
            Command::Remove(_) | Command::Count { .. } => {}
        }
    }

    fn failed(&mut self, command: Command, error: &mut Option<sqlx::Error>) {
        let mut cause = || error.take().unwrap_or(sqlx::Error::WorkerCrashed);
        match command {
            Command::Insert(new) => {
                new.queue.give_back(new.entry.bytes);
                let _ = new.done.send(Err(WriteFailed));
            }
            Command::DeclareQueue { done, .. }
            | Command::DeleteQueue { done, .. }
            | Command::Unbury { done, .. }
            | Command::Purge { done, .. } => {
                let _ = done.send(Err(cause()));
            }
            kept @ (Command::Remove(_) | Command::Count { .. } | Command::Bury(_)) => {
                self.retained.push(kept)
            }
        }
    }
}

async fn apply(
    connection: &mut SqliteConnection,
    commands: &[Command],
    dead_letters: &Queue,
) -> Result<(), sqlx::Error> {
    let mut transaction = connection.begin().await?;
    for command in commands {
        if let Command::DeclareQueue { id, name, options, .. } = command {
            declare(&mut transaction, *id, name, options).await?;
        }
    }
    let new: Vec<_> = commands
        .iter()
        .filter_map(|c| if let Command::Insert(new) = c { Some(new) } else { None })
        .collect();
    insert(&mut transaction, &new).await?;
    let mut gone = Vec::new();
    for command in commands {
        match command {
            Command::Remove(id) => gone.push(*id),
            Command::Count { id, delivery_count } => {
                sqlx::query("UPDATE messages SET delivery_count = ? WHERE id = ?")
                    .bind(i64::from(*delivery_count))
                    .bind(id)
                    .execute(&mut *transaction)
                    .await?;
            }
            Command::Bury(letter) => bury(&mut transaction, letter, dead_letters.id).await?,
            Command::DeleteQueue { id, .. } => {
                sqlx::query("DELETE FROM messages WHERE queue_id = ?")
                    .bind(id)
                    .execute(&mut *transaction)
                    .await?;
                sqlx::query("DELETE FROM queues WHERE id = ?")
                    .bind(id)
                    .execute(&mut *transaction)
                    .await?;
            }
            Command::Unbury { moves, .. } => unbury(&mut transaction, moves).await?,
            Command::Purge { ids, .. } => gone.extend_from_slice(ids),
            Command::Insert(_) | Command::DeclareQueue { .. } => {}
        }
    }
    if !gone.is_empty() {
        let list = json_list(&gone);
        sqlx::query("DELETE FROM messages WHERE id IN (SELECT value FROM json_each(?))")
            .bind(&list)
            .execute(&mut *transaction)
            .await?;
        sqlx::query(
            "DELETE FROM dead_letters WHERE message_id IN (SELECT value FROM json_each(?))",
        )
        .bind(&list)
        .execute(&mut *transaction)
        .await?;
    }
    transaction.commit().await
}

async fn insert(connection: &mut SqliteConnection, new: &[&NewMessage]) -> Result<(), sqlx::Error> {
    // Few distinct lengths, so that the statements stay prepared.
    let mut rest = new;
    while !rest.is_empty() {
        let count = [ROWS_PER_INSERT, 8, 1].into_iter().find(|n| *n <= rest.len()).unwrap_or(1);
        let (rows, others) = rest.split_at(count);
        rest = others;
        let mut query = QueryBuilder::<Sqlite>::new(
            "INSERT INTO messages (id, queue_id, bytes, expires_at_ms, delivery_count, body) ",
        );
        query.push_values(rows, |mut row, new| {
            row.push_bind(new.entry.id)
                .push_bind(new.queue.id)
                .push_bind(i64::try_from(new.entry.bytes).unwrap_or(i64::MAX))
                .push_bind(new.entry.expires_at_ms)
                .push_bind(0_i64)
                .push_bind(new.wire.as_slice());
        });
        query.build().execute(&mut *connection).await?;
    }
    Ok(())
}

async fn declare(
    connection: &mut SqliteConnection,
    id: i64,
    name: &str,
    options: &QueueOptions,
) -> Result<(), sqlx::Error> {
    sqlx::query(
        "INSERT INTO queues (id, name, messages_max, bytes_max, deliveries_max, is_single_active_consumer) \
         VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET messages_max = excluded.messages_max, \
         bytes_max = excluded.bytes_max, deliveries_max = excluded.deliveries_max, \
         is_single_active_consumer = excluded.is_single_active_consumer",
    )
    .bind(id)
    .bind(name)
    .bind(i64::try_from(options.messages_max).unwrap_or(i64::MAX))
    .bind(i64::try_from(options.bytes_max).unwrap_or(i64::MAX))
    .bind(i64::from(options.deliveries_max))
    .bind(i64::from(options.is_single_active_consumer))
    .execute(connection)
    .await?;
    Ok(())
}

async fn bury(
    connection: &mut SqliteConnection,
    letter: &Letter,
    dead_letters: i64,
) -> Result<(), sqlx::Error> {
    let moved = sqlx::query(
        "UPDATE messages SET queue_id = ?, delivery_count = 0, expires_at_ms = NULL WHERE id = ?",
    )
    .bind(dead_letters)
    .bind(letter.entry.id)
    .execute(&mut *connection)
    .await?;
    if moved.rows_affected() == 0 {
        return Ok(());
    }
    sqlx::query(
        "INSERT OR REPLACE INTO dead_letters \
         (message_id, origin, wire_id, subject, principal, code, reason, at_ms, bytes) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
    )
    .bind(letter.entry.id)
    .bind(letter.origin.name.as_str())
    .bind(letter.features.message_id.as_deref())
    .bind(letter.features.subject.as_deref())
    .bind(letter.features.principal.as_deref())
    .bind(&letter.code)
    .bind(&letter.reason)
    .bind(message::now_ms())
    .bind(i64::try_from(letter.entry.bytes).unwrap_or(i64::MAX))
    .execute(connection)
    .await?;
    Ok(())
}

async fn unbury(
    connection: &mut SqliteConnection,
    moves: &[(i64, i64, i64)],
) -> Result<(), sqlx::Error> {
    for (old_id, new_id, queue_id) in moves {
        sqlx::query("UPDATE messages SET id = ?, queue_id = ?, delivery_count = 0 WHERE id = ?")
            .bind(new_id)
            .bind(queue_id)
            .bind(old_id)
            .execute(&mut *connection)
            .await?;
        sqlx::query("DELETE FROM dead_letters WHERE message_id = ?")
            .bind(old_id)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}
