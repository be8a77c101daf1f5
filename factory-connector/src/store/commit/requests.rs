//! What came: networks, ids of messages, remarks, what was rejected.

use rusqlite::Connection;

use crate::store::{
    Changes,
    writer::{run, write_rows},
};

/// Most dead letters kept; the oldest go.
const DEAD_LETTERS_MAX: i64 = 10_000;
/// How long ids of messages are remembered, in microseconds: longer than any broker keeps a
/// message.
const SEEN_MICROS_MAX: i64 = 90 * 86_400 * 1_000_000;

pub(super) fn write(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO network (operation_network_id, revision, state, message, received_at) VALUES (?, ?, ?, ?, ?) \
         ON CONFLICT (operation_network_id) DO UPDATE SET revision = excluded.revision, state = excluded.state, \
         previous_message = CASE WHEN excluded.message IS NULL THEN NULL ELSE network.message END, \
         message = excluded.message, received_at = excluded.received_at",
        &changes.networks,
        |network| {
            (
                network.operation_network_id.as_str(),
                i64::try_from(network.revision).unwrap_or(i64::MAX),
                if network.message.is_some() { "ACTIVE" } else { "WITHDRAWN" },
                &network.message,
                network.received_at.unix_micros(),
            )
        },
    )?;
    write_rows(
        connection,
        "INSERT OR IGNORE INTO seen (message_id, seen_at) VALUES (?, ?)",
        &changes.seen,
        |(message_id, at)| (message_id.as_str(), at.unix_micros()),
    )?;
    if let Some((_, now)) = changes.seen.last() {
        run(
            connection,
            "DELETE FROM seen WHERE seen_at < ?",
            (now.unix_micros() - SEEN_MICROS_MAX,),
        )?;
    }
    write_rows(
        connection,
        "INSERT OR IGNORE INTO comment (message_id, operation_network_id, dynamic_data_request_id, field_name, \
         author_id, is_own, text, written_at) VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
        &changes.comments,
        |row| {
            let comment = &row.comment;
            (
                comment.message_id.as_str(),
                comment.operation_network_id.as_str(),
                comment.dynamic_data_request_id.as_ref().map(|id| id.as_str()),
                comment.field_name.as_ref().map(|name| name.as_str()),
                &comment.author_id,
                row.is_own,
                &comment.text,
                row.written_at.unix_micros(),
            )
        },
    )?;
    if changes.dead_letters.is_empty() {
        return Ok(());
    }
    write_rows(
        connection,
        "INSERT INTO dead_letter (direction, message_id, subject, code, reason, body, occurred_at) \
         VALUES (?, ?, ?, ?, ?, ?, ?)",
        &changes.dead_letters,
        |row| {
            (
                if row.is_received { "RECEIVED" } else { "SENT" },
                row.message_id.as_ref().map(|id| id.as_str()),
                &row.subject,
                &row.code,
                &row.reason,
                &row.body,
                row.occurred_at.unix_micros(),
            )
        },
    )?;
    let oldest_go = "DELETE FROM dead_letter WHERE id <= (SELECT max(id) FROM dead_letter) - ?";
    run(connection, oldest_go, (DEAD_LETTERS_MAX,)).map(drop)
}
