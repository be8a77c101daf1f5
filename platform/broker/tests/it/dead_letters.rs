//! Dead letters: whose are given up, and what goes with a queue.

use std::time::Duration;

use messaging::Settlement;
use sqlx::{ConnectOptions as _, sqlite::SqliteConnectOptions};

use crate::support::{TestBroker, TestLink, envelope, eventually, queue};

const MANY: &str = "factory.f1.requests";
const FEW: &str = "factory.f2.requests";
/// Patience with a search that comes every few seconds.
const WAIT: Duration = Duration::from_secs(20);

/// Sends messages that become dead letters, one after the other.
async fn reject(link: &TestLink, broker: &TestBroker, to: &str, ids: &[String]) {
    for id in ids {
        link.inbox.answer(id, Settlement::reject("unusable", "nobody can use it"));
        link.send(to, envelope(id, "{}"));
    }
    let are_dead = || {
        let received = link.inbox.ids();
        let is_empty = broker.handle.queue(&queue(to)).is_some_and(|q| q.ready + q.unsettled == 0);
        is_empty && ids.iter().all(|id| received.contains(id))
    };
    eventually("all are dead letters", are_dead).await;
}

fn ids(name: &str, count: u32) -> Vec<String> {
    (0..count).map(|number| format!("{name}{number}")).collect()
}

async fn letters(broker: &TestBroker) -> Vec<String> {
    let letters = broker.handle.dead_letters(0, 100).await.expect("read");
    letters.into_iter().filter_map(|letter| letter.message_id).collect()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn beyond_the_bound_of_all_the_queue_with_most_dead_letters_loses_its_oldest() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start_with(folder.path(), |config| {
        config.limits.dead_letters_max = 10;
    })
    .await;
    let link = TestLink::start(&broker.url(), "platform", &[MANY, FEW]);
    link.up().await;
    // The oldest of all are those of the other queue.
    let few = ids("few", 3);
    reject(&link, &broker, FEW, &few).await;
    let many = ids("many", 9);
    reject(&link, &broker, MANY, &many).await;
    let expected: Vec<_> = few.iter().chain(&many[2..]).cloned().collect();
    let kept = testkit::wait::eventually("ten are kept", WAIT, || async {
        let kept = letters(&broker).await;
        if kept == expected { Ok(()) } else { Err(format!("{kept:?}")) }
    });
    kept.await.expect("the oldest of the queue with most go");
    link.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_queue_goes_with_its_dead_letters_or_not_at_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let link = TestLink::start(&broker.url(), "platform", &[MANY, FEW]);
    link.up().await;
    reject(&link, &broker, FEW, &ids("other", 1)).await;
    reject(&link, &broker, MANY, &ids("own", 2)).await;
    link.stop().await;
    let options = SqliteConnectOptions::new().filename(folder.path().join("broker.db"));
    let mut beside = options.connect().await.expect("the store opens beside the broker");
    let breaking = "CREATE TRIGGER broken BEFORE DELETE ON dead_letters \
                    BEGIN SELECT RAISE(ABORT, 'broken'); END";
    sqlx::query(breaking).execute(&mut beside).await.expect("made");
    broker.handle.delete_queue(&queue(MANY)).await.expect_err("the letters cannot be deleted");
    assert!(broker.handle.queue(&queue(MANY)).is_some(), "so that it is tried again");
    assert_eq!(letters(&broker).await, ["other0", "own0", "own1"]);
    sqlx::query("DROP TRIGGER broken").execute(&mut beside).await.expect("dropped");
    broker.handle.delete_queue(&queue(MANY)).await.expect("deleted");
    assert_eq!(letters(&broker).await, ["other0"]);
    assert_eq!(broker.ready("dead-letters"), 1, "none is left to be delivered");
    broker.stop().await;
}
