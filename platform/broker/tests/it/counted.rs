//! Refusals are counted under the name of who has used a share up.

use std::{
    collections::BTreeMap,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use broker::{BrokerUser, QueueOptions};
use messaging::Settlement;
use metrics::{Counter, Gauge, Histogram, Key, KeyName, Metadata, Recorder, SharedString, Unit};
use parking_lot::Mutex;

use crate::{
    raw::{AMQP, RawPeer, binary, boolean, described, frame, section, transfer, uint},
    support::{SECRET, TestBroker, TestLink, envelope, eventually, pattern, queue},
};

/// Counters of this thread, by share and name.
#[derive(Default)]
struct CountedShares(Mutex<BTreeMap<[String; 2], Arc<AtomicU64>>>);

impl CountedShares {
    fn of(&self, share: &str, who: &str) -> u64 {
        let all = self.0.lock();
        let counter = all.get(&[share.to_owned(), who.to_owned()]);
        counter.map_or(0, |counter| counter.load(Ordering::Relaxed))
    }
}

impl Recorder for CountedShares {
    fn describe_counter(&self, _: KeyName, _: Option<Unit>, _: SharedString) {}
    fn describe_gauge(&self, _: KeyName, _: Option<Unit>, _: SharedString) {}
    fn describe_histogram(&self, _: KeyName, _: Option<Unit>, _: SharedString) {}

    fn register_counter(&self, key: &Key, _: &Metadata<'_>) -> Counter {
        if key.name() != "broker_share_refusals_total" {
            return Counter::noop();
        }
        let label = |name: &str| {
            let label = key.labels().find(|label| label.key() == name);
            label.map(|label| label.value().to_owned()).unwrap_or_default()
        };
        let mut all = self.0.lock();
        Counter::from_arc(Arc::clone(all.entry([label("share"), label("who")]).or_default()))
    }

    fn register_gauge(&self, _: &Key, _: &Metadata<'_>) -> Gauge {
        Gauge::noop()
    }

    fn register_histogram(&self, _: &Key, _: &Metadata<'_>) -> Histogram {
        Histogram::noop()
    }
}

/// One thread runs the broker, too, so that its counters are seen.
#[tokio::test]
async fn refusals_name_who_has_used_a_share_up() {
    const INGRESS: &str = "factory.f1.ingress";
    const REQUESTS: &str = "factory.f1.requests";
    let counted = CountedShares::default();
    let _counting = metrics::set_default_local_recorder(&counted);
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start_with(folder.path(), |config| {
        config.limits.connections_per_user_max = 1;
        config.limits.dead_letters_per_queue_max = 1;
        config.limits.message_bytes_max = 10_000;
    })
    .await;
    let options = QueueOptions { messages_max: 2, ..QueueOptions::default() };
    broker.handle.declare_queue(&queue(INGRESS), options).await.expect("declared");
    let factory = BrokerUser::with_secret(SECRET.as_bytes()).may_produce(pattern(INGRESS));
    broker.users.put("f1", factory.of_organisation("north"));

    let mut rude = RawPeer::open(broker.port(), "f1", Some(INGRESS)).await;
    let large = section(0x75, &binary(&[b'x'; 20_000]));
    rude.send(&frame(AMQP, 0, &[transfer(0, 0, false), large].concat())).await;
    // The broker has detached the link, and this is the answer.
    let detach = described(0x16, &[uint(0), boolean(true)]);
    rude.send(&frame(AMQP, 0, &detach)).await;
    eventually("a message too large", || counted.of("size", "north") > 0).await;
    drop(rude);
    eventually("it has left", || broker.handle.connections().is_empty()).await;

    let full = TestLink::start(&broker.url(), "f1", &[]);
    for number in 0..3 {
        full.send(INGRESS, envelope(number, "{}"));
    }
    eventually("a full queue", || counted.of("full", "north") > 0).await;
    let second = TestLink::start(&broker.url(), "f1", &[]);
    eventually("a connection too many", || counted.of("connections", "north") > 0).await;

    let platform = TestLink::start(&broker.url(), "platform", &[REQUESTS]);
    for number in 0..3 {
        let id = format!("dead{number}");
        platform.inbox.answer(&id, Settlement::reject("unusable", "nobody can use it"));
        platform.send(REQUESTS, envelope(id, "{}"));
    }
    eventually("dead letters given up", || counted.of("dead-letters", REQUESTS) == 2).await;
    for link in [full, second, platform] {
        link.stop().await;
    }
    broker.stop().await;
}
