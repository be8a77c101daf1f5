//! What was decided about fields, and their values.

use super::{mapping_state_name, value_source_name};
use crate::store::{
    Changes,
    rows::{Batch, id_list},
};

pub(super) fn write(batch: &mut Batch, changes: &Changes) {
    if !changes.removed_fields.is_empty() {
        batch
            .run("DELETE FROM field WHERE id IN (SELECT value FROM json_each(?))")
            .bind(id_list(&changes.removed_fields));
    }
    let fields: Vec<_> = changes.fields.values().collect();
    batch.insert(
        "INSERT INTO field (id, operation_network_id, operation_id, dynamic_data_request_id, field_name, \
         mapping_state, value_source, reason, decided_by, decided_at, mapping, policy, grounds, consent_version)",
        " ON CONFLICT (id) DO UPDATE SET mapping_state = excluded.mapping_state, \
         value_source = excluded.value_source, reason = excluded.reason, decided_by = excluded.decided_by, \
         decided_at = excluded.decided_at, mapping = excluded.mapping, policy = excluded.policy, grounds = excluded.grounds, \
         consent_version = excluded.consent_version",
        &fields,
        |values, row| {
            let request = &row.key.request;
            values.push_bind(row.id);
            values.push_bind(request.operation_network_id.to_string());
            values.push_bind(request.operation_id.to_string());
            values.push_bind(request.dynamic_data_request_id.to_string());
            values.push_bind(row.key.field_name.to_string());
            values.push_bind(mapping_state_name(row.mapping_state));
            values.push_bind(row.value_source.map(value_source_name));
            values.push_bind(row.reason.clone());
            values.push_bind(row.decided_by.clone());
            values.push_bind(row.decided_at.map(|at| at.unix_micros()));
            values.push_bind(row.mapping.clone());
            values.push_bind(row.policy.clone());
            values.push_bind(row.grounds.clone());
            values.push_bind(i64::from(row.consent_version));
        },
    );
    let field_values: Vec<_> = changes.field_values.iter().collect();
    batch.insert(
        "INSERT INTO field_value (field_id, gate, transform)",
        " ON CONFLICT (field_id) DO UPDATE SET gate = excluded.gate, transform = excluded.transform",
        &field_values,
        |values, (id, row)| {
            values.push_bind(**id);
            values.push_bind(row.gate.clone());
            values.push_bind(row.transform.clone());
        },
    );
    batch.insert(
        "INSERT INTO consent (field, version, mapping_state, value_source, policy, grounds, reason, decided_by, \
         decided_at)",
        "",
        &changes.consents,
        |values, row| {
            values.push_bind(row.field.clone());
            values.push_bind(i64::from(row.version));
            values.push_bind(mapping_state_name(row.mapping_state));
            values.push_bind(row.value_source.map(value_source_name));
            values.push_bind(row.policy.clone());
            values.push_bind(row.grounds.clone());
            values.push_bind(row.reason.clone());
            values.push_bind(row.decided_by.clone());
            values.push_bind(row.decided_at.unix_micros());
        },
    );
}
