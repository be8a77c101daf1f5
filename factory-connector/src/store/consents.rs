//! Consents: every one ever given, for the ledger's entries to refer to.

use rusqlite::Connection;
use sqlx::SqliteConnection;

use super::{
    ConsentRow,
    error::StoreError,
    names::Named as _,
    query::{optional, query},
    row::{Columns as _, signed},
    statement::write_rows,
};

/// Reads the policy of a consent as JSON; `None` for an unknown consent.
pub(super) async fn policy(
    connection: &mut SqliteConnection,
    field: &str,
    version: u64,
) -> Result<Option<String>, StoreError> {
    let sql = "SELECT policy FROM consent WHERE field = ? AND version = ?";
    let query = query(sql).bind(field.to_owned()).bind(signed(version));
    optional(connection, query, "read a consent", |row| row.column("policy")).await
}

/// Reads the basis of a consent as JSON; `None` for an unknown consent, and where nobody but the
/// engineer decided.
pub(super) async fn basis(
    connection: &mut SqliteConnection,
    field: &str,
    version: u32,
) -> Result<Option<String>, StoreError> {
    let sql = "SELECT grounds FROM consent WHERE field = ? AND version = ?";
    let query = query(sql).bind(field.to_owned()).bind(version);
    let found = optional(connection, query, "read a consent", |row| row.column("grounds"));
    Ok(found.await?.flatten())
}

/// Stores new consents. There is no change of one: its number would mean two things.
pub(super) fn write(connection: &Connection, consents: &[ConsentRow]) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO consent (field, version, mapping_state, value_source, policy, grounds, reason,
             decided_by, decided_at)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
        consents,
        |row| {
            (
                &row.field,
                row.version,
                row.mapping_state.name(),
                row.value_source.map(|source| source.name()),
                &row.policy,
                &row.basis,
                &row.reason,
                &row.decided_by,
                row.decided_at.unix_micros(),
            )
        },
    )
}
