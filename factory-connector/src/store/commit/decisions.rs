//! What was decided about fields, and their values.

use rusqlite::Connection;

use super::{mapping_state_name, value_source_name};
use crate::store::{
    Changes,
    writer::{id_list, run, write_rows},
};

pub(super) fn write(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    if !changes.removed_fields.is_empty() {
        let statement = "DELETE FROM field WHERE id IN (SELECT value FROM json_each(?))";
        run(connection, statement, (id_list(&changes.removed_fields),))?;
    }
    write_rows(
        connection,
        "INSERT INTO field (id, operation_network_id, operation_id, dynamic_data_request_id, field_name, \
         mapping_state, value_source, reason, decided_by, decided_at, mapping, policy, grounds, consent_version) \
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) \
         ON CONFLICT (id) DO UPDATE SET mapping_state = excluded.mapping_state, \
         value_source = excluded.value_source, reason = excluded.reason, decided_by = excluded.decided_by, \
         decided_at = excluded.decided_at, mapping = excluded.mapping, policy = excluded.policy, grounds = excluded.grounds, \
         consent_version = excluded.consent_version",
        changes.fields.values(),
        |row| {
            let request = &row.key.request;
            (
                row.id,
                request.operation_network_id.as_str(),
                request.operation_id.as_str(),
                request.dynamic_data_request_id.as_str(),
                row.key.field_name.as_str(),
                mapping_state_name(row.mapping_state),
                row.value_source.map(value_source_name),
                &row.reason,
                &row.decided_by,
                row.decided_at.map(|at| at.unix_micros()),
                &row.mapping,
                &row.policy,
                &row.grounds,
                row.consent_version,
            )
        },
    )?;
    write_rows(
        connection,
        "INSERT INTO field_value (field_id, gate, transform) VALUES (?, ?, ?) \
         ON CONFLICT (field_id) DO UPDATE SET gate = excluded.gate, transform = excluded.transform",
        &changes.field_values,
        |(id, row)| (id, &row.gate, &row.transform),
    )?;
    write_rows(
        connection,
        "INSERT INTO consent (field, version, mapping_state, value_source, policy, grounds, reason, decided_by, \
         decided_at) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
        &changes.consents,
        |row| {
            (
                &row.field,
                row.version,
                mapping_state_name(row.mapping_state),
                row.value_source.map(value_source_name),
                &row.policy,
                &row.grounds,
                &row.reason,
                &row.decided_by,
                row.decided_at.unix_micros(),
            )
        },
    )
}
