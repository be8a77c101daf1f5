//! Ids of messages whose effect is stored, so that a repeated delivery has none.

use asi_model::{DateTime, MessageId};
use rusqlite::Connection;
use sqlx::SqliteConnection;

use super::{
    error::StoreError,
    query::{all, query},
    row::{Columns as _, document},
    statement::{run, write_rows},
};

/// Time for which ids are remembered, in microseconds: longer than any broker keeps a message.
const REMEMBERED_MICROS: i64 = 90 * 86_400 * 1_000_000;

/// Repository of received messages.
pub struct ReceivedMessages<'c>(pub(super) &'c mut SqliteConnection);

impl ReceivedMessages<'_> {
    /// Returns those of the ids whose effect is stored.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn known_of(&mut self, message_ids: &[String]) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT message_id FROM seen
                   WHERE message_id IN (SELECT value FROM json_each(?))";
        let query = query(sql).bind(document(message_ids));
        all(self.0, query, "look for repeated messages", |row| row.column("message_id")).await
    }
}

/// Remembers ids with the times of their arrival, and forgets those that are old enough.
pub(super) fn write(
    connection: &Connection,
    received: &[(MessageId, DateTime)],
) -> rusqlite::Result<()> {
    let Some((_, now)) = received.last() else { return Ok(()) };
    write_rows(
        connection,
        "INSERT OR IGNORE INTO seen (message_id, seen_at) VALUES (?, ?)",
        received,
        |(message_id, at)| (message_id.as_str(), at.unix_micros()),
    )?;
    let oldest = now.unix_micros() - REMEMBERED_MICROS;
    run(connection, "DELETE FROM seen WHERE seen_at < ?", (oldest,)).map(drop)
}
