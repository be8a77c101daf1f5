//! Outgoing messages: written in the transaction of their cause, deleted when the broker has
//! accepted them.

use asi_model::{DateTime, MessageId};
use bytes::Bytes;
use messaging::{
    Backlog, ContentEncoding, Envelope, Fetch, Lane, LogicalAddress, RowId, RowOutcome,
    SendOutcome, SpoolRow,
};

use super::{
    database::Connection,
    error::StoreError,
    holder::Holder,
    removals::Removals,
    revoked_access::RevokedAccess,
    row::{Columns, DatabaseRow},
};

/// Most answers that wait for a factory or tool: one that never reads them gets no more.
pub const ANSWERS_WAITING_MAX: u64 = 10_000;

/// A message to send.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewOutgoing {
    pub address: LogicalAddress,
    /// Its id, the same as in the body.
    pub message_id: MessageId,
    pub subject: String,
    /// Message that it answers.
    pub correlation_id: Option<MessageId>,
    pub created_at: DateTime,
    /// Time from creation after which a broker may drop it.
    pub time_to_live: Option<std::time::Duration>,
    /// Content encoding of the body.
    pub content_encoding: Option<ContentEncoding>,
    pub body: Bytes,
}

/// Repository of outgoing messages.
pub struct OutgoingMessages<'w>(pub(super) &'w mut Connection);

impl OutgoingMessages<'_> {
    /// Stores a message to send; nothing for who has left.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add(&mut self, message: &NewOutgoing) -> Result<(), StoreError> {
        if let Some(reader) = Holder::of(&message.address)
            && Removals(&mut *self.0).has_left(&reader).await?
        {
            return Ok(());
        }
        let sql = "INSERT INTO outbox (address, message_id, subject, correlation_id, created_at, time_to_live_ms,
                       content_encoding, body, attempts) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, 0)";
        sqlx::query(sql)
            .bind(message.address.to_string())
            .bind(message.message_id.as_str())
            .bind(&message.subject)
            .bind(message.correlation_id.as_ref().map(MessageId::as_str))
            .bind(message.created_at.ticks())
            .bind(message.time_to_live.and_then(|ttl| i64::try_from(ttl.as_millis()).ok()))
            .bind(message.content_encoding.map(ContentEncoding::as_str))
            .bind(&message.body[..])
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store an outgoing message"))?;
        RevokedAccess(&mut *self.0).hold_new(&message.address, message.message_id.as_str()).await
    }

    /// Returns true while fewer answers wait for an address than may.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn takes_answers(&mut self, address: &LogicalAddress) -> Result<bool, StoreError> {
        let sql = "SELECT COUNT(*) AS waiting FROM outbox WHERE address = $1 AND correlation_id IS NOT NULL";
        let row = sqlx::query(sql)
            .bind(address.to_string())
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("count answers"))?;
        Ok(row.unsigned::<u64>("waiting")? < ANSWERS_WAITING_MAX)
    }

    /// Counts the messages that wait for an address.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn waiting(&mut self, address: &LogicalAddress) -> Result<u64, StoreError> {
        let row = sqlx::query("SELECT COUNT(*) AS waiting FROM outbox WHERE address = $1")
            .bind(address.to_string())
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("count outgoing messages"))?;
        row.unsigned("waiting")
    }

    /// Reads waiting messages for the link. None of the platform's is a report, so all travel in
    /// their order on the control lane.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn fetch(&mut self, fetch: Fetch) -> Result<Vec<SpoolRow>, StoreError> {
        if fetch.lane != Lane::Control {
            return Ok(Vec::new());
        }
        let sql =
            "SELECT * FROM outbox WHERE outbox_id > $1 AND outbox_id <= $2 AND parked_code IS NULL
                   ORDER BY outbox_id LIMIT $3";
        let rows = sqlx::query(sql)
            .bind(fetch.after.0)
            .bind(fetch.through.map_or(i64::MAX, |row| row.0))
            .bind(i64::try_from(fetch.limit).unwrap_or(i64::MAX))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("fetch outgoing messages"))?;
        rows.iter().map(read).collect()
    }

    /// Records the outcomes of sent messages.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn record(&mut self, outcomes: &[RowOutcome]) -> Result<(), StoreError> {
        for outcome in outcomes {
            let query = match &outcome.outcome {
                SendOutcome::Accepted | SendOutcome::Expired => {
                    sqlx::query("DELETE FROM outbox WHERE outbox_id = $1").bind(outcome.id.0)
                }
                SendOutcome::Rejected(_) => {
                    sqlx::query("UPDATE outbox SET attempts = attempts + 1 WHERE outbox_id = $1")
                        .bind(outcome.id.0)
                }
                SendOutcome::Parked(rejection) => sqlx::query(
                    "UPDATE outbox SET parked_code = $2, parked_reason = $3 WHERE outbox_id = $1",
                )
                .bind(outcome.id.0)
                .bind(rejection.code.clone())
                .bind(rejection.reason.clone()),
            };
            query
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("record what became of a message"))?;
        }
        Ok(())
    }

    /// Returns the greatest row id so far; 0 when there is none.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn last_row(&mut self) -> Result<RowId, StoreError> {
        let last: Option<i64> = sqlx::query_scalar("SELECT MAX(outbox_id) FROM outbox")
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("find the newest outgoing message"))?;
        Ok(RowId(last.unwrap_or(0)))
    }

    /// Measures the waiting messages.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn backlog(&mut self) -> Result<Backlog, StoreError> {
        let sql = "SELECT COUNT(*) AS waiting, COALESCE(SUM(LENGTH(body)), 0) AS bytes, MIN(created_at) AS oldest
                   FROM outbox WHERE parked_code IS NULL";
        let row = sqlx::query(sql)
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("measure the outgoing messages"))?;
        Ok(Backlog {
            waiting: row.unsigned("waiting")?,
            sent: 0,
            bytes: row.unsigned("bytes")?,
            oldest_at: row.time_option("oldest")?.map(Into::into),
        })
    }
}

fn read(row: &DatabaseRow) -> Result<SpoolRow, StoreError> {
    let ttl: Option<i64> = row.column("time_to_live_ms")?;
    let encoding: Option<String> = row.column("content_encoding")?;
    let body: Vec<u8> = row.column("body")?;
    let mut envelope =
        Envelope::new(row.parsed("message_id")?, row.column::<String>("subject")?, body);
    envelope.content_encoding =
        encoding.filter(|name| name == "gzip").map(|_| ContentEncoding::Gzip);
    envelope.correlation_id = row.parsed_option("correlation_id")?;
    envelope.creation_time = Some(row.time("created_at")?.into());
    envelope.ttl = ttl.and_then(|ms| u64::try_from(ms).ok()).map(std::time::Duration::from_millis);
    Ok(SpoolRow {
        id: RowId(row.column("outbox_id")?),
        address: row.parsed("address")?,
        envelope,
        attempts: row.unsigned("attempts")?,
    })
}
