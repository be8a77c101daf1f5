//! Data set writers: which of their reports are held, and which are missing.

mod gaps;
mod seen;

use asi_model::{DateTime, FactoryId, messages::GapCause};

pub use seen::{SeenWriter, WritersWanted};

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow, document, signed},
};
use crate::sequences::SequenceSet;

/// One writer within one epoch.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct WriterKey {
    /// Factory of the writer.
    pub factory_id: FactoryId,
    pub data_set_writer_id: u16,
    pub epoch: u32,
}

/// Received sequence numbers of a writer within an epoch, with counters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WriterRow {
    pub key: WriterKey,
    pub sequences: SequenceSet,
    /// Number of reports received, repeats not counted.
    pub received: u64,
    /// Number of repeats discarded.
    pub duplicates: u64,
    /// The network it reports about.
    pub operation_network_id: Option<String>,
    /// The request it answers.
    pub dynamic_data_request_id: Option<String>,
    /// Arrival of the last report.
    pub last_report_at: Option<DateTime>,
    /// Arrival of the last keep-alive.
    pub last_keep_alive_at: Option<DateTime>,
    /// True if the connector has not been sent a receipt for the last change.
    pub needs_receipt: bool,
}

impl WriterRow {
    /// Makes a writer of which no report is stored.
    #[must_use]
    pub const fn new(key: WriterKey) -> Self {
        Self {
            key,
            sequences: SequenceSet::new(),
            received: 0,
            duplicates: 0,
            operation_network_id: None,
            dynamic_data_request_id: None,
            last_report_at: None,
            last_keep_alive_at: None,
            needs_receipt: false,
        }
    }

    /// Takes the number of a report that arrived, and returns false for a repeat. Either is
    /// receipted.
    pub fn take(&mut self, sequence: u32) -> bool {
        self.needs_receipt = true;
        let is_new = self.sequences.add(sequence);
        if is_new {
            self.received += 1;
        } else {
            self.duplicates += 1;
        }
        is_new
    }

    /// Takes the number of a report that is stored, though it counted as missing. Returns false, as for
    /// any repeat.
    pub fn repeat(&mut self, sequence: u32) -> bool {
        self.needs_receipt = true;
        self.sequences.add(sequence);
        self.duplicates += 1;
        false
    }
}

/// Sequence numbers that a factory announced will never come.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredGap {
    pub first_sequence: u32,
    pub last_sequence: u32,
    pub cause: GapCause,
    /// True where several gaps were merged into this one, so that some of its numbers may be held.
    pub is_coarse: bool,
}

/// Most announced gaps of a writer within an epoch. Beyond, the older half becomes one coarse gap.
pub const GAPS_PER_WRITER_MAX: u64 = 1_000;

/// Repository of data set writers.
pub struct Writers<'w>(pub(super) &'w mut Connection);

