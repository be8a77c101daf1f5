//! Receipts: the writers that are due for one, in turns of their factories.

use asi_model::DateTime;

use super::{super::error::StoreError, WriterKey, WriterRow, Writers, read};
use crate::store::row::Columns as _;

impl Writers<'_> {
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
}
