//! What people entered at the operator's page.

use asi_model::DateTime;
use rusqlite::Connection;
use sqlx::sqlite::SqliteRow;

use super::{
    Changes, StoreError,
    load::{get, id},
    writer::write_rows,
};
use crate::operator::{EntryId, OperationKey, OperatorEntry};

/// Entries of networks that are still active; those of withdrawn ones go with their network.
pub(super) const LOAD: &str = "SELECT operation_network_id, operation_id, entry_id, made_at, received_at, made_by, action FROM operator_entry";

/// An entry from its row.
pub(super) fn entry(row: &SqliteRow) -> Result<OperatorEntry, StoreError> {
    let action: String = get(row, 6)?;
    Ok(OperatorEntry {
        operation: OperationKey { operation_network_id: id(row, 0)?, operation_id: id(row, 1)? },
        entry_id: EntryId::try_from(get::<String>(row, 2)?)
            .map_err(StoreError::unreadable("operator's entry"))?,
        made_at: DateTime::from_unix_micros(get(row, 3)?),
        received_at: DateTime::from_unix_micros(get(row, 4)?),
        made_by: get(row, 5)?,
        action: serde_json::from_str(&action)
            .map_err(StoreError::unreadable("operator's entry"))?,
    })
}

/// Writes new entries, and drops those of networks that are gone.
pub(super) fn write(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "DELETE FROM operator_entry WHERE operation_network_id = ?",
        changes.networks.iter().filter(|network| network.message.is_none()),
        |network| (network.operation_network_id.as_str(),),
    )?;
    write_rows(
        connection,
        "INSERT INTO operator_entry (operation_network_id, operation_id, entry_id, made_at, received_at, made_by, \
         action) VALUES (?, ?, ?, ?, ?, ?, ?)",
        &changes.operator_entries,
        |entry| {
            (
                entry.operation.operation_network_id.as_str(),
                entry.operation.operation_id.as_str(),
                entry.entry_id.as_str(),
                entry.made_at.unix_micros(),
                entry.received_at.unix_micros(),
                &entry.made_by,
                serde_json::to_string(&entry.action).expect("actions have text keys"),
            )
        },
    )
}
