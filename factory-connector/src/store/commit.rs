//! The one transaction.

use asi_model::{
    DateTime, MessageId,
    messages::{MappingState, ValueSource},
};
use sqlx::{Connection as _, SqliteConnection};

use super::{
    Changes, ReportMove, Store, StoreError, mappings,
    policies::write_policies,
    rows::{id_list, insert},
};

/// Most dead letters kept; the oldest go.
const DEAD_LETTERS_MAX: i64 = 10_000;
/// How long ids of messages are remembered, in microseconds: longer than any broker keeps a message.
const SEEN_MICROS_MAX: i64 = 90 * 86_400 * 1_000_000;

impl Store {
    /// Writes everything or nothing.
    ///
    /// # Errors
    /// [`StoreError::Database`]; then nothing was written.
    pub async fn commit(&mut self, changes: Changes) -> Result<(), StoreError> {
        let outcome = self.write(changes).await;
        if outcome.is_err() {
            self.replace_writer().await;
        }
        outcome
    }

    async fn write(&mut self, changes: Changes) -> Result<(), StoreError> {
        let begin = StoreError::while_doing("begin a transaction");
        let mut transaction = self.writer.begin_with("BEGIN IMMEDIATE").await.map_err(begin)?;
        write_requests(&mut transaction, &changes).await?;
        write_decisions(&mut transaction, &changes).await?;
        mappings::write(&mut transaction, &changes.mappings).await?;
        write_policies(&mut transaction, &changes).await?;
        write_reports(&mut transaction, &changes).await?;
        write_controls(&mut transaction, &changes).await?;
        write_ledger(&mut transaction, &changes).await?;
        write_sources(&mut transaction, &changes).await?;
        super::operator::write(&mut transaction, &changes).await?;
        transaction.commit().await.map_err(StoreError::while_doing("commit a transaction"))
    }
}

async fn write_requests(connection: &mut SqliteConnection, changes: &Changes) -> Result<(), StoreError> {
    let action = "store a network";
    insert(
        connection,
        action,
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
    )
    .await?;
    insert(
        connection,
        "remember a message",
        "INSERT OR IGNORE INTO seen (message_id, seen_at)",
        "",
        &changes.seen,
        |values, (message_id, at)| {
            values.push_bind(message_id.to_string());
            values.push_bind(at.unix_micros());
        },
    )
    .await?;
    if let Some((_, now)) = changes.seen.last() {
        sqlx::query("DELETE FROM seen WHERE seen_at < ?")
            .bind(now.unix_micros() - SEEN_MICROS_MAX)
            .execute(&mut *connection)
            .await
            .map_err(StoreError::while_doing("forget old messages"))?;
    }
    insert(
        connection,
        "store a comment",
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
    )
    .await?;
    if changes.dead_letters.is_empty() {
        return Ok(());
    }
    insert(
        connection,
        "store a dead letter",
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
    )
    .await?;
    sqlx::query("DELETE FROM dead_letter WHERE id <= (SELECT max(id) FROM dead_letter) - ?")
        .bind(DEAD_LETTERS_MAX)
        .execute(connection)
        .await
        .map_err(StoreError::while_doing("drop old dead letters"))?;
    Ok(())
}

async fn write_decisions(connection: &mut SqliteConnection, changes: &Changes) -> Result<(), StoreError> {
    if !changes.removed_fields.is_empty() {
        sqlx::query("DELETE FROM field WHERE id IN (SELECT value FROM json_each(?))")
            .bind(id_list(&changes.removed_fields))
            .execute(&mut *connection)
            .await
            .map_err(StoreError::while_doing("remove fields"))?;
    }
    let fields: Vec<_> = changes.fields.values().collect();
    insert(
        connection,
        "store a field",
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
    )
    .await?;
    let field_values: Vec<_> = changes.field_values.iter().collect();
    insert(
        connection,
        "store field values",
        "INSERT INTO field_value (field_id, gate, transform)",
        " ON CONFLICT (field_id) DO UPDATE SET gate = excluded.gate, transform = excluded.transform",
        &field_values,
        |values, (id, row)| {
            values.push_bind(**id);
            values.push_bind(row.gate.clone());
            values.push_bind(row.transform.clone());
        },
    )
    .await?;
    insert(
        connection,
        "store a consent",
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
    )
    .await
}

async fn write_reports(connection: &mut SqliteConnection, changes: &Changes) -> Result<(), StoreError> {
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

async fn write_controls(connection: &mut SqliteConnection, changes: &Changes) -> Result<(), StoreError> {
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

async fn write_ledger(connection: &mut SqliteConnection, changes: &Changes) -> Result<(), StoreError> {
    insert(
        connection,
        "write the ledger",
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
    )
    .await?;
    insert(
        connection,
        "sign the ends of the ledger's chains",
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
    )
    .await?;
    insert(
        connection,
        "keep a revocation's receipt",
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
    )
    .await?;
    if let Some(checkpoint) = &changes.checkpoint {
        sqlx::query(
            "INSERT INTO ledger_checkpoint (number, recorded_at, content, signature, public_key) VALUES (?, ?, ?, ?, ?)",
        )
        .bind(i64::try_from(checkpoint.number).unwrap_or(i64::MAX))
        .bind(checkpoint.recorded_at.unix_micros())
        .bind(checkpoint.content.clone())
        .bind(checkpoint.signature.to_vec())
        .bind(checkpoint.public_key.to_vec())
        .execute(connection)
        .await
        .map_err(StoreError::while_doing("write a checkpoint"))?;
    }
    Ok(())
}

async fn write_sources(connection: &mut SqliteConnection, changes: &Changes) -> Result<(), StoreError> {
    insert(
        connection,
        "store a source",
        "INSERT INTO source (source_id, config, password)",
        " ON CONFLICT (source_id) DO UPDATE SET config = excluded.config, password = excluded.password",
        &changes.sources,
        |values, row| {
            values.push_bind(row.source_id.clone());
            values.push_bind(row.config.clone());
            values.push_bind(row.password.clone());
        },
    )
    .await?;
    for source_id in &changes.removed_sources {
        sqlx::query("DELETE FROM source WHERE source_id = ?")
            .bind(source_id.clone())
            .execute(&mut *connection)
            .await
            .map_err(StoreError::while_doing("remove a source"))?;
    }
    Ok(())
}

pub(super) const fn mapping_state_name(state: MappingState) -> &'static str {
    match state {
        MappingState::Pending => "PENDING",
        MappingState::Mapped => "MAPPED",
        MappingState::Refused => "REFUSED",
    }
}

pub(super) const fn value_source_name(source: ValueSource) -> &'static str {
    match source {
        ValueSource::Mapping => "MAPPING",
        ValueSource::Manual => "MANUAL",
        ValueSource::External => "EXTERNAL",
    }
}
