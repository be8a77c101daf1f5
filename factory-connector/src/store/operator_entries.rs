//! Entries that operators made about operations.

use connector_state::operator::{EntryId, OperationKey, OperatorEntry};
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    NetworkRow,
    error::StoreError,
    query::{all, query},
    row::{Columns as _, document},
    statement::write_rows,
};

/// Repository of operators' entries.
pub struct OperatorEntries<'c>(pub(super) &'c mut SqliteConnection);

impl OperatorEntries<'_> {
    /// Reads all entries. Those about withdrawn networks were removed with their network.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<Vec<OperatorEntry>, StoreError> {
        let query = query("SELECT * FROM operator_entry");
        all(self.0, query, "read the operators' entries", entry).await
    }
}

fn entry(row: &SqliteRow) -> Result<OperatorEntry, StoreError> {
    Ok(OperatorEntry {
        operation: OperationKey {
            operation_network_id: row.parsed("operation_network_id")?,
            operation_id: row.parsed("operation_id")?,
        },
        entry_id: EntryId::try_from(row.column::<String>("entry_id")?)
            .map_err(StoreError::unreadable("entry_id"))?,
        made_at: row.time("made_at")?,
        received_at: row.time("received_at")?,
        made_by: row.column("made_by")?,
        action: row.document("action")?,
    })
}

/// Removes the entries about withdrawn networks, and stores new ones.
pub(super) fn write(
    connection: &Connection,
    entries: &[OperatorEntry],
    networks: &[NetworkRow],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "DELETE FROM operator_entry WHERE operation_network_id = ?",
        networks.iter().filter(|network| network.message.is_none()),
        |network| (network.operation_network_id.as_str(),),
    )?;
    write_rows(
        connection,
        "INSERT INTO operator_entry (operation_network_id, operation_id, entry_id, made_at,
             received_at, made_by, action)
         VALUES (?, ?, ?, ?, ?, ?, ?)",
        entries,
        |entry| {
            (
                entry.operation.operation_network_id.as_str(),
                entry.operation.operation_id.as_str(),
                entry.entry_id.as_str(),
                entry.made_at.unix_micros(),
                entry.received_at.unix_micros(),
                &entry.made_by,
                document(&entry.action),
            )
        },
    )
}
