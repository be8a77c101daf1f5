//! Reading the spool.

use asi_model::{DateTime, MessageId, OrganisationId};
use messaging::{
    Backlog, RowId,
    spool::{Fetch, Lane, ReportRow},
};
use sqlx::{Row as _, SqlitePool, sqlite::SqliteRow};
use time::OffsetDateTime;

use super::{
    Store, StoreError,
    load::{get, time, unsigned},
};

/// A message as it waits in the spool.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Message {
    /// A control message.
    Control {
        /// Its number.
        id: i64,
        /// Its id.
        message_id: MessageId,
        /// Its type.
        subject: String,
        /// What it answers.
        correlation_id: Option<MessageId>,
        /// The body.
        body: String,
        /// When it was made.
        created_at: DateTime,
        /// How long it is of use, in milliseconds.
        ttl_ms: Option<u64>,
        /// How often the broker rejected it.
        attempts: u32,
    },
    /// Reports that travel together.
    Reports {
        /// The message's number.
        id: i64,
        /// The single reports: number, and DataSetMessage as JSON.
        reports: Vec<(i64, String)>,
        /// When it was made.
        created_at: DateTime,
        /// How often the broker rejected it.
        attempts: u32,
    },
}

/// A report in the spool, without its body, with who may see it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WaitingRow {
    /// What the spool's decisions need.
    pub row: ReportRow,
    /// Who may see it.
    pub recipients: Vec<OrganisationId>,
    /// The consent ended after it was sent.
    pub is_revoked: bool,
    /// The number of the message it travels in.
    pub message: i64,
    /// It was taken back before it was known to have left.
    pub is_done: bool,
}

/// Reads the spool through connections of its own.
#[derive(Clone)]
pub struct SpoolReader(SqlitePool);

impl SpoolReader {
    /// Over the store's reading connections.
    #[must_use]
    pub const fn new(readers: SqlitePool) -> Self {
        Self(readers)
    }

    /// The waiting messages of a lane, oldest first.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn fetch(&self, fetch: Fetch) -> Result<Vec<Message>, StoreError> {
        match fetch.lane {
            Lane::Control => self.controls(fetch).await,
            Lane::Newest => {
                // Not with a report whose writer's newer ones have left already: these would be
                // overtaken in the live lane.
                let statement = "SELECT message, id, body, created_at, attempts FROM report WHERE state = 'WAITING' \
                     AND message IN (SELECT DISTINCT r.message FROM report r JOIN (SELECT writer_id, max(id) AS id \
                     FROM report WHERE state = 'WAITING' AND message > ?1 AND message <= ?2 GROUP BY writer_id) n \
                     ON n.id = r.id WHERE NOT EXISTS (SELECT 1 FROM report s JOIN report l ON l.writer_id = s.writer_id \
                     AND (l.epoch, l.sequence) > (s.epoch, s.sequence) WHERE s.state = 'WAITING' \
                     AND s.message = r.message AND l.state <> 'WAITING') ORDER BY r.message LIMIT ?3) ORDER BY message, id";
                self.reports(statement, fetch).await
            }
            Lane::Reports => {
                let statement = "SELECT message, id, body, created_at, attempts FROM report WHERE state = 'WAITING' \
                     AND message IN (SELECT DISTINCT message FROM report WHERE state = 'WAITING' AND message > ?1 \
                     AND message <= ?2 ORDER BY message LIMIT ?3) ORDER BY message, id";
                self.reports(statement, fetch).await
            }
        }
    }

    async fn controls(&self, fetch: Fetch) -> Result<Vec<Message>, StoreError> {
        let rows = sqlx::query(
            "SELECT id, message_id, subject, correlation_id, body, created_at, ttl_ms, attempts FROM control \
             WHERE state = 'WAITING' AND id > ? AND id <= ? ORDER BY id LIMIT ?",
        )
        .bind(fetch.after.0)
        .bind(fetch.through.map_or(i64::MAX, |id| id.0))
        .bind(i64::try_from(fetch.limit).unwrap_or(i64::MAX))
        .fetch_all(&self.0)
        .await
        .map_err(StoreError::while_doing("read the spool"))?;
        rows.iter().map(control).collect()
    }

    async fn reports(
        &self,
        statement: &'static str,
        fetch: Fetch,
    ) -> Result<Vec<Message>, StoreError> {
        let rows = sqlx::query(statement)
            .bind(fetch.after.0)
            .bind(fetch.through.map_or(i64::MAX, |id| id.0))
            .bind(i64::try_from(fetch.limit).unwrap_or(i64::MAX))
            .fetch_all(&self.0)
            .await
            .map_err(StoreError::while_doing("read the spool"))?;
        let mut messages: Vec<Message> = Vec::new();
        for row in &rows {
            let (message, report): (i64, (i64, String)) =
                (get(row, 0)?, (get(row, 1)?, get(row, 2)?));
            match messages.last_mut() {
                Some(Message::Reports { id, reports, .. }) if *id == message => {
                    reports.push(report)
                }
                _ => messages.push(Message::Reports {
                    id: message,
                    reports: vec![report],
                    created_at: DateTime::from_unix_micros(get(row, 3)?),
                    attempts: unsigned(get(row, 4)?),
                }),
            }
        }
        Ok(messages)
    }

    /// How much waits.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn backlog(&self) -> Result<Backlog, StoreError> {
        let rows = sqlx::query(
            "SELECT state, count(*), coalesce(sum(bytes), 0), min(created_at) FROM report \
             WHERE state IN ('WAITING', 'SENT') GROUP BY state \
             UNION ALL SELECT 'CONTROL', count(*), coalesce(sum(length(body)), 0), min(created_at) FROM control \
             WHERE state = 'WAITING'",
        )
        .fetch_all(&self.0)
        .await
        .map_err(StoreError::while_doing("measure the spool"))?;
        let mut backlog = Backlog::default();
        for row in &rows {
            let (state, count): (String, u64) = (get(row, 0)?, unsigned(get(row, 1)?));
            if state == "SENT" {
                backlog.sent += count
            } else {
                backlog.waiting += count
            }
            backlog.bytes += unsigned::<u64>(get(row, 2)?);
            let oldest: Option<OffsetDateTime> = time(get(row, 3)?).map(OffsetDateTime::from);
            backlog.oldest_at = [backlog.oldest_at, oldest].into_iter().flatten().min();
        }
        Ok(backlog)
    }

    /// The greatest number of a message so far.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn last_row(&self) -> Result<RowId, StoreError> {
        let row = sqlx::query(
            "SELECT max(coalesce((SELECT max(message) FROM report), 0), coalesce((SELECT max(id) FROM control), 0))",
        )
        .fetch_one(&self.0)
        .await
        .map_err(StoreError::while_doing("read the spool"))?;
        Ok(RowId(get(&row, 0)?))
    }
}

