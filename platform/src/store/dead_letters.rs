//! Dead letters: what arrived and could not be used, with the reason. Only administrators see them.

use asi_model::DateTime;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow},
};

/// A message that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewDeadLetter {
    /// Logical address of arrival.
    pub address: String,
    /// Its message id on the transport.
    pub message_id: Option<String>,
    /// Its subject on the transport.
    pub subject: String,
    /// A stable code, as `FORGED_PUBLISHER`.
    pub code: &'static str,
    /// Reason in a sentence for people; never contains plant values.
    pub reason: String,
    /// Time of arrival at the platform.
    pub received_at: DateTime,
    /// Its body, as it travelled.
    pub body: Vec<u8>,
    /// Content encoding of the body.
    pub content_encoding: Option<&'static str>,
    /// The signature that it came with.
    pub signature: Option<String>,
}

/// A stored dead letter as far as a replay needs it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeadLetterContent {
    /// Logical address of arrival.
    pub address: String,
    /// Its message id on the transport.
    pub message_id: Option<String>,
    /// Its subject on the transport.
    pub subject: String,
    /// Its body, as it travelled.
    pub body: Vec<u8>,
    /// Content encoding of the body.
    pub content_encoding: Option<String>,
    /// The signature that it came with.
    pub signature: Option<String>,
}

/// A stored dead letter, without its body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredDeadLetter {
    pub dead_letter_id: u64,
    /// Logical address of arrival.
    pub address: String,
    /// Its message id on the transport.
    pub message_id: Option<String>,
    /// Its subject on the transport.
    pub subject: String,
    /// A stable code.
    pub code: String,
    /// Reason in a sentence for people.
    pub reason: String,
    /// Time of arrival at the platform.
    pub received_at: DateTime,
    /// Size of the body.
    pub bytes: u64,
    /// Time of the last replay; absent before the first.
    pub replayed_at: Option<DateTime>,
}

/// Repository of dead letters.
pub struct DeadLetters<'w>(pub(super) &'w mut Connection);

/// Most dead letters retained of one address, which is to say of one factory or tool; the oldest are
/// removed first, and never those of another address.
pub const DEAD_LETTERS_PER_ADDRESS_MAX: u32 = 1_000;
/// Most bytes of the bodies of these.
pub const DEAD_LETTER_BYTES_PER_ADDRESS_MAX: u32 = 64 * 1024 * 1024;

impl DeadLetters<'_> {
    /// Stores one; beyond the bounds of its address the oldest of this address go. Returns their number.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add(&mut self, letter: &NewDeadLetter) -> Result<u64, StoreError> {
        let sql = "INSERT INTO dead_letter (address, message_id, subject, code, reason, received_at, body,
                       content_encoding, signature, bytes) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)";
        sqlx::query(sql)
            .bind(&letter.address)
            .bind(letter.message_id.as_deref())
            .bind(&letter.subject)
            .bind(letter.code)
            .bind(&letter.reason)
            .bind(letter.received_at.ticks())
            .bind(&letter.body)
            .bind(letter.content_encoding)
            .bind(letter.signature.as_deref())
            .bind(i64::try_from(letter.body.len()).unwrap_or(i64::MAX))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a dead letter"))?;
        self.forget_oldest(&letter.address).await
    }

    async fn forget_oldest(&mut self, address: &str) -> Result<u64, StoreError> {
        // The index has all that the inner query reads: no body is touched.
        let sql = "DELETE FROM dead_letter WHERE address = $1 AND dead_letter_id <= (
                       SELECT MAX(dead_letter_id) FROM (
                           SELECT dead_letter_id, ROW_NUMBER() OVER newest AS position,
                               SUM(bytes) OVER newest AS total
                           FROM dead_letter WHERE address = $1
                           WINDOW newest AS (ORDER BY dead_letter_id DESC)) AS counted
                       WHERE position > $2 OR (position > 1 AND total > $3))";
        let forgotten = sqlx::query(sql)
            .bind(address)
            .bind(i64::from(DEAD_LETTERS_PER_ADDRESS_MAX))
            .bind(i64::from(DEAD_LETTER_BYTES_PER_ADDRESS_MAX))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget the oldest dead letters"))?;
        Ok(forgotten.rows_affected())
    }

    /// Returns a page, newest first, of those with a smaller number than `before`.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(
        &mut self,
        before: Option<u64>,
        limit: u32,
    ) -> Result<Vec<StoredDeadLetter>, StoreError> {
        let sql = "SELECT dead_letter_id, address, message_id, subject, code, reason, received_at, replayed_at,
                       bytes FROM dead_letter WHERE dead_letter_id < $1
                   ORDER BY dead_letter_id DESC LIMIT $2";
        let rows = sqlx::query(sql)
            .bind(before.and_then(|id| i64::try_from(id).ok()).unwrap_or(i64::MAX))
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list dead letters"))?;
        rows.iter().map(read).collect()
    }

    /// Reads what a replay needs.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn content(&mut self, id: u64) -> Result<Option<DeadLetterContent>, StoreError> {
        let sql = "SELECT address, message_id, subject, body, content_encoding, signature
                   FROM dead_letter WHERE dead_letter_id = $1";
        let row = sqlx::query(sql)
            .bind(i64::try_from(id).unwrap_or(i64::MAX))
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("read a dead letter"))?;
        row.map(|row| {
            Ok(DeadLetterContent {
                address: row.column("address")?,
                message_id: row.column("message_id")?,
                subject: row.column("subject")?,
                body: row.column("body")?,
                content_encoding: row.column("content_encoding")?,
                signature: row.column("signature")?,
            })
        })
        .transpose()
    }

    /// Notes that one was tried again.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn replayed(&mut self, id: u64, now: DateTime) -> Result<(), StoreError> {
        sqlx::query("UPDATE dead_letter SET replayed_at = $2 WHERE dead_letter_id = $1")
            .bind(i64::try_from(id).unwrap_or(i64::MAX))
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note that a dead letter was tried again"))?;
        Ok(())
    }
}

fn read(row: &DatabaseRow) -> Result<StoredDeadLetter, StoreError> {
    Ok(StoredDeadLetter {
        dead_letter_id: row.unsigned("dead_letter_id")?,
        address: row.column("address")?,
        message_id: row.column("message_id")?,
        subject: row.column("subject")?,
        code: row.column("code")?,
        reason: row.column("reason")?,
        received_at: row.time("received_at")?,
        bytes: row.unsigned("bytes")?,
        replayed_at: row.time_option("replayed_at")?,
    })
}
