//! Data set writers: which of their reports are held, and which are missing.

mod seen;

use asi_model::{
    DateTime, FactoryId,
    messages::{Gap, GapCause},
};

pub use seen::SeenWriter;

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
}

/// Sequence numbers that a factory announced will never come.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredGap {
    pub first_sequence: u32,
    pub last_sequence: u32,
    pub cause: GapCause,
}

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
                       last_keep_alive_at, needs_receipt)
                   VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12)
                   ON CONFLICT (factory_id, data_set_writer_id, epoch) DO UPDATE SET
                       through_sequence = excluded.through_sequence, missing = excluded.missing,
                       received = excluded.received, duplicates = excluded.duplicates,
                       operation_network_id = excluded.operation_network_id,
                       dynamic_data_request_id = excluded.dynamic_data_request_id,
                       last_report_at = excluded.last_report_at, last_keep_alive_at = excluded.last_keep_alive_at,
                       needs_receipt = excluded.needs_receipt";
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
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a writer"))?;
        Ok(())
    }

    /// Lists writers with changes that were not receipted, by factory.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn unreceipted(&mut self, limit: u32) -> Result<Vec<WriterRow>, StoreError> {
        let sql = "SELECT * FROM data_set_writer WHERE needs_receipt = 1
                   ORDER BY factory_id, data_set_writer_id, epoch LIMIT $1";
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
    pub async fn receipted(&mut self, key: &WriterKey) -> Result<(), StoreError> {
        let sql = "UPDATE data_set_writer SET needs_receipt = 0
                   WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3";
        sqlx::query(sql)
            .bind(key.factory_id.as_str())
            .bind(i64::from(key.data_set_writer_id))
            .bind(i64::from(key.epoch))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note a receipt"))?;
        Ok(())
    }

    /// Stores an announced gap.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add_gap(&mut self, gap: &Gap, now: DateTime) -> Result<(), StoreError> {
        let sql = "INSERT INTO sequence_gap (factory_id, data_set_writer_id, epoch, first_sequence, last_sequence,
                       cause, received_at) VALUES ($1, $2, $3, $4, $5, $6, $7)";
        sqlx::query(sql)
            .bind(gap.factory_id.as_str())
            .bind(i64::from(gap.data_set_writer_id))
            .bind(i64::from(gap.epoch))
            .bind(i64::from(gap.first_sequence))
            .bind(i64::from(gap.last_sequence))
            .bind(document(&gap.cause))
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a gap"))?;
        Ok(())
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
    let through: Option<i64> = row.column("through_sequence")?;
    let through = through.map(|_| row.unsigned("through_sequence")).transpose()?;
    Ok(WriterRow {
        key: read_key(row)?,
        sequences: SequenceSet::from_stored(through, row.json("missing")?),
        received: row.unsigned("received")?,
        duplicates: row.unsigned("duplicates")?,
        operation_network_id: row.column("operation_network_id")?,
        dynamic_data_request_id: row.column("dynamic_data_request_id")?,
        last_report_at: row.time_option("last_report_at")?,
        last_keep_alive_at: row.time_option("last_keep_alive_at")?,
        needs_receipt: row.unsigned::<u8>("needs_receipt")? != 0,
    })
}
