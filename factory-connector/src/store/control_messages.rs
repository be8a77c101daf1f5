//! Control messages that wait to be sent: acknowledgements, decisions, gaps, comments, metadata.

use asi_model::{DateTime, MessageId};
use messaging::spool::Fetch;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    ControlRow,
    error::StoreError,
    query::{all, one, query},
    row::{Columns as _, signed},
    statement::{write_ids, write_rows},
};

/// A control message that waits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ControlMessage {
    /// Number in the spool.
    pub id: i64,
    pub message_id: MessageId,
    /// Type of the message.
    pub subject: String,
    /// Id of the message that this one answers.
    pub correlation_id: Option<MessageId>,
    pub body: String,
    pub created_at: DateTime,
    /// Time to live in milliseconds; unlimited without it.
    pub ttl_ms: Option<u64>,
    /// Number of rejections by the broker.
    pub attempts: u32,
}

/// Number, size and age of waiting control messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ControlBacklog {
    pub waiting: u64,
    pub bytes: u64,
    pub oldest_at: Option<DateTime>,
}

/// Reads the waiting messages after a number, oldest first.
pub(super) async fn waiting(
    connection: &mut SqliteConnection,
    fetch: Fetch,
) -> Result<Vec<ControlMessage>, StoreError> {
    let sql = "SELECT * FROM control
               WHERE state = 'WAITING' AND id > ? AND id <= ? ORDER BY id LIMIT ?";
    let query = query(sql)
        .bind(fetch.after.0)
        .bind(fetch.through.map_or(i64::MAX, |id| id.0))
        .bind(i64::try_from(fetch.limit).unwrap_or(i64::MAX));
    all(connection, query, "read the spool", message).await
}

/// Measures the waiting messages.
pub(super) async fn backlog(
    connection: &mut SqliteConnection,
) -> Result<ControlBacklog, StoreError> {
    let sql = "SELECT count(*) AS waiting, coalesce(sum(length(body)), 0) AS bytes,
                   min(created_at) AS oldest_at
               FROM control WHERE state = 'WAITING'";
    one(connection, query(sql), "measure the spool", |row| {
        Ok(ControlBacklog {
            waiting: row.number("waiting")?,
            bytes: row.number("bytes")?,
            oldest_at: row.time_option("oldest_at")?,
        })
    })
    .await
}

fn message(row: &SqliteRow) -> Result<ControlMessage, StoreError> {
    Ok(ControlMessage {
        id: row.column("id")?,
        message_id: row.parsed("message_id")?,
        subject: row.column("subject")?,
        correlation_id: row.parsed_option("correlation_id")?,
        body: row.column("body")?,
        created_at: row.time("created_at")?,
        ttl_ms: row.number_option("ttl_ms")?,
        attempts: row.number("attempts")?,
    })
}

pub(super) fn write(connection: &Connection, messages: &[ControlRow]) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO control (id, message_id, subject, correlation_id, body, created_at, ttl_ms)
         VALUES (?, ?, ?, ?, ?, ?, ?)",
        messages,
        |row| {
            (
                row.id,
                row.message_id.as_str(),
                &row.subject,
                row.correlation_id.as_ref().map(MessageId::as_str),
                &*row.body,
                row.created_at.unix_micros(),
                row.ttl_ms.map(signed),
            )
        },
    )
}

/// Removes messages that were sent or have expired.
pub(super) fn remove(connection: &Connection, ids: &[i64]) -> rusqlite::Result<()> {
    let sql = "DELETE FROM control WHERE id IN (SELECT value FROM json_each(?))";
    write_ids(connection, sql, ids)
}

/// Sets messages aside that the broker will never accept.
pub(super) fn park(connection: &Connection, ids: &[i64]) -> rusqlite::Result<()> {
    let sql = "UPDATE control SET state = 'PARKED' WHERE id IN (SELECT value FROM json_each(?))";
    write_ids(connection, sql, ids)
}

/// Counts one rejection more of messages.
pub(super) fn count_attempt(connection: &Connection, ids: &[i64]) -> rusqlite::Result<()> {
    let sql = "UPDATE control SET attempts = attempts + 1
               WHERE id IN (SELECT value FROM json_each(?))";
    write_ids(connection, sql, ids)
}
