//! The broker's database: one SQLite file with full synchronisation, one writer that commits in
//! groups, a few readers.

mod command;
mod dead_letters;
mod reader;
mod space;
mod statements;
mod writer;

use std::{path::Path, time::Duration};

use sqlx::{
    ConnectOptions, SqliteConnection,
    sqlite::{
        SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
    },
};

pub(crate) use command::{
    DeadLettering, LinkOrder, NewMessage, StoreCommand, WriteFailed, WriterHandle,
};
pub(crate) use dead_letters::{dead_letter_body, dead_letters, dead_letters_beyond};
pub(crate) use reader::{bodies, load};
pub(crate) use writer::StoreWriter;

/// Schema version 1. Message ids are given by the broker and grow; they are the order of a queue.
const SCHEMA: &str = "
BEGIN;
CREATE TABLE queues (
    id INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    messages_max INTEGER NOT NULL,
    bytes_max INTEGER NOT NULL,
    deliveries_max INTEGER NOT NULL,
    is_single_active_consumer INTEGER NOT NULL
) STRICT;
CREATE TABLE messages (
    id INTEGER PRIMARY KEY,
    queue_id INTEGER NOT NULL,
    bytes INTEGER NOT NULL,
    expires_at_ms INTEGER,
    delivery_count INTEGER NOT NULL DEFAULT 0,
    body BLOB NOT NULL
) STRICT;
CREATE TABLE dead_letters (
    message_id INTEGER PRIMARY KEY,
    origin TEXT NOT NULL,
    wire_id TEXT,
    subject TEXT,
    principal TEXT,
    code TEXT NOT NULL,
    reason TEXT NOT NULL,
    at_ms INTEGER NOT NULL,
    bytes INTEGER NOT NULL
) STRICT;
PRAGMA user_version = 1;
COMMIT;
";

/// Connection options of the broker's database.
pub(crate) fn options(path: &Path) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(path)
        .create_if_missing(true)
        .journal_mode(SqliteJournalMode::Wal)
        // A publisher is answered after the commit, which must survive a power cut.
        .synchronous(SqliteSynchronous::Full)
        .busy_timeout(Duration::from_secs(10))
        // 64 MiB: the log would keep the size of the largest burst.
        .pragma("journal_size_limit", "67108864")
        .disable_statement_logging()
}

/// Opens the file for writing, created when missing, and migrates it.
pub(crate) async fn open_writer(path: &Path) -> Result<SqliteConnection, sqlx::Error> {
    let mut connection = options(path).connect().await?;
    let version: i64 = sqlx::query_scalar("PRAGMA user_version").fetch_one(&mut connection).await?;
    match version {
        0 => {
            sqlx::raw_sql(SCHEMA).execute(&mut connection).await?;
        }
        1 => {}
        newer => {
            return Err(sqlx::Error::Configuration(
                format!("the file was written by a newer broker (schema version {newer})").into(),
            ));
        }
    }
    space::prepare(&mut connection).await;
    Ok(connection)
}

/// Opens the file for reading.
pub(crate) async fn open_readers(path: &Path) -> Result<SqlitePool, sqlx::Error> {
    SqlitePoolOptions::new()
        .max_connections(4)
        .connect_with(options(path).read_only(true).create_if_missing(false))
        .await
}

/// Inserts the queue of the dead letters if it is missing.
pub(crate) async fn ensure_dead_letters(
    connection: &mut SqliteConnection,
    name: &str,
) -> Result<(), sqlx::Error> {
    sqlx::query(
        "INSERT OR IGNORE INTO queues \
         (name, messages_max, bytes_max, deliveries_max, is_single_active_consumer) \
         VALUES (?, ?, ?, ?, 0)",
    )
    .bind(name)
    .bind(i64::MAX)
    .bind(i64::MAX)
    .bind(i64::from(u32::MAX))
    .execute(connection)
    .await?;
    Ok(())
}
