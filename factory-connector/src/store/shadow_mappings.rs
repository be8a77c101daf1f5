//! Shadow mappings, at most one per field.

use std::collections::HashMap;

use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    ShadowRow,
    error::StoreError,
    query::{all, query},
    row::Columns as _,
    statement::run,
};

/// Repository of shadow mappings.
pub struct ShadowMappings<'c>(pub(super) &'c mut SqliteConnection);

impl ShadowMappings<'_> {
    /// Reads all shadows by the ids of their fields.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<HashMap<i64, ShadowRow>, StoreError> {
        let query = query("SELECT * FROM mapping_shadow");
        Ok(all(self.0, query, "read the shadow mappings", shadow).await?.into_iter().collect())
    }
}

fn shadow(row: &SqliteRow) -> Result<(i64, ShadowRow), StoreError> {
    let shadow = ShadowRow {
        mapping: row.column("mapping")?,
        author: row.column("author")?,
        started_at: row.time("started_at")?,
    };
    Ok((row.column("field_id")?, shadow))
}

/// Stores shadows by the ids of their fields; `None` removes one.
pub(super) fn write(
    connection: &Connection,
    shadows: &[(i64, Option<ShadowRow>)],
) -> rusqlite::Result<()> {
    // In the order of their changes: a field's shadow may end and another one start.
    for (field_id, shadow) in shadows {
        let Some(shadow) = shadow else {
            run(connection, "DELETE FROM mapping_shadow WHERE field_id = ?", (field_id,))?;
            continue;
        };
        run(
            connection,
            "INSERT INTO mapping_shadow (field_id, mapping, author, started_at) VALUES (?, ?, ?, ?)
             ON CONFLICT (field_id) DO UPDATE SET
                 mapping = excluded.mapping, author = excluded.author,
                 started_at = excluded.started_at",
            (field_id, &shadow.mapping, &shadow.author, shadow.started_at.unix_micros()),
        )?;
    }
    Ok(())
}
