//! Gaps: sequence numbers that a factory announced will never come.

use asi_model::{DateTime, messages::Gap};
use sqlx::QueryBuilder;

use super::{
    super::{
        database::Database,
        error::StoreError,
        row::{Columns, document, signed},
    },
    GAPS_PER_WRITER_MAX, Writers,
};

/// Rows of one statement.
const ROWS_PER_STATEMENT: usize = 200;

impl Writers<'_> {
    /// Stores the absent ranges of an announced gap. Returns false where the writer has so many that older
    /// ones were merged into a coarse one.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add_gaps(
        &mut self,
        gap: &Gap,
        absent: &[(u32, u32)],
        now: DateTime,
    ) -> Result<bool, StoreError> {
        let cause = document(&gap.cause);
        for ranges in absent.chunks(ROWS_PER_STATEMENT) {
            let mut query = QueryBuilder::<Database>::new(
                "INSERT INTO sequence_gap (factory_id, data_set_writer_id, epoch, first_sequence, last_sequence,
                     cause, received_at) ",
            );
            query.push_values(ranges, |mut row, (first, last)| {
                row.push_bind(gap.factory_id.as_str())
                    .push_bind(i64::from(gap.data_set_writer_id))
                    .push_bind(i64::from(gap.epoch))
                    .push_bind(i64::from(*first))
                    .push_bind(i64::from(*last))
                    .push_bind(&cause)
                    .push_bind(now.ticks());
            });
            query.build().execute(&mut *self.0).await.map_err(StoreError::during("store gaps"))?;
        }
        let sql = "SELECT COUNT(*) AS number FROM sequence_gap
                   WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3";
        let row = sqlx::query(sql)
            .bind(gap.factory_id.as_str())
            .bind(i64::from(gap.data_set_writer_id))
            .bind(i64::from(gap.epoch))
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("count gaps"))?;
        let number: u64 = row.unsigned("number")?;
        let is_within = number <= GAPS_PER_WRITER_MAX;
        if !is_within {
            self.merge_gaps(gap, number - GAPS_PER_WRITER_MAX / 2).await?;
        }
        Ok(is_within)
    }

    /// Merges so many of a writer's oldest gaps into one, from the first to the last of their numbers.
    async fn merge_gaps(&mut self, gap: &Gap, count: u64) -> Result<(), StoreError> {
        let oldest = "SELECT sequence_gap_id, first_sequence, last_sequence FROM sequence_gap
             WHERE factory_id = $1 AND data_set_writer_id = $2 AND epoch = $3
             ORDER BY sequence_gap_id LIMIT $4";
        let rows = sqlx::query(oldest)
            .bind(gap.factory_id.as_str())
            .bind(i64::from(gap.data_set_writer_id))
            .bind(i64::from(gap.epoch))
            .bind(signed(count))
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
