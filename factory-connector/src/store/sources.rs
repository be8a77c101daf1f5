//! Sources of values: OPC UA servers of the shop floor.

use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    SourceRow,
    error::StoreError,
    query::{all, query},
    row::Columns as _,
    statement::write_rows,
};

/// Repository of sources.
pub struct Sources<'c>(pub(super) &'c mut SqliteConnection);

impl Sources<'_> {
    /// Reads all sources by their ids.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<Vec<SourceRow>, StoreError> {
        let query = query("SELECT * FROM source ORDER BY source_id");
        all(self.0, query, "read the sources", source).await
    }
}

fn source(row: &SqliteRow) -> Result<SourceRow, StoreError> {
    Ok(SourceRow {
        source_id: row.column("source_id")?,
        config: row.column("config")?,
        sealed_password: row.column("sealed_password")?,
    })
}

/// Stores new and changed sources, then removes others by their ids.
pub(super) fn write(
    connection: &Connection,
    sources: &[SourceRow],
    removed: &[String],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO source (source_id, config, sealed_password) VALUES (?, ?, ?)
         ON CONFLICT (source_id) DO UPDATE SET
             config = excluded.config, password = NULL, sealed_password = excluded.sealed_password",
        sources,
        |row| (&row.source_id, &row.config, &row.sealed_password),
    )?;
    write_rows(connection, "DELETE FROM source WHERE source_id = ?", removed, |id| (id,))
}