impl Store {
    /// What the spool holds of a writer, in any epoch or in one.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn kept_reports(
        &mut self,
        writer: u16,
        epoch: Option<u32>,
    ) -> Result<Vec<WaitingRow>, StoreError> {
        let rows = sqlx::query(
            "SELECT id, writer_id, epoch, sequence, bytes, created_at, sent_at, sent_count, state, recipients, \
             is_revoked, message FROM report WHERE state IN ('WAITING', 'SENT') AND writer_id = ?1 \
             AND (?2 IS NULL OR epoch = ?2) ORDER BY id",
        )
        .bind(i64::from(writer))
        .bind(epoch.map(i64::from))
        .fetch_all(&mut self.reader)
        .await
        .map_err(StoreError::while_doing("read the spool"))?;
        rows.iter().map(kept).collect()
    }

    /// Everything the spool holds, oldest first, at most so many.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn oldest_reports(&mut self, limit: u32) -> Result<Vec<WaitingRow>, StoreError> {
        let rows = sqlx::query(
            "SELECT id, writer_id, epoch, sequence, bytes, created_at, sent_at, sent_count, state, recipients, \
             is_revoked, message FROM report WHERE state IN ('WAITING', 'SENT') ORDER BY created_at LIMIT ?",
        )
        .bind(i64::from(limit))
        .fetch_all(&mut self.reader)
        .await
        .map_err(StoreError::while_doing("read the spool"))?;
        rows.iter().map(kept).collect()
    }

    /// Bytes of everything the spool holds.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn kept_bytes(&mut self) -> Result<u64, StoreError> {
        let row = sqlx::query(
            "SELECT coalesce(sum(bytes), 0) FROM report WHERE state IN ('WAITING', 'SENT')",
        )
        .fetch_one(&mut self.reader)
        .await
        .map_err(StoreError::while_doing("measure the spool"))?;
        Ok(unsigned(get(&row, 0)?))
    }

    /// The newest report of each writer.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn newest_reports(&mut self) -> Result<std::collections::HashSet<RowId>, StoreError> {
        let rows = sqlx::query(
            "SELECT max(id) FROM report WHERE state IN ('WAITING', 'SENT') GROUP BY writer_id",
        )
        .fetch_all(&mut self.reader)
        .await
        .map_err(StoreError::while_doing("read the spool"))?;
        rows.iter().map(|row| Ok(RowId(get(row, 0)?))).collect()
    }

    /// The reports that travel in these messages and were not known to have left: those that wait,
    /// and those that were taken back meanwhile.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn unsent_in(&mut self, messages: &[i64]) -> Result<Vec<WaitingRow>, StoreError> {
        let rows = sqlx::query(
            "SELECT id, writer_id, epoch, sequence, bytes, created_at, sent_at, sent_count, state, recipients, \
             is_revoked, message FROM report WHERE (state = 'WAITING' OR (state = 'DONE' AND sent_at IS NULL)) \
             AND message IN (SELECT value FROM json_each(?)) ORDER BY id",
        )
        .bind(super::writer::id_list(messages))
        .fetch_all(&mut self.reader)
        .await
        .map_err(StoreError::while_doing("read the spool"))?;
        rows.iter().map(kept).collect()
    }

    /// The last sequence numbers of a writer's epoch that were sent and receipted.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn last_sequences(
        &mut self,
        writer: u16,
        epoch: u32,
    ) -> Result<(Option<u32>, Option<u32>), StoreError> {
        let row = sqlx::query(
            "SELECT (SELECT sequence FROM report WHERE writer_id = ?1 AND epoch = ?2 AND sent_at IS NOT NULL \
             ORDER BY sequence DESC LIMIT 1), (SELECT sequence FROM report WHERE writer_id = ?1 AND epoch = ?2 \
             AND receipted_at IS NOT NULL ORDER BY sequence DESC LIMIT 1)",
        )
        .bind(i64::from(writer))
        .bind(i64::from(epoch))
        .fetch_one(&mut self.reader)
        .await
        .map_err(StoreError::while_doing("read the spool"))?;
        let number = |column| get::<Option<i64>>(&row, column).map(|number| number.map(unsigned));
        Ok((number(0)?, number(1)?))
    }

    /// Which of these messages' effects are stored.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be read.
    pub async fn seen(&mut self, message_ids: &[String]) -> Result<Vec<String>, StoreError> {
        let ids = serde_json::to_string(message_ids).expect("texts serialise");
        let rows = sqlx::query(
            "SELECT message_id FROM seen WHERE message_id IN (SELECT value FROM json_each(?))",
        )
        .bind(ids)
        .fetch_all(&mut self.reader)
        .await
        .map_err(StoreError::while_doing("look for repeats"))?;
        rows.iter().map(|row| get(row, 0)).collect()
    }
}

