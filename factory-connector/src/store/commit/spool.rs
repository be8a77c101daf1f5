//! The spool: writers, reports and what became of them, control messages.

use asi_model::{DateTime, MessageId};
use sqlx::SqliteConnection;

use crate::store::{
    Changes, ReportMove, StoreError,
    rows::{id_list, insert},
};

pub(super) async fn write_reports(connection: &mut SqliteConnection, changes: &Changes) -> Result<(), StoreError> {
    let writers: Vec<_> = changes.writers.iter().collect();
    insert(
        connection,
        "store a writer",
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
    )
    .await?;
    insert(
        connection,
        "store a report",
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
    )
    .await?;
    for change in &changes.report_moves {
        move_reports(connection, change).await?;
    }
    Ok(())
}

async fn move_reports(connection: &mut SqliteConnection, change: &ReportMove) -> Result<(), StoreError> {
    let (statement, ids) = match change {
        ReportMove::Sent { reports, at } => return sent(connection, reports, *at).await,
        ReportMove::Receipted { reports, .. } => (
            "UPDATE report SET state = 'DONE', receipted_at = ?2 WHERE id IN (SELECT value FROM json_each(?1))",
            reports,
        ),
        ReportMove::Waiting(ids) => (
            "UPDATE report SET state = 'WAITING' WHERE state IN ('SENT', 'PARKED') \
             AND id IN (SELECT value FROM json_each(?1))",
            ids,
        ),
        ReportMove::Attempted(ids) => (
            "UPDATE report SET attempts = attempts + 1 WHERE state = 'WAITING' \
             AND message IN (SELECT value FROM json_each(?1))",
            ids,
        ),
        ReportMove::Parked(ids) => (
            "UPDATE report SET state = 'PARKED' WHERE state = 'WAITING' \
             AND message IN (SELECT value FROM json_each(?1))",
            ids,
        ),
        ReportMove::Done(ids) => {
            ("UPDATE report SET state = 'DONE' WHERE id IN (SELECT value FROM json_each(?1))", ids)
        }
        ReportMove::Revoked(ids) => {
            ("UPDATE report SET is_revoked = 1 WHERE id IN (SELECT value FROM json_each(?1))", ids)
        }
    };
    let mut query = sqlx::query(statement).bind(id_list(ids));
    if let ReportMove::Receipted { at, .. } = change {
        query = query.bind(at.unix_micros());
    }
    query.execute(connection).await.map_err(StoreError::while_doing("move reports in the spool"))?;
    Ok(())
}

/// What was taken back while it was leaving has left all the same: its receipt is waited for, and it is not sent again.
async fn sent(
    connection: &mut SqliteConnection,
    reports: &[(i64, Option<MessageId>)],
    at: DateTime,
) -> Result<(), StoreError> {
    let reports: Vec<_> = reports.iter().map(|(id, message)| (id, message.as_ref().map(ToString::to_string))).collect();
    sqlx::query(
        "UPDATE report SET is_revoked = iif(state = 'DONE', 1, is_revoked), state = 'SENT', sent_at = ?2, \
         sent_count = sent_count + 1, message_id = coalesce(left.message_id, report.message_id) \
         FROM (SELECT json_extract(value, '$[0]') AS id, json_extract(value, '$[1]') AS message_id \
         FROM json_each(?1)) AS left \
         WHERE report.id = left.id AND (state = 'WAITING' OR (state = 'DONE' AND sent_at IS NULL))",
    )
    .bind(serde_json::to_string(&reports).expect("numbers and texts serialise"))
    .bind(at.unix_micros())
    .execute(connection)
    .await
    .map_err(StoreError::while_doing("move reports in the spool"))?;
    Ok(())
}

pub(super) async fn write_controls(connection: &mut SqliteConnection, changes: &Changes) -> Result<(), StoreError> {
    insert(
        connection,
        "store a control message",
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
    )
    .await?;
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
        sqlx::query(statement)
            .bind(id_list(ids))
            .execute(&mut *connection)
            .await
            .map_err(StoreError::while_doing("record what became of control messages"))?;
    }
    Ok(())
}
