//! Signed statements of all chains' heads, for people to compare and keep elsewhere.

use asi_model::DateTime;
use sqlx::SqlitePool;

use crate::store::{
    StoreError,
    load::{get, unsigned},
};

/// A checkpoint with its signature.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredCheckpoint {
    /// Its place, from 1 without gaps.
    pub number: u64,
    /// When it was made.
    pub recorded_at: DateTime,
    /// The exact text that was signed.
    pub signed_text: String,
    /// The Ed25519 signature over that text.
    pub signature: Vec<u8>,
    /// The key it is verified with.
    pub public_key: Vec<u8>,
}

/// Checkpoints, newest first, before a number.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn ledger_checkpoints(
    readers: &SqlitePool,
    before: i64,
    limit: u32,
) -> Result<Vec<StoredCheckpoint>, StoreError> {
    let rows = sqlx::query(
        "SELECT number, recorded_at, content, signature, public_key FROM ledger_checkpoint WHERE number < ? \
         ORDER BY number DESC LIMIT ?",
    )
    .bind(before)
    .bind(i64::from(limit))
    .fetch_all(readers)
    .await
    .map_err(StoreError::while_doing("read the checkpoints"))?;
    rows.iter()
        .map(|row| {
            Ok(StoredCheckpoint {
                number: unsigned(get(row, 0)?),
                recorded_at: DateTime::from_unix_micros(get(row, 1)?),
                signed_text: get(row, 2)?,
                signature: get(row, 3)?,
                public_key: get(row, 4)?,
            })
        })
        .collect()
}
