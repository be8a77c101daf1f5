//! Reports: the spool of what is on its way, and the values that the ledger's entries commit to.
//!
//! Reading goes through [`Reports`]. Writing is in `reports/delivery.rs` (new reports and changes
//! of their state) and `reports/retention.rs`.

mod delivery;
mod retention;
mod state;

use std::collections::HashSet;

use asi_model::DateTime;
use connector_state::use_cases::retain::OldReport;
pub(super) use delivery::{apply_moves, write};
use messaging::{
    RowId,
    spool::{Fetch, ReportRow},
};
pub(super) use retention::{emptied, empty_values, oldest_in_spool, remove_unreferenced};
use sqlx::{SqliteConnection, sqlite::SqliteRow};
use state::ReportState;
use time::OffsetDateTime;

use super::{
    WaitingRow,
    error::StoreError,
    query::{all, one, query},
    row::{Columns as _, document},
};

/// Columns of [`WaitingRow`].
const COLUMNS: &str = "id, message, writer_id, epoch, sequence, state, created_at, sent_at, \
                       sent_count, is_revoked, recipients, bytes";
/// Reports that the spool works with. The text is the condition of partial indexes.
const IN_SPOOL: &str = "state IN ('WAITING', 'SENT')";
/// Numbers of the waiting messages between two numbers.
const WAITING_MESSAGES: &str = "SELECT DISTINCT message FROM report
    WHERE state = 'WAITING' AND message > ?1 AND message <= ?2 ORDER BY message LIMIT ?3";
/// Numbers of those that have the newest waiting report of a writer. A message with a report whose
/// writer has sent newer ones already is left to the replay lane: in the live lane it would arrive
/// behind them.
const NEWEST_MESSAGES: &str = "SELECT DISTINCT r.message FROM report r
    JOIN (SELECT writer_id, max(id) AS id FROM report
          WHERE state = 'WAITING' AND message > ?1 AND message <= ?2
          GROUP BY writer_id) n ON n.id = r.id
    WHERE NOT EXISTS (
        SELECT 1 FROM report s
        JOIN report l ON l.writer_id = s.writer_id AND (l.epoch, l.sequence) > (s.epoch, s.sequence)
        WHERE s.state = 'WAITING' AND s.message = r.message AND l.state <> 'WAITING')
    ORDER BY r.message LIMIT ?3";
const READ: &str = "read the spool";

/// Reports that wait in one message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReportMessage {
    /// Number of the message: that of its last report.
    pub id: i64,
    /// Number of each report with its DataSetMessage as JSON.
    pub reports: Vec<(i64, String)>,
    /// Random bytes of the reports, one after the other; they never leave.
    pub salts: Vec<u8>,
    /// Time of the first report.
    pub created_at: DateTime,
    /// Number of rejections by the broker.
    pub attempts: u32,
}

/// Last sequence numbers of a writer's epoch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LastSequences {
    /// Last one that was sent; none before the first.
    pub sent: Option<u32>,
    /// Last one that the platform has receipted; none before the first.
    pub receipted: Option<u32>,
}

/// Number, size and age of reports in the spool.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct ReportBacklog {
    pub waiting: u64,
    pub sent: u64,
    pub bytes: u64,
    pub oldest_at: Option<DateTime>,
}

/// Repository of reports.
pub struct Reports<'c>(pub(super) &'c mut SqliteConnection);

