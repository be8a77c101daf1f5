//! A disk with little room: who holds much waits, others are served, and what is there is delivered.

use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use broker::{DiskGauge, DiskSpace, DiskState};

use crate::support::{TestBroker, TestLink, envelope, eventually};

const HEAVY: &str = "factory.f1.ingress";
const LIGHT: &str = "factory.f2.ingress";
/// Bytes of the disk. A fiftieth is for those who hold little: 2 MB; a quarter of that is for removals.
const SIZE: u64 = 100_000_000;
const PLENTY: u64 = 50_000_000;
/// Bytes of one message.
const BODY: usize = 100_000;
const COUNT: u64 = 20;

/// Disk whose free space a test sets.
#[derive(Clone)]
struct PlayedDisk(Arc<AtomicU64>);

impl PlayedDisk {
    fn gauge(&self) -> DiskGauge {
        let Self(free) = self.clone();
        DiskGauge::new(move |_| Some(DiskSpace { free: free.load(Ordering::Relaxed), size: SIZE }))
    }

    /// Sets the free space, and waits until the broker has seen it, which looks each second.
    async fn has(&self, free: u64) {
        self.0.store(free, Ordering::Relaxed);
        tokio::time::sleep(Duration::from_millis(1_200)).await;
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn on_a_short_disk_who_holds_much_waits_and_others_are_served() {
    let folder = tempfile::tempdir().expect("a folder");
    let disk = PlayedDisk(Arc::new(AtomicU64::new(PLENTY)));
    let broker = TestBroker::start_with(folder.path(), |config| config.disk = disk.gauge()).await;
    broker.declare(HEAVY).await;
    broker.declare(LIGHT).await;
    let (heavy, light) = (
        TestLink::start(&broker.url(), "f1", &[]),
        TestLink::start(&broker.url(), "platform", &[]),
    );
    for number in 0..COUNT {
        heavy.send(HEAVY, envelope(format!("m{number:02}"), vec![7; BODY]));
    }
    eventually("much is held", || broker.ready(HEAVY) == COUNT).await;

    disk.has(1_500_000).await;
    heavy.send(HEAVY, envelope("last", vec![7; BODY]));
    eventually("it is said why", || heavy.reason().contains("disk is nearly full")).await;
    assert_eq!(broker.handle.disk(), DiskState::Short);
    assert!(heavy.reason().contains("amqp:resource-limit-exceeded"), "{}", heavy.reason());
    light.send(LIGHT, envelope("little", "{}"));
    eventually("who holds little is served", || broker.ready(LIGHT) == 1).await;
    assert_eq!((broker.ready(HEAVY), heavy.spool.waiting()), (COUNT, 1));

    let receiver = TestLink::start(&broker.url(), "platform", &[HEAVY]);
    eventually("what is held is delivered, and what waited has room then", || {
        receiver.inbox.ids().len() as u64 == COUNT + 1
    })
    .await;
    assert_eq!(receiver.inbox.ids().last().map(String::as_str), Some("last"));
    eventually("no obstacle is left", || heavy.reason().is_empty()).await;
    for link in [heavy, light, receiver] {
        link.stop().await;
    }
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_last_room_of_a_disk_is_for_acknowledgements_and_removals() {
    let folder = tempfile::tempdir().expect("a folder");
    let disk = PlayedDisk(Arc::new(AtomicU64::new(PLENTY)));
    let broker = TestBroker::start_with(folder.path(), |config| config.disk = disk.gauge()).await;
    let sender = TestLink::start(&broker.url(), "f1", &[]);
    sender.send(HEAVY, envelope("before", "{}"));
    eventually("it is stored", || broker.ready(HEAVY) == 1).await;
    disk.has(400_000).await;
    sender.send(HEAVY, envelope("after", "{}"));
    eventually("it is said why", || sender.reason().contains("disk has no room")).await;
    assert_eq!(broker.handle.disk(), DiskState::Full);
    let receiver = TestLink::start(&broker.url(), "platform", &[HEAVY]);
    eventually("what is there is delivered", || receiver.inbox.ids() == ["before"]).await;
    let is_empty = || {
        let queues = broker.handle.queues();
        queues.iter().all(|queue| queue.ready + queue.unsettled == 0)
    };
    eventually("and removed", is_empty).await;
    assert_eq!(sender.spool.waiting(), 1, "nothing is taken, nothing is lost");
    disk.has(PLENTY).await;
    assert_eq!(broker.handle.disk(), DiskState::Enough);
    eventually("there is room again", || receiver.inbox.ids() == ["before", "after"]).await;
    sender.stop().await;
    receiver.stop().await;
    broker.stop().await;
}
