//! Requested fields: the decision about each, and the state of its gate and transform.

use std::collections::BTreeMap;

use asi_model::DateTime;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    FieldRow, FieldValueRow,
    error::StoreError,
    names::Named as _,
    query::{all, query},
    row::Columns as _,
    statement::{write_ids, write_rows},
};

/// Repository of fields.
pub struct Fields<'c>(pub(super) &'c mut SqliteConnection);

impl Fields<'_> {
    /// Reads all fields, each with its values once it had any.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<Vec<(FieldRow, Option<FieldValueRow>)>, StoreError> {
        let sql = "SELECT f.*, v.gate, v.transform
                   FROM field f LEFT JOIN field_value v ON v.field_id = f.id";
        all(self.0, query(sql), "read the fields", |row| Ok((field(row)?, values(row)?))).await
    }
}

fn field(row: &SqliteRow) -> Result<FieldRow, StoreError> {
    Ok(FieldRow {
        id: row.column("id")?,
        key: row.field_key()?,
        mapping_state: row.named("mapping_state")?,
        value_source: row.named_option("value_source")?,
        reason: row.column("reason")?,
        decided_by: row.column("decided_by")?,
        decided_at: row.time_option("decided_at")?,
        mapping: row.column("mapping")?,
        policy: row.column("policy")?,
        basis: row.column("grounds")?,
        consent_version: row.number("consent_version")?,
    })
}

fn values(row: &SqliteRow) -> Result<Option<FieldValueRow>, StoreError> {
    let Some(gate) = row.column("gate")? else { return Ok(None) };
    Ok(Some(FieldValueRow { gate, transform: row.column("transform")? }))
}

/// Removes fields with all that refers to them, and stores new and changed ones.
pub(super) fn write(
    connection: &Connection,
    fields: &BTreeMap<i64, FieldRow>,
    removed: &[i64],
) -> rusqlite::Result<()> {
    let remove = "DELETE FROM field WHERE id IN (SELECT value FROM json_each(?))";
    write_ids(connection, remove, removed)?;
    write_rows(
        connection,
        "INSERT INTO field (id, operation_network_id, operation_id, dynamic_data_request_id,
             field_name, mapping_state, value_source, reason, decided_by, decided_at, mapping,
             policy, grounds, consent_version)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)
         ON CONFLICT (id) DO UPDATE SET
             mapping_state = excluded.mapping_state, value_source = excluded.value_source,
             reason = excluded.reason, decided_by = excluded.decided_by,
             decided_at = excluded.decided_at, mapping = excluded.mapping, policy = excluded.policy,
             grounds = excluded.grounds, consent_version = excluded.consent_version",
        fields.values(),
        |row| {
            let request = &row.key.request;
            (
                row.id,
                request.operation_network_id.as_str(),
                request.operation_id.as_str(),
                request.dynamic_data_request_id.as_str(),
                row.key.field_name.as_str(),
                row.mapping_state.name(),
                row.value_source.map(|source| source.name()),
                &row.reason,
                &row.decided_by,
                row.decided_at.map(DateTime::unix_micros),
                &row.mapping,
                &row.policy,
                &row.basis,
                row.consent_version,
            )
        },
    )
}

/// Stores the states of gates and transforms, by the ids of their fields.
pub(super) fn write_values(
    connection: &Connection,
    values: &BTreeMap<i64, FieldValueRow>,
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO field_value (field_id, gate, transform) VALUES (?, ?, ?)
         ON CONFLICT (field_id) DO UPDATE SET
             gate = excluded.gate, transform = excluded.transform",
        values,
        |(id, row)| (id, &row.gate, &row.transform),
    )
}
