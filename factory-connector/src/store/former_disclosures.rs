//! Former disclosures: what was disclosed of fields until their consents ended a short while ago.

use rusqlite::Connection;
use sqlx::SqliteConnection;

use super::{
    FormerDisclosureRow,
    error::StoreError,
    query::{all, query},
    row::Columns as _,
    statement::{write_ids, write_rows},
};

/// Repository of former disclosures.
pub struct FormerDisclosures<'c>(pub(super) &'c mut SqliteConnection);

impl FormerDisclosures<'_> {
    /// Reads all of them.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<Vec<FormerDisclosureRow>, StoreError> {
        let sql = "SELECT id, ended_at, document FROM former_disclosure";
        all(self.0, query(sql), "read the former disclosures", |row| {
            Ok(FormerDisclosureRow {
                id: row.column("id")?,
                ended_at: row.time("ended_at")?,
                document: row.column("document")?,
            })
        })
        .await
    }
}

/// Stores new ones and those that ended once more, and removes those that nothing depends on any
/// more.
pub(super) fn write(
    connection: &Connection,
    ended: &[FormerDisclosureRow],
    forgotten: &[i64],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO former_disclosure (id, ended_at, document) VALUES (?, ?, ?)
         ON CONFLICT (id) DO UPDATE SET ended_at = excluded.ended_at",
        ended,
        |row| (row.id, row.ended_at.unix_micros(), &row.document),
    )?;
    let sql = "DELETE FROM former_disclosure WHERE id IN (SELECT value FROM json_each(?))";
    write_ids(connection, sql, forgotten)
}
