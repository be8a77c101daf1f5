//! The ledger: entries, the signed ends of its chains, receipts of revocations, checkpoints.

use rusqlite::Connection;

use crate::store::{
    Changes,
    writer::{run, write_rows},
};

pub(super) fn write(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO ledger_entry (recipient, number, recorded_at, report_id, content, hash) \
         VALUES (?, ?, ?, ?, ?, ?)",
        &changes.ledger,
        |(entry, report_id)| {
            let number = i64::try_from(entry.number).unwrap_or(i64::MAX);
            let recorded_at = entry.recorded_at.unix_micros();
            (entry.recipient.as_str(), number, recorded_at, report_id, &entry.content, &entry.hash)
        },
    )?;
    write_rows(
        connection,
        // After a restart a field is noted again.
        "INSERT INTO carried_field (operation_network_id, operation_id, dynamic_data_request_id, field_name, writer_id, \
         epoch, first_sequence) VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
        &changes.carried_fields,
        |row| {
            let request = &row.field.request;
            (
                request.operation_network_id.as_str(),
                request.operation_id.as_str(),
                request.dynamic_data_request_id.as_str(),
                row.field.field_name.as_str(),
                row.data_set_writer_id,
                row.epoch,
                row.first_sequence,
            )
        },
    )?;
    write_rows(
        connection,
        "INSERT INTO ledger_head (recipient, number, hash, signature, public_key) VALUES (?, ?, ?, ?, ?) \
         ON CONFLICT (recipient) DO UPDATE SET number = excluded.number, hash = excluded.hash, \
         signature = excluded.signature, public_key = excluded.public_key",
        &changes.heads,
        |head| {
            let number = i64::try_from(head.number).unwrap_or(i64::MAX);
            (head.recipient.as_str(), number, &head.hash, &head.signature, &head.public_key)
        },
    )?;
    write_rows(
        connection,
        "INSERT INTO revocation (revocation_id, revoked_at, content, signature, public_key) VALUES (?, ?, ?, ?, ?)",
        &changes.revocations,
        |row| {
            (
                &row.revocation_id,
                row.revoked_at.unix_micros(),
                &row.content,
                &row.signature,
                &row.public_key,
            )
        },
    )?;
    if let Some(made) = &changes.checkpoint {
        let number = i64::try_from(made.number).unwrap_or(i64::MAX);
        run(
            connection,
            "INSERT INTO ledger_checkpoint (number, recorded_at, content, signature, public_key) \
             VALUES (?, ?, ?, ?, ?)",
            (
                number,
                made.recorded_at.unix_micros(),
                &made.content,
                &made.signature,
                &made.public_key,
            ),
        )?;
    }
    Ok(())
}
