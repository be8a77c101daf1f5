use std::collections::HashMap;

use fe2o3_amqp::types::messaging::{Batch, Data, Message};
use tokio::task::unconstrained;

use super::*;
use crate::{
    address::QueueName,
    config::{BrokerConfig, BrokerLimits, Carrier, Listener, QueueOptions},
    credentials::{BrokerUser, CredentialTable},
    disk::{DiskGauge, DiskSpace},
    shares::ShareTable,
    store::{StoreWriter, open_readers, open_writer, options},
};

/// Bytes of the disk. A fiftieth is for those who hold little: 2 000; a quarter of that is for removals.
const SIZE: u64 = 100_000;
/// Bytes of messages that may wait for their commit.
const UNCOMMITTED: usize = 1_000_000;
/// Bytes of the body of one message.
const BODY: usize = 100;

/// A broker whose writer does not run, and a publisher.
struct Bench {
    _folder: tempfile::TempDir,
    _writer: StoreWriter,
    core: Core,
    publisher: Publisher,
}

impl Bench {
    /// Opens a store on a disk with so many bytes free.
    async fn open(free: u64) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("broker.db");
        let connection = open_writer(&path).await.expect("a store");
        let readers = open_readers(&path).await.expect("it opens again");
        let name = QueueName::dead_letters();
        let dead_letters = Arc::new(Queue::new(1, name, QueueOptions::default()));
        let (writer, handle) =
            StoreWriter::new(connection, options(&path), Arc::clone(&dead_letters));
        let listener =
            Listener { address: ([127, 0, 0, 1], 0).into(), tls: None, carrier: Carrier::Stream };
        let mut config = BrokerConfig::new(listener, path);
        config.disk = DiskGauge::new(move |_| Some(DiskSpace { free, size: SIZE }));
        let users = Arc::new(CredentialTable::new());
        let core = Core::new(config, users, handle, readers, HashMap::new(), dead_letters, 1);
        let user = BrokerUser::default();
        let share = ShareTable::default().of("f1", &user, &BrokerLimits::default());
        let uncommitted = Arc::new(Semaphore::new(UNCOMMITTED));
        let publisher = Publisher { user_name: "f1".into(), share, uncommitted };
        Self { _folder: folder, _writer: writer, core, publisher }
    }

    /// Hands a message to the writer; returns the label of the refusal where it is refused.
    async fn store(&self, queue: &Arc<Queue>) -> Result<(), &'static str> {
        let body = Body::Data(Batch::new(vec![Data::from(vec![7; BODY])]));
        let order = LinkOrder::default();
        let taken = store(&self.core, queue, &self.publisher, &order, Message::from(body)).await;
        taken.map(drop).map_err(|refused| refused.reason)
    }
}

fn queue(name: &str, bytes_max: u64) -> Arc<Queue> {
    let bounds = QueueOptions { bytes_max, ..QueueOptions::default() };
    Arc::new(Queue::new(2, name.parse().expect("a name"), bounds))
}

#[tokio::test]
async fn messages_that_a_full_queue_refuses_take_no_room_on_the_disk() {
    let bench = Bench::open(4_000).await;
    let (full, other) = (queue("full", BODY as u64), queue("other", 10_000));
    for _ in 0..20 {
        assert_eq!(bench.store(&full).await, Err("full"));
    }
    assert_eq!(bench.store(&other).await, Ok(()), "others find the disk as it is");
    let held = other.bytes();
    let bench = Bench::open(499).await;
    assert_eq!(bench.store(&other).await, Err("disk"));
    assert_eq!(other.bytes(), held, "nor what the disk refuses any in its queue");
}

#[tokio::test]
async fn a_publisher_that_is_cut_while_the_writer_is_full_leaves_nothing_reserved() {
    let bench = Bench::open(SIZE).await;
    let queue = queue("q", 10_000);
    let send = || unconstrained(bench.core.writer.send(StoreCommand::Remove(0)));
    while send().now_or_never().is_some() {}
    let cut = unconstrained(bench.store(&queue)).now_or_never();
    assert_eq!(cut, None, "it waited");
    assert_eq!(queue.bytes(), 0);
    assert_eq!(bench.publisher.uncommitted.available_permits(), UNCOMMITTED);
    assert!(!bench.core.cache.contains(1));
}