impl Reports<'_> {
    /// Reads the spooled reports of a writer, in any epoch or in one.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_writer(
        &mut self,
        writer: u16,
        epoch: Option<u32>,
    ) -> Result<Vec<WaitingRow>, StoreError> {
        let sql = format!(
            "SELECT {COLUMNS} FROM report
             WHERE {IN_SPOOL} AND writer_id = ?1 AND (?2 IS NULL OR epoch = ?2) ORDER BY id"
        );
        let query = query(sql).bind(i64::from(writer)).bind(epoch.map(i64::from));
        all(self.0, query, READ, waiting).await
    }

    /// Reads those of a writer's reports with these sequence numbers that can be sent again although
    /// the spool is done with them: receipted, not revoked, and not emptied by retention. Reports in
    /// the spool are among them, because the transaction being made may have receipted them.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn receipted(
        &mut self,
        writer: u16,
        epoch: u32,
        sequences: &[u32],
    ) -> Result<Vec<WaitingRow>, StoreError> {
        let sql = format!(
            "SELECT {COLUMNS} FROM report
             WHERE writer_id = ?1 AND epoch = ?2 AND (receipted_at IS NOT NULL OR {IN_SPOOL})
                 AND is_revoked = 0 AND body IS NOT NULL
                 AND sequence IN (SELECT value FROM json_each(?3)) ORDER BY id"
        );
        let query =
            query(sql).bind(i64::from(writer)).bind(i64::from(epoch)).bind(document(sequences));
        all(self.0, query, READ, waiting).await
    }

    /// Reads finished reports with values that were made before `before`, after the report with the
    /// number `after`; a bounded number at a time.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn old(
        &mut self,
        before: DateTime,
        after: i64,
    ) -> Result<Vec<OldReport>, StoreError> {
        retention::old_reports(self.0, before, after).await
    }

    /// Reads the oldest spooled reports, at most so many.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn oldest(&mut self, limit: u32) -> Result<Vec<WaitingRow>, StoreError> {
        let sql =
            format!("SELECT {COLUMNS} FROM report WHERE {IN_SPOOL} ORDER BY created_at LIMIT ?");
        all(self.0, query(sql).bind(i64::from(limit)), READ, waiting).await
    }

    /// Returns the size of all spooled reports, in bytes.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn spooled_bytes(&mut self) -> Result<u64, StoreError> {
        let sql = format!("SELECT coalesce(sum(bytes), 0) AS bytes FROM report WHERE {IN_SPOOL}");
        one(self.0, query(sql), "measure the spool", |row| row.number("bytes")).await
    }

    /// Returns the newest spooled report of each writer.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn newest_of_writers(&mut self) -> Result<HashSet<RowId>, StoreError> {
        let sql = format!("SELECT max(id) AS id FROM report WHERE {IN_SPOOL} GROUP BY writer_id");
        let found = all(self.0, query(sql), READ, |row| Ok(RowId(row.column("id")?)));
        Ok(found.await?.into_iter().collect())
    }

    /// Reads the reports of these messages that were not known to have left: those that wait, and
    /// those that were taken back meanwhile.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn unsent_in(&mut self, messages: &[i64]) -> Result<Vec<WaitingRow>, StoreError> {
        let sql = format!(
            "SELECT {COLUMNS} FROM report
             WHERE (state = 'WAITING' OR (state = 'DONE' AND sent_at IS NULL))
                 AND message IN (SELECT value FROM json_each(?))
             ORDER BY id"
        );
        // One parameter for all numbers, so that the statement is the same for any of them.
        all(self.0, query(sql).bind(document(messages)), READ, waiting).await
    }

    /// Reads the last sequence numbers of a writer's epoch.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn last_sequences(
        &mut self,
        writer: u16,
        epoch: u32,
    ) -> Result<LastSequences, StoreError> {
        let sql = "SELECT
                       (SELECT sequence FROM report
                        WHERE writer_id = ?1 AND epoch = ?2 AND sent_at IS NOT NULL
                        ORDER BY sequence DESC LIMIT 1) AS sent,
                       (SELECT sequence FROM report
                        WHERE writer_id = ?1 AND epoch = ?2 AND receipted_at IS NOT NULL
                        ORDER BY sequence DESC LIMIT 1) AS receipted";
        let query = query(sql).bind(i64::from(writer)).bind(i64::from(epoch));
        one(self.0, query, READ, |row| {
            Ok(LastSequences {
                sent: row.number_option("sent")?,
                receipted: row.number_option("receipted")?,
            })
        })
        .await
    }

    /// Reads waiting messages, oldest first.
    pub(super) async fn waiting(&mut self, fetch: Fetch) -> Result<Vec<ReportMessage>, StoreError> {
        self.messages(WAITING_MESSAGES, fetch).await
    }

    /// Reads the waiting messages that have the newest report of a writer, oldest first.
    pub(super) async fn newest(&mut self, fetch: Fetch) -> Result<Vec<ReportMessage>, StoreError> {
        self.messages(NEWEST_MESSAGES, fetch).await
    }

    async fn messages(
        &mut self,
        messages: &'static str,
        fetch: Fetch,
    ) -> Result<Vec<ReportMessage>, StoreError> {
        let sql = format!(
            "SELECT message, id, body, salt, created_at, attempts FROM report
             WHERE state = 'WAITING' AND message IN ({messages}) ORDER BY message, id"
        );
        let query = query(sql)
            .bind(fetch.after.0)
            .bind(fetch.through.map_or(i64::MAX, |id| id.0))
            .bind(i64::try_from(fetch.limit).unwrap_or(i64::MAX));
        let reports = all(self.0, query, READ, |row| {
            Ok(ReportMessage {
                id: row.column("message")?,
                reports: vec![(row.column("id")?, row.column("body")?)],
                salts: row.column::<Option<Vec<u8>>>("salt")?.unwrap_or_default(),
                created_at: row.time("created_at")?,
                attempts: row.number("attempts")?,
            })
        });
        Ok(grouped(reports.await?))
    }

    /// Measures the reports in the spool.
    pub(super) async fn backlog(&mut self) -> Result<ReportBacklog, StoreError> {
        let sql = format!(
            "SELECT state, count(*) AS reports, coalesce(sum(bytes), 0) AS bytes,
                 min(created_at) AS oldest_at
             FROM report WHERE {IN_SPOOL} GROUP BY state"
        );
        let states = all(self.0, query(sql), "measure the spool", |row| {
            Ok((
                row.named::<ReportState>("state")?,
                row.number::<u64>("reports")?,
                row.number::<u64>("bytes")?,
                row.time_option("oldest_at")?,
            ))
        });
        let mut backlog = ReportBacklog::default();
        for (state, count, bytes, oldest_at) in states.await? {
            match state {
                ReportState::Sent => backlog.sent += count,
                _ => backlog.waiting += count,
            }
            backlog.bytes += bytes;
            backlog.oldest_at = [backlog.oldest_at, oldest_at].into_iter().flatten().min();
        }
        Ok(backlog)
    }
}

