//! Messages that were received or sent and rejected, for people to look at.

use asi_model::{DateTime, MessageId};
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    DeadLetterRow,
    error::StoreError,
    names::Named,
    query::{all, query},
    row::Columns as _,
    statement::{run, write_rows},
};

/// Dead letters stored at most; beyond, the oldest are removed. A peer that sends rubbish must not
/// fill the disk.
const DEAD_LETTERS_MAX: i64 = 10_000;

/// Direction of a rejected message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Direction {
    Received,
    Sent,
}

impl Named for Direction {
    const ALL: &'static [Self] = &[Self::Received, Self::Sent];

    fn name(self) -> &'static str {
        match self {
            Self::Received => "RECEIVED",
            Self::Sent => "SENT",
        }
    }
}

/// A message that was received or sent and rejected.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct DeadLetter {
    /// Number of the dead letter, as text.
    pub id: String,
    /// `RECEIVED` or `SENT`.
    pub direction: String,
    /// Id of the message; none for one that could not be read.
    pub message_id: Option<String>,
    /// Type of the message, as far as it is known.
    pub subject: String,
    /// Cause of the rejection, as a code.
    pub code: String,
    /// Cause of the rejection, in words.
    pub reason: String,
    pub at: DateTime,
    /// Size of the body, in bytes.
    pub bytes: i64,
}

/// Repository of dead letters.
pub struct DeadLetters<'c>(pub(super) &'c mut SqliteConnection);

impl DeadLetters<'_> {
    /// Reads dead letters with smaller numbers than `before`, newest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn page(&mut self, before: i64, limit: u32) -> Result<Vec<DeadLetter>, StoreError> {
        let sql = "SELECT id, direction, message_id, subject, code, reason, occurred_at,
                       length(body) AS bytes
                   FROM dead_letter WHERE id < ? ORDER BY id DESC LIMIT ?";
        let query = query(sql).bind(before).bind(i64::from(limit));
        all(self.0, query, "read the dead letters", dead_letter).await
    }
}

fn dead_letter(row: &SqliteRow) -> Result<DeadLetter, StoreError> {
    Ok(DeadLetter {
        id: row.column::<i64>("id")?.to_string(),
        direction: row.named::<Direction>("direction")?.name().to_owned(),
        message_id: row.column("message_id")?,
        subject: row.column("subject")?,
        code: row.column("code")?,
        reason: row.column("reason")?,
        at: row.time("occurred_at")?,
        bytes: row.column("bytes")?,
    })
}

/// Stores dead letters and removes the oldest beyond the bound.
pub(super) fn write(connection: &Connection, letters: &[DeadLetterRow]) -> rusqlite::Result<()> {
    if letters.is_empty() {
        return Ok(());
    }
    write_rows(
        connection,
        "INSERT INTO dead_letter (direction, message_id, subject, code, reason, body, occurred_at)
         VALUES (?, ?, ?, ?, ?, ?, ?)",
        letters,
        |row| {
            let direction = if row.is_received { Direction::Received } else { Direction::Sent };
            (
                direction.name(),
                row.message_id.as_ref().map(MessageId::as_str),
                &row.subject,
                &row.code,
                &row.reason,
                &row.body,
                row.occurred_at.unix_micros(),
            )
        },
    )?;
    run(
        connection,
        "DELETE FROM dead_letter WHERE id <= (SELECT max(id) FROM dead_letter) - ?",
        (DEAD_LETTERS_MAX,),
    )
    .map(drop)
}
