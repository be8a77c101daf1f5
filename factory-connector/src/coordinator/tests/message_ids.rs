//! Ids of messages: they say nothing that their reports do not say.

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
