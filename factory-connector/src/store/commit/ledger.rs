//! The ledger: entries, the signed ends of its chains, receipts of revocations, checkpoints.

use crate::store::{Changes, rows::Batch};

pub(super) fn write(batch: &mut Batch, changes: &Changes) {
    batch.insert(
        "INSERT INTO ledger_entry (recipient, number, recorded_at, report_id, content, hash)",
        "",
        &changes.ledger,
        |values, (entry, report_id)| {
            values.push_bind(entry.recipient.to_string());
            values.push_bind(i64::try_from(entry.number).unwrap_or(i64::MAX));
            values.push_bind(entry.recorded_at.unix_micros());
            values.push_bind(*report_id);
            values.push_bind(entry.content.clone());
            values.push_bind(entry.hash.to_vec());
        },
    );
    batch.insert(
        "INSERT INTO carried_field (operation_network_id, operation_id, dynamic_data_request_id, field_name, writer_id, \
         epoch, first_sequence)",
        // After a restart a field is noted again.
        " ON CONFLICT DO NOTHING",
        &changes.carried_fields,
        |values, row| {
            let request = &row.field.request;
            values.push_bind(request.operation_network_id.to_string());
            values.push_bind(request.operation_id.to_string());
            values.push_bind(request.dynamic_data_request_id.to_string());
            values.push_bind(row.field.field_name.to_string());
            values.push_bind(i64::from(row.data_set_writer_id));
            values.push_bind(i64::from(row.epoch));
            values.push_bind(i64::from(row.first_sequence));
        },
    );
    batch.insert(
        "INSERT INTO ledger_head (recipient, number, hash, signature, public_key)",
        " ON CONFLICT (recipient) DO UPDATE SET number = excluded.number, hash = excluded.hash, \
         signature = excluded.signature, public_key = excluded.public_key",
        &changes.heads,
        |values, head| {
            values.push_bind(head.recipient.to_string());
            values.push_bind(i64::try_from(head.number).unwrap_or(i64::MAX));
            values.push_bind(head.hash.to_vec());
            values.push_bind(head.signature.to_vec());
            values.push_bind(head.public_key.to_vec());
        },
    );
    batch.insert(
        "INSERT INTO revocation (revocation_id, revoked_at, content, signature, public_key)",
        "",
        &changes.revocations,
        |values, row| {
            values.push_bind(row.revocation_id.clone());
            values.push_bind(row.revoked_at.unix_micros());
            values.push_bind(row.content.clone());
            values.push_bind(row.signature.to_vec());
            values.push_bind(row.public_key.to_vec());
        },
    );
    if let Some(checkpoint) = &changes.checkpoint {
        batch.run(
            "INSERT INTO ledger_checkpoint (number, recorded_at, content, signature, public_key) VALUES (?, ?, ?, ?, ?)",
        )
        .bind(i64::try_from(checkpoint.number).unwrap_or(i64::MAX))
        .bind(checkpoint.recorded_at.unix_micros())
        .bind(checkpoint.content.clone())
        .bind(checkpoint.signature.to_vec())
        .bind(checkpoint.public_key.to_vec());
    }
}