fn control(row: &SqliteRow) -> Result<Message, StoreError> {
    let message_id =
        |text: String| MessageId::new(text).map_err(StoreError::unreadable("message id"));
    let ttl: Option<i64> = get(row, 6)?;
    Ok(Message::Control {
        id: get(row, 0)?,
        message_id: message_id(get(row, 1)?)?,
        subject: get(row, 2)?,
        correlation_id: get::<Option<String>>(row, 3)?.map(message_id).transpose()?,
        body: get(row, 4)?,
        created_at: DateTime::from_unix_micros(get(row, 5)?),
        ttl_ms: ttl.map(unsigned),
        attempts: unsigned(get(row, 7)?),
    })
}

fn kept(row: &SqliteRow) -> Result<WaitingRow, StoreError> {
    let state: String = get(row, 8)?;
    let recipients: String = get(row, 9)?;
    let sent_at: Option<OffsetDateTime> = time(get(row, 6)?).map(OffsetDateTime::from);
    Ok(WaitingRow {
        row: ReportRow {
            id: RowId(get(row, 0)?),
            data_set_writer_id: unsigned(get(row, 1)?),
            epoch: unsigned(get(row, 2)?),
            sequence: unsigned(get(row, 3)?),
            bytes: unsigned(get(row, 4)?),
            created_at: DateTime::from_unix_micros(get(row, 5)?).into(),
            sent_at: sent_at.filter(|_| state == "SENT"),
            sent_count: unsigned(get(row, 7)?),
        },
        recipients: serde_json::from_str(&recipients)
            .map_err(StoreError::unreadable("recipients"))?,
        is_revoked: row.try_get::<i64, _>(10).map_err(StoreError::while_doing("read a column"))?
            != 0,
        message: get(row, 11)?,
        is_done: state == "DONE",
    })
}
