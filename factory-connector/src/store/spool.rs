//! The spool: reports and control messages together, numbered in one order.

use asi_model::DateTime;
use messaging::{
    Backlog, RowId,
    spool::{Fetch, Lane},
};
use serde::Serialize;
use serde_json::Value;
use sqlx::{SqliteConnection, sqlite::SqliteRow};
use time::OffsetDateTime;

use super::{
    control_messages::{self, ControlMessage},
    error::StoreError,
    query::{all, one, query},
    reports::{ReportMessage, Reports},
    row::Columns as _,
};

/// A message that waits in the spool.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Message {
    Control(ControlMessage),
    /// Reports that travel together.
    Reports(ReportMessage),
}

/// A report or control message of the spool, for people to look at.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SpooledMessage {
    /// Number in the spool.
    pub id: i64,
    /// `WAITING`, `SENT` (without a receipt yet) or `PARKED` (set aside: the broker will never
    /// accept it).
    pub state: String,
    /// `report writer/epoch/sequence`, or the type of the control message.
    pub about: String,
    /// Size of the body, in bytes.
    pub bytes: i64,
    pub created_at: DateTime,
    /// Time of the broker's last acceptance.
    pub sent_at: Option<DateTime>,
    /// Number of rejections by the broker.
    pub attempts: i64,
    /// The body; null once retention has emptied it.
    pub body: Value,
}

/// Repository of the spool.
pub struct Spool<'c>(pub(super) &'c mut SqliteConnection);

impl Spool<'_> {
    /// Reads the waiting messages of a lane, oldest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn fetch(&mut self, fetch: Fetch) -> Result<Vec<Message>, StoreError> {
        let reports = match fetch.lane {
            Lane::Control => {
                let found = control_messages::waiting(self.0, fetch).await?;
                return Ok(found.into_iter().map(Message::Control).collect());
            }
            Lane::Newest => Reports(self.0).newest(fetch).await?,
            Lane::Reports => Reports(self.0).waiting(fetch).await?,
        };
        Ok(reports.into_iter().map(Message::Reports).collect())
    }

    /// Measures the spool.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn backlog(&mut self) -> Result<Backlog, StoreError> {
        let reports = Reports(self.0).backlog().await?;
        let control = control_messages::backlog(self.0).await?;
        let oldest_at = [reports.oldest_at, control.oldest_at].into_iter().flatten().min();
        Ok(Backlog {
            waiting: reports.waiting + control.waiting,
            sent: reports.sent,
            bytes: reports.bytes + control.bytes,
            oldest_at: oldest_at.map(OffsetDateTime::from),
        })
    }

    /// Returns the greatest number of a message; 0 for an empty spool.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn last_message(&mut self) -> Result<RowId, StoreError> {
        let sql = "SELECT max(coalesce((SELECT max(message) FROM report), 0),
                              coalesce((SELECT max(id) FROM control), 0)) AS id";
        one(self.0, query(sql), "read the spool", |row| Ok(RowId(row.column("id")?))).await
    }

    /// Returns the greatest number of a report or control message; 0 for an empty spool. Numbers of
    /// removed control messages may come again after a start, when none of them is on its way any
    /// more.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn last_id(&mut self) -> Result<i64, StoreError> {
        let sql = "SELECT max(coalesce((SELECT max(id) FROM report), 0),
                              coalesce((SELECT max(id) FROM control), 0)) AS id";
        one(self.0, query(sql), "read the spool", |row| row.column("id")).await
    }

    /// Reads everything in the spool after a number, in the order of the numbers.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(
        &mut self,
        after: i64,
        limit: u32,
    ) -> Result<Vec<SpooledMessage>, StoreError> {
        let sql = "SELECT * FROM (
                       SELECT id, state,
                           'report ' || writer_id || '/' || epoch || '/' || sequence AS about,
                           bytes, created_at, sent_at, attempts, body
                       FROM report WHERE state IN ('WAITING', 'SENT', 'PARKED') AND id > ?1
                       UNION ALL
                       SELECT id, state, subject,
                           length(CAST(body AS BLOB)), created_at, NULL, attempts, body
                       FROM control WHERE id > ?1)
                   ORDER BY id LIMIT ?2";
        let query = query(sql).bind(after).bind(i64::from(limit));
        all(self.0, query, "read the spool", spooled).await
    }
}

fn spooled(row: &SqliteRow) -> Result<SpooledMessage, StoreError> {
    let body: Option<String> = row.column("body")?;
    Ok(SpooledMessage {
        id: row.column("id")?,
        state: row.column("state")?,
        about: row.column("about")?,
        bytes: row.column("bytes")?,
        created_at: row.time("created_at")?,
        sent_at: row.time_option("sent_at")?,
        attempts: row.column("attempts")?,
        body: body.and_then(|body| serde_json::from_str(&body).ok()).unwrap_or_default(),
    })
}
