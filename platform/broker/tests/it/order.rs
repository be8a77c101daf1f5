//! Order of a publisher's messages where some of them cannot be stored.

use std::path::Path;

use sqlx::{ConnectOptions as _, SqliteConnection, sqlite::SqliteConnectOptions};

use crate::support::{TestBroker, TestLink, envelope, eventually};

const QUEUE: &str = "factory.f1.ingress";

async fn store(folder: &Path) -> SqliteConnection {
    let options = SqliteConnectOptions::new().filename(folder.join("broker.db"));
    options.connect().await.expect("the store opens beside the broker")
}

/// Sends many messages, of which the store takes all but one at first. `uncommitted` bounds the bytes that are stored at
/// once.
async fn nothing_passes_what_is_refused(uncommitted: u32) {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start_with(folder.path(), |config| {
        config.limits.uncommitted_bytes_per_user_max = uncommitted;
    })
    .await;
    let mut beside = store(folder.path()).await;
    let breaking = "CREATE TRIGGER broken BEFORE INSERT ON messages \
                    WHEN instr(NEW.body, CAST('m050' AS BLOB)) > 0 \
                    BEGIN SELECT RAISE(ABORT, 'disk full'); END";
    sqlx::query(breaking).execute(&mut beside).await.expect("made");
    let sender = TestLink::start(&broker.url(), "f1", &[]);
    let sent: Vec<_> = (0..200).map(|number| format!("m{number:03}")).collect();
    for id in &sent {
        sender.send(QUEUE, envelope(id, "{}"));
    }
    eventually("the link says why", || sender.reason().contains("could not store")).await;
    eventually("what came before is stored", || broker.ready(QUEUE) > 0).await;
    tokio::time::sleep(std::time::Duration::from_millis(300)).await;
    assert!(broker.ready(QUEUE) <= 50, "{} are stored", broker.ready(QUEUE));
    sqlx::query("DROP TRIGGER broken").execute(&mut beside).await.expect("dropped");
    let receiver = TestLink::start(&broker.url(), "platform", &[QUEUE]);
    eventually("all arrive", || receiver.inbox.ids().len() >= sent.len()).await;
    eventually("no obstacle is left", || sender.reason().is_empty()).await;
    assert_eq!(receiver.inbox.ids(), sent, "each once, in order");
    sender.stop().await;
    receiver.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nothing_passes_a_message_that_the_store_refuses() {
    nothing_passes_what_is_refused(1).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nothing_that_waits_for_the_store_passes_a_message_that_it_refuses() {
    nothing_passes_what_is_refused(1_000).await;
}
