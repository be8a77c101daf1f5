//! What came: networks, ids of messages, remarks, what was rejected.

use crate::store::{Changes, rows::Batch};

/// Most dead letters kept; the oldest go.
const DEAD_LETTERS_MAX: i64 = 10_000;
/// How long ids of messages are remembered, in microseconds: longer than any broker keeps a message.
const SEEN_MICROS_MAX: i64 = 90 * 86_400 * 1_000_000;

pub(super) fn write(batch: &mut Batch, changes: &Changes) {
    batch.insert(
        "INSERT INTO network (operation_network_id, revision, state, message, received_at)",
        " ON CONFLICT (operation_network_id) DO UPDATE SET revision = excluded.revision, state = excluded.state, \
         previous_message = CASE WHEN excluded.message IS NULL THEN NULL ELSE network.message END, \
         message = excluded.message, received_at = excluded.received_at",
        &changes.networks,
        |values, network| {
            let state = if network.message.is_some() { "ACTIVE" } else { "WITHDRAWN" };
            values.push_bind(network.operation_network_id.to_string());
            values.push_bind(i64::try_from(network.revision).unwrap_or(i64::MAX));
            values.push_bind(state);
            values.push_bind(network.message.clone());
            values.push_bind(network.received_at.unix_micros());
        },
    );
    batch.insert("INSERT OR IGNORE INTO seen (message_id, seen_at)", "", &changes.seen, |values, (message_id, at)| {
        values.push_bind(message_id.to_string());
        values.push_bind(at.unix_micros());
    });
    if let Some((_, now)) = changes.seen.last() {
        batch.run("DELETE FROM seen WHERE seen_at < ?").bind(now.unix_micros() - SEEN_MICROS_MAX);
    }
    batch.insert(
        "INSERT OR IGNORE INTO comment (message_id, operation_network_id, dynamic_data_request_id, field_name, \
         author_id, is_own, text, written_at)",
        "",
        &changes.comments,
        |values, row| {
            values.push_bind(row.comment.message_id.to_string());
            values.push_bind(row.comment.operation_network_id.to_string());
            values.push_bind(row.comment.dynamic_data_request_id.as_ref().map(ToString::to_string));
            values.push_bind(row.comment.field_name.as_ref().map(ToString::to_string));
            values.push_bind(row.comment.author_id.clone());
            values.push_bind(i64::from(row.is_own));
            values.push_bind(row.comment.text.clone());
            values.push_bind(row.written_at.unix_micros());
        },
    );
    if changes.dead_letters.is_empty() {
        return;
    }
    batch.insert(
        "INSERT INTO dead_letter (direction, message_id, subject, code, reason, body, occurred_at)",
        "",
        &changes.dead_letters,
        |values, row| {
            values.push_bind(if row.is_received { "RECEIVED" } else { "SENT" });
            values.push_bind(row.message_id.as_ref().map(ToString::to_string));
            values.push_bind(row.subject.clone());
            values.push_bind(row.code.clone());
            values.push_bind(row.reason.clone());
            values.push_bind(row.body.clone());
            values.push_bind(row.occurred_at.unix_micros());
        },
    );
    batch.run("DELETE FROM dead_letter WHERE id <= (SELECT max(id) FROM dead_letter) - ?").bind(DEAD_LETTERS_MAX);
}
