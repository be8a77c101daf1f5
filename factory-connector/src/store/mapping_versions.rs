//! Published versions of mappings, numbered from 1 within each field.

use std::collections::HashMap;

use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    VersionRow,
    error::StoreError,
    query::{all, query},
    row::Columns as _,
    statement::write_rows,
};

/// Versions stored per field; beyond, the oldest are removed.
pub const VERSIONS_MAX: u32 = 100;

/// Repository of mapping versions.
pub struct StoredMappingVersions<'c>(pub(super) &'c mut SqliteConnection);

impl StoredMappingVersions<'_> {
    /// Reads the newest version of each field with its mapping as JSON. The mapping is `None` where
    /// it is that of the field's decision, which is in memory already.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn newest(&mut self) -> Result<HashMap<i64, (u32, Option<String>)>, StoreError> {
        let sql =
            "SELECT this.field_id, this.version, nullif(this.mapping, field.mapping) AS mapping
                   FROM mapping_version AS this LEFT JOIN field ON field.id = this.field_id
                   WHERE this.version = (SELECT max(version) FROM mapping_version AS other
                                         WHERE other.field_id = this.field_id)";
        let found = all(self.0, query(sql), "read the versions of mappings", |row| {
            Ok((row.column("field_id")?, (row.number("version")?, row.column("mapping")?)))
        });
        Ok(found.await?.into_iter().collect())
    }

    /// Reads the versions of a field's mapping, newest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_field(&mut self, field_id: i64) -> Result<Vec<VersionRow>, StoreError> {
        let sql = "SELECT * FROM mapping_version WHERE field_id = ? ORDER BY version DESC";
        let query = query(sql).bind(field_id);
        all(self.0, query, "read the versions of a mapping", version).await
    }
}

fn version(row: &SqliteRow) -> Result<VersionRow, StoreError> {
    Ok(VersionRow {
        field_id: row.column("field_id")?,
        version: row.number("version")?,
        mapping: row.column("mapping")?,
        author: row.column("author")?,
        note: row.column("note")?,
        published_at: row.time("published_at")?,
    })
}

/// Stores new versions and removes the oldest beyond the bound.
pub(super) fn write(connection: &Connection, versions: &[VersionRow]) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO mapping_version (field_id, version, mapping, author, note, published_at)
         VALUES (?, ?, ?, ?, ?, ?)",
        versions,
        |row| {
            (
                row.field_id,
                row.version,
                &row.mapping,
                &row.author,
                &row.note,
                row.published_at.unix_micros(),
            )
        },
    )?;
    write_rows(
        connection,
        "DELETE FROM mapping_version WHERE field_id = ? AND version <= ?",
        versions.iter().filter(|row| row.version > VERSIONS_MAX),
        |row| (row.field_id, row.version - VERSIONS_MAX),
    )
}
