//! The spool: writers, reports and what became of them, control messages.

use asi_model::{DateTime, MessageId};
use rusqlite::Connection;

use crate::store::{
    Changes, ReportMove,
    writer::{id_list, run, write_rows},
};

pub(super) fn write_reports(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO writer (id, operation_network_id, operation_id, dynamic_data_request_id, epoch, minor_version, \
         next_sequence, field_list, retired_at) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) \
         ON CONFLICT (id) DO UPDATE SET operation_network_id = excluded.operation_network_id, \
         operation_id = excluded.operation_id, dynamic_data_request_id = excluded.dynamic_data_request_id, \
         epoch = excluded.epoch, minor_version = excluded.minor_version, next_sequence = excluded.next_sequence, \
         field_list = excluded.field_list, retired_at = excluded.retired_at",
        &changes.writers,
        |(id, row)| {
            (
                id,
                row.request.operation_network_id.as_str(),
                row.request.operation_id.as_str(),
                row.request.dynamic_data_request_id.as_str(),
                row.epoch,
                row.minor_version,
                row.next_sequence,
                serde_json::to_string(&row.fields).expect("names serialise"),
                row.retired_at.map(|at| at.unix_micros()),
            )
        },
    )?;
    write_rows(
        connection,
        "INSERT INTO report (id, message, writer_id, epoch, sequence, state, created_at, recipients, bytes, body, salt) \
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        &changes.reports,
        |row| {
            (
                row.id,
                row.message,
                row.data_set_writer_id,
                row.epoch,
                row.sequence,
                if row.is_purged { "DONE" } else { "WAITING" },
                row.created_at.unix_micros(),
                serde_json::to_string(&row.recipients).expect("names serialise"),
                i64::try_from(row.body.len()).unwrap_or(i64::MAX),
                &row.body,
                &row.salt,
            )
        },
    )?;
    changes.report_moves.iter().try_for_each(|change| move_reports(connection, change))
}

fn move_reports(connection: &Connection, change: &ReportMove) -> rusqlite::Result<()> {
    let (statement, ids) = match change {
        ReportMove::Sent { reports, at } => return sent(connection, reports, *at),
        ReportMove::Receipted { reports, at } => {
            let statement = "UPDATE report SET state = 'DONE', receipted_at = ? WHERE id IN (SELECT value FROM json_each(?))";
            return run(connection, statement, (at.unix_micros(), id_list(reports))).map(drop);
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
        ReportMove::Done(ids) => {
            ("UPDATE report SET state = 'DONE' WHERE id IN (SELECT value FROM json_each(?))", ids)
        }
        ReportMove::Revoked(ids) => {
            ("UPDATE report SET is_revoked = 1 WHERE id IN (SELECT value FROM json_each(?))", ids)
        }
    };
    run(connection, statement, (id_list(ids),)).map(drop)
}

/// What was taken back while it was leaving has left all the same: its receipt is waited for, and
/// it is not sent again.
fn sent(
    connection: &Connection,
    reports: &[(i64, Option<MessageId>)],
    at: DateTime,
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "UPDATE report SET is_revoked = iif(state = 'DONE', 1, is_revoked), state = 'SENT', sent_at = ?, \
         sent_count = sent_count + 1, message_id = coalesce(?, message_id) \
         WHERE id = ? AND (state = 'WAITING' OR (state = 'DONE' AND sent_at IS NULL))",
        reports,
        |(id, message)| (at.unix_micros(), message.as_ref().map(MessageId::as_str), id),
    )
}

pub(super) fn write_controls(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO control (id, message_id, subject, correlation_id, body, created_at, ttl_ms) \
         VALUES (?, ?, ?, ?, ?, ?, ?)",
        &changes.controls,
        |row| {
            (
                row.id,
                row.message_id.as_str(),
                &row.subject,
                row.correlation_id.as_ref().map(MessageId::as_str),
                &row.body,
                row.created_at.unix_micros(),
                row.ttl_ms.map(|ms| i64::try_from(ms).unwrap_or(i64::MAX)),
            )
        },
    )?;
    for (statement, ids) in [
        (
            "DELETE FROM control WHERE id IN (SELECT value FROM json_each(?))",
            &changes.controls_done,
        ),
        (
            "UPDATE control SET state = 'PARKED' WHERE id IN (SELECT value FROM json_each(?))",
            &changes.controls_parked,
        ),
        (
            "UPDATE control SET attempts = attempts + 1 WHERE id IN (SELECT value FROM json_each(?))",
            &changes.controls_attempted,
        ),
    ] {
        if !ids.is_empty() {
            run(connection, statement, (id_list(ids),))?;
        }
    }
    Ok(())
}