impl Writers<'_> {
    /// Looks one up; none when it does not exist.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(&mut self, key: &WriterKey) -> Result<Option<WriterRow>, StoreError> {
        let sql = "SELECT * FROM data_set_writer
                   WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3";
        let row = sqlx::query(sql)
            .bind(key.factory_id.as_str())
            .bind(i64::from(key.data_set_writer_id))
            .bind(i64::from(key.epoch))
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a writer up"))?;
        row.as_ref().map(read).transpose()
    }

    /// Stores one.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn put(&mut self, row: &WriterRow) -> Result<(), StoreError> {
        let sql = "INSERT INTO data_set_writer (factory_id, data_set_writer_id, epoch, through_sequence, missing,
                       received, duplicates, operation_network_id, dynamic_data_request_id, last_report_at,
                       last_keep_alive_at, needs_receipt, coarse_through)
                   VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13)
                   ON CONFLICT (factory_id, data_set_writer_id, epoch) DO UPDATE SET
                       through_sequence = excluded.through_sequence, missing = excluded.missing,
                       received = excluded.received, duplicates = excluded.duplicates,
                       operation_network_id = excluded.operation_network_id,
                       dynamic_data_request_id = excluded.dynamic_data_request_id,
                       last_report_at = excluded.last_report_at, last_keep_alive_at = excluded.last_keep_alive_at,
                       needs_receipt = excluded.needs_receipt, coarse_through = excluded.coarse_through";
        sqlx::query(sql)
            .bind(row.key.factory_id.as_str())
            .bind(i64::from(row.key.data_set_writer_id))
            .bind(i64::from(row.key.epoch))
            .bind(row.sequences.through().map(i64::from))
            .bind(document(row.sequences.missing()))
            .bind(signed(row.received))
            .bind(signed(row.duplicates))
            .bind(row.operation_network_id.as_deref())
            .bind(row.dynamic_data_request_id.as_deref())
            .bind(row.last_report_at.map(DateTime::ticks))
            .bind(row.last_keep_alive_at.map(DateTime::ticks))
            .bind(i64::from(row.needs_receipt))
            .bind(row.sequences.coarse_through().map(i64::from))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a writer"))?;
        Ok(())
    }

    /// Returns true where a writer has changes that were not receipted.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn is_receipt_due(&mut self) -> Result<bool, StoreError> {
        let sql = "SELECT EXISTS (SELECT 1 FROM data_set_writer WHERE needs_receipt = 1) AS is_due";
        let row = sqlx::query(sql)
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("find a writer that needs a receipt"))?;
        Ok(row.unsigned::<u8>("is_due")? != 0)
    }

    /// Lists writers with changes that were not receipted: of each factory the one whose last receipt is
    /// the oldest, then the next of each, so that many of one factory push none of another away.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn unreceipted(&mut self, limit: u32) -> Result<Vec<WriterRow>, StoreError> {
        // The keys first: the documents of those that wait are not read.
        let sql = "SELECT w.* FROM (
                       SELECT factory_id, data_set_writer_id, epoch, ROW_NUMBER() OVER (
                           PARTITION BY factory_id ORDER BY receipted_at, data_set_writer_id, epoch) AS place
                       FROM data_set_writer WHERE needs_receipt = 1
                       ORDER BY place, factory_id LIMIT $1) due
                   JOIN data_set_writer w ON w.factory_id = due.factory_id
                       AND w.data_set_writer_id = due.data_set_writer_id AND w.epoch = due.epoch
                   ORDER BY due.place, due.factory_id";
        let rows = sqlx::query(sql)
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list writers that need receipts"))?;
        rows.iter().map(read).collect()
    }

    /// Notes that a receipt was sent about everything stored of this writer.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn receipted(&mut self, key: &WriterKey, now: DateTime) -> Result<(), StoreError> {
        let sql = "UPDATE data_set_writer SET needs_receipt = 0, receipted_at = $4
                   WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3";
        sqlx::query(sql)
            .bind(key.factory_id.as_str())
            .bind(i64::from(key.data_set_writer_id))
            .bind(i64::from(key.epoch))
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note a receipt"))?;
        Ok(())
    }

    /// Counts the writers of a factory over all epochs.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn count(&mut self, factory: &FactoryId) -> Result<u64, StoreError> {
        let row =
            sqlx::query("SELECT COUNT(*) AS number FROM data_set_writer WHERE factory_id = $1")
                .bind(factory.as_str())
                .fetch_one(&mut *self.0)
                .await
                .map_err(StoreError::during("count the writers of a factory"))?;
        row.unsigned("number")
    }
}

fn read_key(row: &DatabaseRow) -> Result<WriterKey, StoreError> {
    Ok(WriterKey {
        factory_id: row.parsed("factory_id")?,
        data_set_writer_id: row.unsigned("data_set_writer_id")?,
        epoch: row.unsigned("epoch")?,
    })
}

fn read(row: &DatabaseRow) -> Result<WriterRow, StoreError> {
    let number = |name| {
        let stored: Option<i64> = row.column(name)?;
        stored.map(|_| row.unsigned(name)).transpose()
    };
    let (through, coarse) = (number("through_sequence")?, number("coarse_through")?);
    Ok(WriterRow {
        key: read_key(row)?,
        sequences: SequenceSet::from_stored(through, row.json("missing")?, coarse),
        received: row.unsigned("received")?,
        duplicates: row.unsigned("duplicates")?,
        operation_network_id: row.column("operation_network_id")?,
        dynamic_data_request_id: row.column("dynamic_data_request_id")?,
        last_report_at: row.time_option("last_report_at")?,
        last_keep_alive_at: row.time_option("last_keep_alive_at")?,
        needs_receipt: row.unsigned::<u8>("needs_receipt")? != 0,
    })
}
