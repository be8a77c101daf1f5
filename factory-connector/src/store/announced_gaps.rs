//! Gaps that were announced and that no receipt covered so far.

use asi_model::DateTime;
use messaging::spool::SequenceGap;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    AnnouncedGapRow, GapWrites,
    error::StoreError,
    names::Named as _,
    query::{all, query},
    row::{Columns as _, document},
    statement::write_rows,
};

const READ: &str = "read the announced gaps";

/// Repository of announced gaps.
pub struct AnnouncedGaps<'c>(pub(super) &'c mut SqliteConnection);

impl AnnouncedGaps<'_> {
    /// Reads those of a writer's epoch.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_writer(
        &mut self,
        writer: u16,
        epoch: u32,
    ) -> Result<Vec<AnnouncedGapRow>, StoreError> {
        let sql = "SELECT * FROM announced_gap WHERE writer_id = ? AND epoch = ?";
        let query = query(sql).bind(i64::from(writer)).bind(i64::from(epoch));
        all(self.0, query, READ, gap).await
    }

    /// Reads the oldest that were announced before a time, at most so many. One that was announced after
    /// `now` was so before the clock was set back, and is among them.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn oldest(
        &mut self,
        before: DateTime,
        now: DateTime,
        limit: u32,
    ) -> Result<Vec<AnnouncedGapRow>, StoreError> {
        let sql = "SELECT * FROM announced_gap WHERE announced_at < ? OR announced_at > ?
                   ORDER BY announced_at LIMIT ?";
        let query =
            query(sql).bind(before.unix_micros()).bind(now.unix_micros()).bind(i64::from(limit));
        all(self.0, query, READ, gap).await
    }
}

fn gap(row: &SqliteRow) -> Result<AnnouncedGapRow, StoreError> {
    Ok(AnnouncedGapRow {
        gap: SequenceGap {
            data_set_writer_id: row.number("writer_id")?,
            epoch: row.number("epoch")?,
            first_sequence: row.number("first_sequence")?,
            last_sequence: row.number("last_sequence")?,
        },
        cause: row.named("cause")?,
        announced_at: row.time("announced_at")?,
    })
}

/// Removes what receipts cover and stores what was announced.
pub(super) fn write(connection: &Connection, writes: &GapWrites) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "DELETE FROM announced_gap
         WHERE writer_id = ? AND epoch = ? AND last_sequence <= ? AND NOT EXISTS (
             SELECT 1 FROM json_each(?) WHERE value BETWEEN first_sequence AND last_sequence)",
        &writes.receipts,
        |receipt| {
            (
                receipt.data_set_writer_id,
                receipt.epoch,
                receipt.through_sequence,
                document(&receipt.missing_list),
            )
        },
    )?;
    write_rows(
        connection,
        "INSERT INTO announced_gap (writer_id, epoch, first_sequence, last_sequence, cause,
             announced_at)
         VALUES (?, ?, ?, ?, ?, ?)
         ON CONFLICT DO UPDATE SET cause = excluded.cause, announced_at = excluded.announced_at",
        &writes.announced,
        |row| {
            (
                row.gap.data_set_writer_id,
                row.gap.epoch,
                row.gap.first_sequence,
                row.gap.last_sequence,
                row.cause.name(),
                row.announced_at.unix_micros(),
            )
        },
    )
}