/// Joins neighbours that travel in the same message.
fn grouped(reports: Vec<ReportMessage>) -> Vec<ReportMessage> {
    let mut messages: Vec<ReportMessage> = Vec::new();
    for report in reports {
        match messages.last_mut() {
            Some(message) if message.id == report.id => {
                message.reports.extend(report.reports);
                message.salts.extend(report.salts);
            }
            _ => messages.push(report),
        }
    }
    messages
}

fn waiting(row: &SqliteRow) -> Result<WaitingRow, StoreError> {
    let state: ReportState = row.named("state")?;
    let sent_at = row.time_option("sent_at")?.map(OffsetDateTime::from);
    Ok(WaitingRow {
        row: ReportRow {
            id: RowId(row.column("id")?),
            data_set_writer_id: row.number("writer_id")?,
            epoch: row.number("epoch")?,
            sequence: row.number("sequence")?,
            bytes: row.number("bytes")?,
            created_at: row.time("created_at")?.into(),
            // A report that waits to be sent again keeps its time in the table only.
            sent_at: sent_at.filter(|_| state == ReportState::Sent),
            sent_count: row.number("sent_count")?,
        },
        recipients: row.document("recipients")?,
        is_revoked: row.flag("is_revoked")?,
        message: row.column("message")?,
        is_done: state == ReportState::Done,
    })
}
