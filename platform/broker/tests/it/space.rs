//! The size of the database's files: what is consumed, expired or deleted is given back to the disk.

use std::{path::Path, time::Duration};

use broker::QueueOptions;
use messaging::Envelope;

use crate::support::{TestBroker, TestLink, envelope, eventually, queue};

const QUEUE: &str = "factory.f1.requests";
/// Bytes of one body.
const BODY: usize = 500_000;
/// Messages that wait at a time: 10 MB.
const COUNT: u64 = 20;
/// Bytes that all files may have when nothing waits.
const EMPTY_MAX: u64 = 2_000_000;

/// Bytes of the files of the database.
fn on_disk(folder: &Path) -> u64 {
    let files = std::fs::read_dir(folder).expect("a folder");
    files.map(|file| file.expect("a file").metadata().map_or(0, |file| file.len())).sum()
}

/// Sends what then waits, and checks that it is on the disk.
async fn fill(broker: &TestBroker, sender: &TestLink, folder: &Path, ttl: Option<Duration>) {
    for at in 0..COUNT {
        let message = envelope(at, vec![7; BODY]);
        let creation_time = Some(time::OffsetDateTime::now_utc());
        sender.send(QUEUE, Envelope { ttl, creation_time, ..message });
    }
    eventually("all wait", || broker.ready(QUEUE) == COUNT).await;
    let bytes = on_disk(folder);
    assert!(bytes >= COUNT * BODY as u64, "{bytes} bytes on the disk");
}

async fn is_freed(broker: &TestBroker, folder: &Path, why: &str) {
    eventually(why, || broker.ready(QUEUE) == 0).await;
    eventually(&format!("the disk is free: {why}"), || on_disk(folder) < EMPTY_MAX).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn consumption_expiry_and_deletion_free_the_disk() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    broker.declare(QUEUE).await;
    let sender = TestLink::start(&broker.url(), "platform", &[]);

    fill(&broker, &sender, folder.path(), Some(Duration::from_secs(6))).await;
    is_freed(&broker, folder.path(), "all have expired").await;

    fill(&broker, &sender, folder.path(), None).await;
    let receiver = TestLink::start(&broker.url(), "f1", &[QUEUE]);
    is_freed(&broker, folder.path(), "all are consumed").await;
    receiver.stop().await;

    fill(&broker, &sender, folder.path(), None).await;
    sender.stop().await;
    broker.handle.delete_queue(&queue(QUEUE)).await.expect("deleted");
    is_freed(&broker, folder.path(), "the queue is deleted").await;
    broker.stop().await;
}

/// The quota of a queue bounds the files, however much its publishers have.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_quota_bounds_the_disk_and_consumption_frees_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let options = QueueOptions { bytes_max: 4 * BODY as u64 + 10_000, ..QueueOptions::default() };
    broker.handle.declare_queue(&queue(QUEUE), options).await.expect("declared");
    let sender = TestLink::start(&broker.url(), "platform", &[]);
    for at in 0..COUNT {
        sender.send(QUEUE, envelope(at, vec![7; BODY]));
    }
    eventually("the queue is full", || broker.ready(QUEUE) == 4).await;
    // What is refused comes again and again.
    tokio::time::sleep(Duration::from_secs(1)).await;
    let bytes = on_disk(folder.path());
    assert!(bytes < 3 * options.bytes_max, "{bytes} bytes on the disk");
    let receiver = TestLink::start(&broker.url(), "f1", &[QUEUE]);
    eventually("all have arrived", || receiver.inbox.ids().len() as u64 == COUNT).await;
    is_freed(&broker, folder.path(), "all are consumed").await;
    receiver.stop().await;
    sender.stop().await;
    broker.stop().await;
}

/// A file of a former version is converted at the start.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_file_that_never_shrank_shrinks() {
    use sqlx::Connection as _;
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    broker.declare(QUEUE).await;
    broker.stop().await;
    let database = format!("sqlite://{}", folder.path().join("broker.db").display());
    let mut former = sqlx::SqliteConnection::connect(&database).await.expect("a database");
    let sql = "PRAGMA journal_mode = DELETE; PRAGMA auto_vacuum = NONE; VACUUM;
        INSERT INTO messages (id, queue_id, bytes, body)
            VALUES (1, 0, 0, zeroblob(10000000)), (2, 0, 0, zeroblob(1000000));
        DELETE FROM messages WHERE id = 1;";
    sqlx::raw_sql(sql).execute(&mut former).await.expect("as a former version left it");
    former.close().await.expect("closed");
    assert!(on_disk(folder.path()) > 10_000_000);
    let broker = TestBroker::start(folder.path()).await;
    eventually("the disk is free", || on_disk(folder.path()) < 2 * EMPTY_MAX).await;
    broker.stop().await;
}
