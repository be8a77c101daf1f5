//! Ids of messages: they say nothing that their reports do not say.

use connector_state::{
    ChangeSet,
    use_cases::keep_alive::{KeepAlive, keep_alives},
};
use sha2::{Digest as _, Sha256};

use super::*;

/// Two requests with different recipients share a message; a tool of one of them gets the id, too.
#[tokio::test]
async fn a_message_id_says_nothing_about_the_reports_of_others() {
    let running = Running::with_two_open_fields().await;
    running.enter_both(4711).await;
    let rows = running.fetch(Lane::Reports).await;
    let [row] = &rows[..] else { panic!("{} messages", rows.len()) };
    let id = row.envelope.message_id.clone().expect("an id");
    // Who knows one report and guesses the other one cannot confirm the guess.
    let mut connection = connect(&running.folder).await;
    let bodies: Vec<String> = sqlx::query_scalar("SELECT body FROM report ORDER BY id")
        .fetch_all(&mut connection)
        .await
        .expect("read");
    let mut hasher = Sha256::new();
    hasher.update("F");
    hasher.update(row.id.0.to_be_bytes());
    for body in &bodies {
        hasher.update(body.as_bytes());
    }
    let mut bytes = [0_u8; 16];
    bytes.copy_from_slice(&hasher.finalize()[..16]);
    let guessed = uuid::Builder::from_custom_bytes(bytes).into_uuid();
    assert_ne!(id.to_string(), guessed.to_string());
    // The same reports have the same id after a restart, other random bytes another one.
    let folder = running.close().await;
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    let again = running.fetch(Lane::Reports).await;
    assert_eq!(again[0].envelope.message_id, Some(id.clone()));
    sqlx::query("UPDATE report SET salt = randomblob(32)")
        .execute(&mut connection)
        .await
        .expect("written");
    let other = running.fetch(Lane::Reports).await;
    assert_ne!(other[0].envelope.message_id, Some(id));
    assert_eq!(other[0].envelope.body.len(), again[0].envelope.body.len());
}

/// Returns every UUID in a text.
fn ids_in(text: &str) -> impl Iterator<Item = uuid::Uuid> {
    let windows = text.as_bytes().windows(36);
    windows.filter_map(|window| uuid::Uuid::try_parse_ascii(window).ok())
}

/// An id of a version that has the time would tell it to the millisecond, whatever the time step.
#[tokio::test]
async fn no_id_of_a_message_tells_a_time() {
    let running = Running::open().await;
    let mut network = network(1);
    for index in 0..2 {
        let operation = &mut network["operationNetwork"]["operationList"][0];
        let request = &mut operation["dynamicDataRequestList"][index];
        (request["updateFrequency"], request["updateFrequencyUnit"]) = (json!(1), json!("SECOND"));
    }
    running.receive("operation-network", network).await;
    running.open_fields().await;
    running.enter_both(1).await;
    let mut rows = running.fetch(Lane::Reports).await;
    running.accept(&rows).await;
    let kept_alive = running.coordinator.execute(|state, now| {
        let later = DateTime::from_unix_micros(now.unix_micros() + 86_400_000_000);
        (keep_alives(state, later), ChangeSet::default())
    });
    let kept_alive = kept_alive.await.expect("run");
    assert_eq!(kept_alive.len(), 2, "{kept_alive:?}");
    for KeepAlive { message_id, body, .. } in kept_alive {
        let body = String::from_utf8(body.into_bytes()).expect("UTF-8");
        for id in ids_in(message_id.as_str()).chain(ids_in(&body)) {
            assert_eq!(id.get_timestamp(), None, "a keep-alive: {id}");
        }
    }
    running.revoke(Some("Enough.")).await;
    // The start submits the checkpoints of the ledger.
    let folder = running.close().await;
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    running.coordinator.read(|_| ()).await.expect("it runs");
    rows.extend(running.fetch(Lane::Control).await);
    for row in &rows {
        let id = row.envelope.message_id.as_ref().expect("an id").to_string();
        let body = std::str::from_utf8(&row.envelope.body).expect("UTF-8");
        for id in ids_in(&id).chain(ids_in(body)) {
            assert_eq!(id.get_timestamp(), None, "{}: {id}", row.envelope.subject);
        }
    }
    let subjects: std::collections::BTreeSet<&str> =
        rows.iter().map(|row| row.envelope.subject.as_str()).collect();
    let expected = [
        "acknowledgement",
        "decision",
        "ledger-checkpoint",
        "revocation",
        "ua-data",
        "ua-metadata",
    ];
    assert_eq!(Vec::from_iter(subjects), expected);
}

/// Comments and questions for the lease have ids of their own.
#[test]
fn no_id_of_the_connector_tells_a_time() {
    let id = new_message_id().to_string();
    assert_eq!(ids_in(&id).map(|id| id.get_timestamp()).collect::<Vec<_>>(), [None]);
}
