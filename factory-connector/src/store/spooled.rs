//! The spool as people look at it.

use asi_model::DateTime;
use serde::Serialize;
use serde_json::Value;
use sqlx::SqliteConnection;

use super::{StoreError, load::get};

/// A report or control message that the spool holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SpooledMessage {
    /// Its number.
    pub id: i64,
    /// `WAITING`, `SENT` (without a receipt yet) or `PARKED` (set aside, for the broker will not
    /// take it).
    pub state: String,
    /// `report writer/epoch/sequence`, or the type of the control message.
    pub about: String,
    /// Its size, in bytes.
    pub bytes: i64,
    /// When it was made.
    pub created_at: DateTime,
    /// When the broker accepted it last.
    pub sent_at: Option<DateTime>,
    /// How often the broker rejected it.
    pub attempts: i64,
    /// What it says.
    pub body: Value,
}

/// What the spool holds after a number, in the order of the numbers.
///
/// # Errors
/// [`StoreError`] where the tables cannot be read.
pub async fn spooled(
    connection: &mut SqliteConnection,
    after: i64,
    limit: u32,
) -> Result<Vec<SpooledMessage>, StoreError> {
    let rows = sqlx::query(
        "SELECT * FROM (SELECT id, state, 'report ' || writer_id || '/' || epoch || '/' || sequence AS about, bytes, \
         created_at, sent_at, attempts, body FROM report WHERE state IN ('WAITING', 'SENT', 'PARKED') AND id > ?1 \
         UNION ALL SELECT id, state, subject, length(CAST(body AS BLOB)), created_at, NULL, attempts, body \
         FROM control WHERE id > ?1) ORDER BY id LIMIT ?2",
    )
    .bind(after)
    .bind(i64::from(limit))
    .fetch_all(connection)
    .await
    .map_err(StoreError::while_doing("read the spool"))?;
    rows.iter()
        .map(|row| {
            let body: Option<String> = get(row, 7)?;
            Ok(SpooledMessage {
                id: get(row, 0)?,
                state: get(row, 1)?,
                about: get(row, 2)?,
                bytes: get(row, 3)?,
                created_at: DateTime::from_unix_micros(get(row, 4)?),
                sent_at: get::<Option<i64>>(row, 5)?.map(DateTime::from_unix_micros),
                attempts: get(row, 6)?,
                body: body.and_then(|body| serde_json::from_str(&body).ok()).unwrap_or_default(),
            })
        })
        .collect()
}
