use std::sync::atomic::AtomicBool;

use tokio::sync::{Semaphore, oneshot};

use super::*;
use crate::{
    config::QueueOptions,
    message::Features,
    queue::{Next, Subscription},
    store::{self, DeadLettering, LinkOrder, NewMessage},
};

type Answer = oneshot::Receiver<Result<(), WriteFailed>>;

/// A writer with a queue and that of the dead letters, which nobody serves.
struct Bench {
    _folder: tempfile::TempDir,
    writer: StoreWriter,
    queue: Arc<Queue>,
    dead_letters: Arc<Queue>,
}

impl Bench {
    /// Opens a store, which `breaking` changes.
    async fn open(breaking: &'static str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("broker.db");
        let mut connection = store::open_writer(&path).await.expect("a store");
        sqlx::raw_sql(breaking).execute(&mut connection).await.expect("changed");
        let queue = |id, name: &str| {
            let name = name.parse().expect("a name");
            Arc::new(Queue::new(id, name, QueueOptions::default()))
        };
        let (queue, dead_letters) = (queue(1, "q"), queue(2, "dead-letters"));
        let (writer, _) =
            StoreWriter::new(connection, store::options(&path), Arc::clone(&dead_letters));
        Self { _folder: folder, writer, queue, dead_letters }
    }

    fn message(&self, id: i64, order: &LinkOrder) -> (StoreCommand, Answer) {
        let (done, answer) = oneshot::channel();
        let uncommitted = Arc::new(Semaphore::new(1)).try_acquire_owned().expect("it is free");
        let (queue, order) = (Arc::clone(&self.queue), order.clone());
        let wire = b"x".to_vec();
        let new = NewMessage { queue, entry: entry(id), wire, order, uncommitted, done };
        (StoreCommand::Insert(new), answer)
    }

    /// Returns a message that becomes a dead letter, and the flag of its arrival.
    fn letter(&self, id: i64) -> (StoreCommand, Arc<AtomicBool>) {
        let is_new = Arc::new(AtomicBool::new(false));
        let letter = DeadLettering {
            entry: entry(id),
            origin: Arc::clone(&self.queue),
            features: Features::default(),
            code: "unusable".to_owned(),
            reason: "nobody can use it".to_owned(),
            is_new: Arc::clone(&is_new),
        };
        (StoreCommand::DeadLetter(Box::new(letter)), is_new)
    }
}

fn entry(id: i64) -> QueueEntry {
    QueueEntry { id, bytes: 1, expires_at_ms: None, delivery_count: 0, is_redelivered: false }
}

#[tokio::test]
async fn a_message_that_the_store_refuses_is_refused_to_its_link_alone() {
    let mut bench = Bench::open(
        "CREATE TRIGGER broken BEFORE INSERT ON messages WHEN NEW.id = 2 \
         BEGIN SELECT RAISE(ABORT, 'broken'); END",
    )
    .await;
    let (one, other) = (LinkOrder::default(), LinkOrder::default());
    let sent = [(1, &one), (2, &one), (3, &other), (4, &other)];
    let (commands, mut answers): (Vec<_>, Vec<_>) =
        sent.into_iter().map(|(id, order)| bench.message(id, order)).unzip();
    bench.writer.write(commands).await;
    let mut is_stored = |at: usize| matches!(answers[at].try_recv(), Ok(Ok(())));
    assert_eq!([0, 1, 2, 3].map(&mut is_stored), [false, false, true, true]);
    assert_eq!(bench.queue.upcoming(0, 10, u64::MAX), [3, 4]);
    assert!(one.is_refused() && !other.is_refused(), "what comes behind it waits, too");
}

#[tokio::test]
async fn a_message_that_went_with_its_queue_becomes_no_dead_letter() {
    let mut bench = Bench::open("SELECT 1").await;
    let (sent, _) = bench.message(1, &LinkOrder::default());
    bench.writer.write(vec![sent]).await;
    let (done, mut answer) = oneshot::channel();
    let delete = StoreCommand::DeleteQueue { id: 1, name: "q".to_owned(), done };
    let (letter, is_new) = bench.letter(1);
    // A consumer rejects it while the queue is deleted.
    bench.writer.write(vec![delete, letter]).await;
    assert!(matches!(answer.try_recv(), Ok(Ok(()))));
    assert_eq!(bench.dead_letters.status().ready, 0, "nobody is offered what is not there");
    assert!(!is_new.load(Ordering::Relaxed));
}

#[tokio::test]
async fn dead_letters_are_looked_at_again_once_one_is_committed() {
    let mut bench = Bench::open(
        "CREATE TRIGGER broken BEFORE INSERT ON dead_letters \
         BEGIN SELECT RAISE(ABORT, 'broken'); END",
    )
    .await;
    let (sent, _) = bench.message(1, &LinkOrder::default());
    let (letter, is_new) = bench.letter(1);
    bench.writer.write(vec![sent]).await;
    bench.writer.write(vec![letter]).await;
    assert!(!is_new.load(Ordering::Relaxed), "a sweep in between would find nothing");
    let mended = sqlx::query("DROP TRIGGER broken").execute(&mut bench.writer.connection);
    mended.await.expect("dropped");
    let retained = std::mem::take(&mut bench.writer.retained);
    bench.writer.write(retained).await;
    assert_eq!(bench.dead_letters.upcoming(0, 10, u64::MAX), [1]);
    assert!(is_new.load(Ordering::Relaxed), "the next sweep looks");
}

#[tokio::test]
async fn a_leased_dead_letter_of_a_deleted_queue_is_offered_to_nobody() {
    let mut bench = Bench::open("SELECT 1").await;
    let (sent, _) = bench.message(1, &LinkOrder::default());
    let (letter, _) = bench.letter(1);
    bench.writer.write(vec![sent, letter]).await;
    let consumer = Subscription::new(Arc::clone(&bench.dead_letters));
    let Next::Lease(leased) = consumer.next().await else { panic!("the letter is there") };
    let (done, _answer) = oneshot::channel();
    let delete = StoreCommand::DeleteQueue { id: 1, name: "q".to_owned(), done };
    bench.writer.write(vec![delete]).await;
    bench.dead_letters.requeue(leased);
    let status = bench.dead_letters.status();
    assert_eq!((status.ready, status.unsettled), (0, 0));
    assert_eq!(status.bytes, 0);
}
