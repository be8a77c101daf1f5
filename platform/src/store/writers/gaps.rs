//! Gaps: sequence numbers that a factory announced will never come.

use asi_model::{DateTime, messages::Gap};

use super::{
    super::{
        error::StoreError,
        row::{Columns, document},
    },
    GAPS_PER_WRITER_MAX, Writers,
};

impl Writers<'_> {
    /// Stores an announced gap. Returns false where the writer has so many that older ones were merged
    /// into a coarse one.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add_gap(&mut self, gap: &Gap, now: DateTime) -> Result<bool, StoreError> {
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
        let sql = "SELECT COUNT(*) AS number FROM sequence_gap
                   WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3";
        let row = sqlx::query(sql)
            .bind(gap.factory_id.as_str())
            .bind(i64::from(gap.data_set_writer_id))
            .bind(i64::from(gap.epoch))
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("count gaps"))?;
        let is_within = row.unsigned::<u64>("number")? <= GAPS_PER_WRITER_MAX;
        if !is_within {
            self.merge_gaps(gap).await?;
        }
        Ok(is_within)
    }

    /// Merges the older half of a writer's gaps into one, from the first to the last of their numbers.
    async fn merge_gaps(&mut self, gap: &Gap) -> Result<(), StoreError> {
        let oldest = "SELECT sequence_gap_id, first_sequence, last_sequence FROM sequence_gap
             WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3
             ORDER BY sequence_gap_id LIMIT $4";
        let rows = sqlx::query(oldest)
            .bind(gap.factory_id.as_str())
            .bind(i64::from(gap.data_set_writer_id))
            .bind(i64::from(gap.epoch))
            .bind(i64::try_from(GAPS_PER_WRITER_MAX / 2).unwrap_or(i64::MAX))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list the oldest gaps"))?;
        let (mut newest_id, mut first, mut last) = (0, i64::MAX, 0);
        for row in &rows {
            newest_id = row.column("sequence_gap_id")?;
            first = first.min(row.column("first_sequence")?);
            last = last.max(row.column("last_sequence")?);
        }
        let sql = "DELETE FROM sequence_gap WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3
                       AND sequence_gap_id < $4";
        sqlx::query(sql)
            .bind(gap.factory_id.as_str())
            .bind(i64::from(gap.data_set_writer_id))
            .bind(i64::from(gap.epoch))
            .bind(newest_id)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("merge gaps"))?;
        let sql = "UPDATE sequence_gap SET first_sequence = $2, last_sequence = $3, is_coarse = 1
                   WHERE sequence_gap_id = $1";
        sqlx::query(sql)
            .bind(newest_id)
            .bind(first)
            .bind(last)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("merge gaps"))?;
        Ok(())
    }
}
