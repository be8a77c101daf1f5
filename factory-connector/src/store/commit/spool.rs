//! The spool: writers, reports and what became of them, control messages.

use crate::store::{
    Changes, ReportMove,
    rows::{Batch, id_list},
};
use asi_model::{DateTime, MessageId};

pub(super) fn write_reports(batch: &mut Batch, changes: &Changes) {
    let writers: Vec<_> = changes.writers.iter().collect();
    batch.insert(
        "INSERT INTO writer (id, operation_network_id, operation_id, dynamic_data_request_id, epoch, minor_version, \
         next_sequence, field_list, retired_at)",
        " ON CONFLICT (id) DO UPDATE SET operation_network_id = excluded.operation_network_id, \
         operation_id = excluded.operation_id, dynamic_data_request_id = excluded.dynamic_data_request_id, \
         epoch = excluded.epoch, minor_version = excluded.minor_version, next_sequence = excluded.next_sequence, \
         field_list = excluded.field_list, retired_at = excluded.retired_at",
        &writers,
        |values, (id, row)| {
            values.push_bind(i64::from(**id));
            values.push_bind(row.request.operation_network_id.to_string());
            values.push_bind(row.request.operation_id.to_string());
            values.push_bind(row.request.dynamic_data_request_id.to_string());
            values.push_bind(i64::from(row.epoch));
            values.push_bind(i64::from(row.minor_version));
            values.push_bind(i64::from(row.next_sequence));
            values.push_bind(serde_json::to_string(&row.fields).expect("names serialise"));
            values.push_bind(row.retired_at.map(|at| at.unix_micros()));
        },
    );
    batch.insert(
        "INSERT INTO report (id, message, writer_id, epoch, sequence, state, created_at, recipients, bytes, body, salt)",
        "",
        &changes.reports,
        |values, row| {
            values.push_bind(row.id);
            values.push_bind(row.message);
            values.push_bind(i64::from(row.data_set_writer_id));
            values.push_bind(i64::from(row.epoch));
            values.push_bind(i64::from(row.sequence));
            values.push_bind(if row.is_purged { "DONE" } else { "WAITING" });
            values.push_bind(row.created_at.unix_micros());
            values.push_bind(serde_json::to_string(&row.recipients).expect("names serialise"));
            values.push_bind(i64::try_from(row.body.len()).unwrap_or(i64::MAX));
            values.push_bind(row.body.clone());
            values.push_bind(row.salt.to_vec());
        },
    );
    for change in &changes.report_moves {
        move_reports(batch, change);
    }
}

fn move_reports(batch: &mut Batch, change: &ReportMove) {
    let (statement, ids) = match change {
        ReportMove::Sent { reports, at } => return sent(batch, reports, *at),
        ReportMove::Receipted { reports, .. } => {
            ("UPDATE report SET state = 'DONE', receipted_at = ? WHERE id IN (SELECT value FROM json_each(?))", reports)
        }
        ReportMove::Waiting(ids) => (
            "UPDATE report SET state = 'WAITING' WHERE state IN ('SENT', 'PARKED') \
             AND id IN (SELECT value FROM json_each(?))",
            ids,
        ),
        ReportMove::Attempted(ids) => (
            "UPDATE report SET attempts = attempts + 1 WHERE state = 'WAITING' \
             AND message IN (SELECT value FROM json_each(?))",
            ids,
        ),
        ReportMove::Parked(ids) => (
            "UPDATE report SET state = 'PARKED' WHERE state = 'WAITING' \
             AND message IN (SELECT value FROM json_each(?))",
            ids,
        ),
        ReportMove::Done(ids) => ("UPDATE report SET state = 'DONE' WHERE id IN (SELECT value FROM json_each(?))", ids),
        ReportMove::Revoked(ids) => {
            ("UPDATE report SET is_revoked = 1 WHERE id IN (SELECT value FROM json_each(?))", ids)
        }
    };
    let values = batch.run(statement);
    match change {
        ReportMove::Receipted { at, .. } => values.bind(at.unix_micros()).bind(id_list(ids)),
        _ => values.bind(id_list(ids)),
    };
}

/// What was taken back while it was leaving has left all the same: its receipt is waited for, and it is not sent again.
fn sent(batch: &mut Batch, reports: &[(i64, Option<MessageId>)], at: DateTime) {
    let reports: Vec<_> = reports.iter().map(|(id, message)| (id, message.as_ref().map(ToString::to_string))).collect();
    batch
        .run(
            "UPDATE report SET is_revoked = iif(state = 'DONE', 1, is_revoked), state = 'SENT', sent_at = ?, \
         sent_count = sent_count + 1, message_id = coalesce(left.message_id, report.message_id) \
         FROM (SELECT json_extract(value, '$[0]') AS id, json_extract(value, '$[1]') AS message_id \
         FROM json_each(?)) AS left \
         WHERE report.id = left.id AND (state = 'WAITING' OR (state = 'DONE' AND sent_at IS NULL))",
        )
        .bind(at.unix_micros())
        .bind(serde_json::to_string(&reports).expect("numbers and texts serialise"));
}

pub(super) fn write_controls(batch: &mut Batch, changes: &Changes) {
    batch.insert(
        "INSERT INTO control (id, message_id, subject, correlation_id, body, created_at, ttl_ms)",
        "",
        &changes.controls,
        |values, row| {
            values.push_bind(row.id);
            values.push_bind(row.message_id.to_string());
            values.push_bind(row.subject.clone());
            values.push_bind(row.correlation_id.as_ref().map(ToString::to_string));
            values.push_bind(row.body.clone());
            values.push_bind(row.created_at.unix_micros());
            values.push_bind(row.ttl_ms.map(|ms| i64::try_from(ms).unwrap_or(i64::MAX)));
        },
    );
    for (statement, ids) in [
        ("DELETE FROM control WHERE id IN (SELECT value FROM json_each(?))", &changes.controls_done),
        ("UPDATE control SET state = 'PARKED' WHERE id IN (SELECT value FROM json_each(?))", &changes.controls_parked),
        (
            "UPDATE control SET attempts = attempts + 1 WHERE id IN (SELECT value FROM json_each(?))",
            &changes.controls_attempted,
        ),
    ] {
        if ids.is_empty() {
            continue;
        }
        batch.run(statement).bind(id_list(ids));
    }
}
