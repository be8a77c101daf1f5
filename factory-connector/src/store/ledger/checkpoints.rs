//! Checkpoints: signed statements of all chains' heads, for people to compare and store elsewhere.

use asi_model::DateTime;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use crate::store::{
    CheckpointRow,
    error::StoreError,
    query::{all, optional, query},
    row::{Columns as _, signed},
    statement::write_rows,
};

/// A checkpoint with its signature.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredCheckpoint {
    /// Number from 1 without gaps.
    pub number: u64,
    pub recorded_at: DateTime,
    /// The exact text that was signed.
    pub signed_text: String,
    /// The Ed25519 signature over that text.
    pub signature: Vec<u8>,
    /// The key it is verified with.
    pub public_key: Vec<u8>,
}

/// Repository of checkpoints.
pub struct Checkpoints<'c>(pub(in crate::store) &'c mut SqliteConnection);

const READ: &str = "read the checkpoints";

impl Checkpoints<'_> {
    /// Reads checkpoints with smaller numbers than `before`, newest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn page(
        &mut self,
        before: i64,
        limit: u32,
    ) -> Result<Vec<StoredCheckpoint>, StoreError> {
        let sql = "SELECT * FROM ledger_checkpoint WHERE number < ? ORDER BY number DESC LIMIT ?";
        let query = query(sql).bind(before).bind(i64::from(limit));
        all(self.0, query, READ, checkpoint).await
    }

    /// Returns number and time of the last checkpoint; `None` before the first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn last(&mut self) -> Result<Option<(u64, DateTime)>, StoreError> {
        let sql = "SELECT number, recorded_at FROM ledger_checkpoint ORDER BY number DESC LIMIT 1";
        let read = |row: &SqliteRow| Ok((row.number("number")?, row.time("recorded_at")?));
        optional(self.0, query(sql), READ, read).await
    }
}

fn checkpoint(row: &SqliteRow) -> Result<StoredCheckpoint, StoreError> {
    Ok(StoredCheckpoint {
        number: row.number("number")?,
        recorded_at: row.time("recorded_at")?,
        signed_text: row.column("content")?,
        signature: row.column("signature")?,
        public_key: row.column("public_key")?,
    })
}

/// Stores a new checkpoint.
pub(in crate::store) fn write(
    connection: &Connection,
    checkpoint: Option<&CheckpointRow>,
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO ledger_checkpoint (number, recorded_at, content, signature, public_key)
         VALUES (?, ?, ?, ?, ?)",
        checkpoint,
        |row| {
            (
                signed(row.number),
                row.recorded_at.unix_micros(),
                &row.content,
                &row.signature,
                &row.public_key,
            )
        },
    )
}
