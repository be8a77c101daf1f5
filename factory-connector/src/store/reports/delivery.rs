//! New reports, and the changes of their state on the way to the platform.

use asi_model::{DateTime, MessageId};
use rusqlite::Connection;

use super::state::ReportState;
use crate::store::{
    NewReport, ReportMove,
    names::Named as _,
    row::document,
    statement::{id_list, run, write_ids, write_rows},
};

/// Stores new reports. One that was taken back before its transaction is stored as done: the ledger
/// has an entry about it.
pub(in crate::store) fn write(
    connection: &Connection,
    reports: &[NewReport],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO report (id, message, writer_id, epoch, sequence, state, created_at, recipients,
             bytes, body, salt)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        reports,
        |row| {
            (
                row.id,
                row.message,
                row.data_set_writer_id,
                row.epoch,
                row.sequence,
                ReportState::Waiting.name(),
                row.created_at.unix_micros(),
                document(&row.recipients),
                i64::try_from(row.body.len()).unwrap_or(i64::MAX),
                &*row.body,
                &row.salt,
            )
        },
    )
}

/// Changes the states of reports, in this order.
pub(in crate::store) fn apply_moves(
    connection: &Connection,
    moves: &[ReportMove],
) -> rusqlite::Result<()> {
    moves.iter().try_for_each(|change| apply(connection, change))
}

fn apply(connection: &Connection, change: &ReportMove) -> rusqlite::Result<()> {
    match change {
        ReportMove::Sent { reports, at } => sent(connection, reports, *at),
        ReportMove::Receipted { reports, at } => run(
            connection,
            "UPDATE report SET state = 'DONE', receipted_at = ?
             WHERE id IN (SELECT value FROM json_each(?))",
            (at.unix_micros(), id_list(reports)),
        )
        .map(drop),
        ReportMove::Waiting(reports) => write_ids(
            connection,
            "UPDATE report SET state = 'WAITING'
             WHERE state IN ('SENT', 'PARKED') AND id IN (SELECT value FROM json_each(?))",
            reports,
        ),
        ReportMove::Reopened(reports) => write_ids(
            connection,
            "UPDATE report SET state = 'WAITING'
             WHERE state = 'DONE' AND receipted_at IS NOT NULL AND is_revoked = 0
                 AND body IS NOT NULL AND id IN (SELECT value FROM json_each(?))",
            reports,
        ),
        ReportMove::Attempted(messages) => write_ids(
            connection,
            "UPDATE report SET attempts = attempts + 1
             WHERE state = 'WAITING' AND message IN (SELECT value FROM json_each(?))",
            messages,
        ),
        ReportMove::Parked(messages) => write_ids(
            connection,
            "UPDATE report SET state = 'PARKED'
             WHERE state = 'WAITING' AND message IN (SELECT value FROM json_each(?))",
            messages,
        ),
        ReportMove::Done(reports) => write_ids(
            connection,
            "UPDATE report SET state = 'DONE' WHERE id IN (SELECT value FROM json_each(?))",
            reports,
        ),
        ReportMove::Revoked(reports) => write_ids(
            connection,
            "UPDATE report SET is_revoked = 1 WHERE id IN (SELECT value FROM json_each(?))",
            reports,
        ),
    }
}

fn sent(
    connection: &Connection,
    reports: &[(i64, Option<MessageId>)],
    at: DateTime,
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        // A report that was taken back while it was leaving has left all the same: its receipt is
        // waited for, and it is not sent again.
        "UPDATE report SET
             is_revoked = iif(state = 'DONE', 1, is_revoked), state = 'SENT', sent_at = ?,
             sent_count = sent_count + 1, message_id = coalesce(?, message_id)
         WHERE id = ? AND (state = 'WAITING' OR (state = 'DONE' AND sent_at IS NULL))",
        reports,
        |(id, message)| (at.unix_micros(), message.as_ref().map(MessageId::as_str), id),
    )
}
