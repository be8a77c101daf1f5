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
