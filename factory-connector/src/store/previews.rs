//! Previews that decisions were made on, each with the salt of the hash that the ledger has of it.

use std::collections::HashSet;

use ledger::preview_hash;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    PreviewRow,
    error::StoreError,
    query::{all, query},
    row::Columns as _,
    statement::write_rows,
};

/// Returns the hashes of the previews whose texts have them.
pub(super) async fn intact(
    connection: &mut SqliteConnection,
) -> Result<HashSet<String>, StoreError> {
    let sql = "SELECT CAST(hash AS BLOB) AS hash, CAST(text AS BLOB) AS text, salt FROM preview";
    let read = |row: &SqliteRow| {
        let text: Vec<u8> = row.column("text")?;
        let (stored, salt): (Vec<u8>, Vec<u8>) = (row.column("hash")?, row.column("salt")?);
        let hash = std::str::from_utf8(&text).ok().map(|text| preview_hash(text, &salt));
        Ok(hash.filter(|hash| hash.as_bytes() == stored))
    };
    let found = all(connection, query(sql), "read the previews", read).await?;
    Ok(found.into_iter().flatten().collect())
}

/// Stores the previews of new decisions.
pub(super) fn write(connection: &Connection, previews: &[PreviewRow]) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO preview (hash, text, salt) VALUES (?, ?, ?)",
        previews,
        |row| (&row.hash, &row.text, &row.salt),
    )
}
