//! Times of messages: none is between two time steps.

use super::*;

/// The time step is an hour.
#[tokio::test]
async fn no_time_of_a_message_is_finer_than_the_time_step() {
    const HOUR: i128 = 3_600_000_000_000;
    let running = Running::open().await;
    running.receive("operation-network", network(1)).await;
    for name in ["made", "note"] {
        let command = DecisionCommand::Map {
            value_source: ValueSource::Manual,
            mapping: None,
            policy: DisclosurePolicy { time_step_ms: Some(3_600_000), ..Default::default() },
        };
        decide_field(&running.coordinator, field(name), command).await;
    }
    let rows = running.fetch(Lane::Control).await;
    let described: Vec<_> =
        rows.iter().filter(|row| row.envelope.subject == "ua-metadata").collect();
    assert!(!described.is_empty());
    for row in described {
        let created = row.envelope.creation_time.expect("a time");
        assert_eq!(created.unix_timestamp_nanos() % HOUR, 0, "the envelope");
        let body: Value = serde_json::from_slice(&row.envelope.body).expect("JSON");
        let timestamp: DateTime =
            serde_json::from_value(body["Timestamp"].clone()).expect("a time");
        assert_eq!(timestamp.floor_to(Duration::from_secs(3600)), timestamp, "the metadata");
    }
    let mut connection = connect(&running.folder).await;
    let body = json!({ "Timestamp": "2026-11-23T10:00:00Z", "Payload": {} }).to_string();
    sqlx::query(
        "INSERT INTO report (id, message, writer_id, epoch, sequence, state, created_at, recipients,
             bytes, body, salt)
         VALUES (900, 900, 1, 1, 0, 'WAITING', 1795430000123456, '[]', 2, ?, randomblob(32))",
    )
    .bind(body)
    .execute(&mut connection)
    .await
    .expect("written");
    let rows = running.fetch(Lane::Reports).await;
    let created = rows[0].envelope.creation_time.expect("a time");
    assert_eq!(created.unix_timestamp_nanos() % HOUR, 0, "the envelope of a report");
}

/// Partners read the chain of the ledger: what it says of a release is on the step as well, and
/// nothing is finer than a millisecond.
#[tokio::test]
async fn no_time_of_a_release_in_the_ledger_is_finer_than_the_time_step() {
    const STEP: Duration = Duration::from_millis(50);
    const MS: Duration = Duration::from_millis(1);
    let running = Running::open().await;
    running.receive("operation-network", network(1)).await;
    for name in ["made", "note"] {
        let command = DecisionCommand::Map {
            value_source: ValueSource::Manual,
            mapping: None,
            policy: DisclosurePolicy { time_step_ms: Some(50), ..Default::default() },
        };
        decide_field(&running.coordinator, field(name), command).await;
    }
    running.enter_both(1).await;
    let is_queued = || async {
        let entries = running.entries("acme").await;
        let is_queued = entries.iter().any(|entry| entry["event"] == "QUEUED");
        if is_queued { Ok(()) } else { Err(format!("{entries:?}")) }
    };
    testkit::wait::eventually("a report", DEADLINE, is_queued).await.expect("on the next step");
    let rows = running.fetch(Lane::Reports).await;
    running.accept(&rows).await;
    running.receipt(&reports(&rows[0])[0], 0).await;
    let folder = running.close().await;
    let mut connection = connect(folder.path()).await;
    let mut ledger = crate::store::Ledger(&mut connection);
    let mut queued = 0;
    for recipient in ledger.recipients().await.expect("read") {
        let recipient = recipient.parse().expect("an id");
        for line in ledger.audit_entries(&recipient, 0).await.expect("read") {
            let entry: ::ledger::LedgerEntry = serde_json::from_str(&line.entry).expect("an entry");
            let is_queued = matches!(entry.event, ::ledger::Event::Queued { .. });
            let step = if is_queued { STEP } else { MS };
            assert_eq!(entry.recorded_at.floor_to(step), entry.recorded_at, "{}", line.entry);
            queued += usize::from(is_queued);
            for at in [line.sent_at, line.delivered_at].into_iter().flatten() {
                assert_eq!(at.floor_to(MS), at, "{}", line.entry);
            }
        }
    }
    assert!(queued > 0);
}
