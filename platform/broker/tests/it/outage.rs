//! The link through restarts, cut connections and stalls of the embedded broker.

use std::time::Duration;

use messaging::{LinkPhase, RowId, spool::memory::AcceptedReports};

use crate::{
    proxy::Proxy,
    support::{TestBroker, TestLink, address, envelope, eventually},
};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_broker_restart_loses_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let proxy_port = broker.port();
    let sender = TestLink::start(&broker.url(), "f1", &[]);
    for n in 0..200 {
        sender.send("factory.f1.ingress", envelope(format!("m{n}"), "{}"));
    }
    eventually("all are stored", || {
        broker.ready("factory.f1.ingress") == 200 && sender.spool.waiting() == 0
    })
    .await;
    broker.stop().await;
    sender.send("factory.f1.ingress", envelope("late", "{}"));
    let state = sender.handle.state();
    eventually("the loss is told", || matches!(state.borrow().phase, LinkPhase::Down { .. })).await;

    let broker = TestBroker::start_with(folder.path(), |config| {
        config.listeners[0].address.set_port(proxy_port);
    })
    .await;
    let receiver = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    eventually("all arrive", || receiver.inbox.ids().len() == 201).await;
    let mut expected: Vec<_> = (0..200).map(|n| format!("m{n}")).collect();
    expected.push("late".to_owned());
    assert_eq!(receiver.inbox.ids(), expected, "in their order");
    assert!(sender.handle.state().borrow().connects >= 2);
    eventually("the queue is empty", || broker.ready("factory.f1.ingress") == 0).await;
    sender.stop().await;
    receiver.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_cut_connection_may_repeat_but_never_lose() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let proxy = Proxy::to(broker.port()).await;
    let sender = TestLink::start(&proxy.url(), "f1", &[]);
    let receiver = TestLink::start(&proxy.url(), "platform", &["factory.f1.ingress"]);
    let total = 3000;
    for n in 0..total {
        sender.send("factory.f1.ingress", envelope(format!("m{n}"), vec![b'x'; 500]));
        if n % 500 == 250 {
            let seen = receiver.inbox.ids().len();
            eventually("some more pass", || {
                receiver.inbox.ids().len() > seen || sender.spool.waiting() == 0
            })
            .await;
            proxy.cut();
        }
    }
    eventually("all arrive", || {
        let mut ids = receiver.inbox.ids();
        ids.sort();
        ids.dedup();
        ids.len() == total
    })
    .await;
    eventually("nothing is left", || {
        sender.spool.waiting() == 0 && broker.ready("factory.f1.ingress") == 0
    })
    .await;
    assert!(sender.handle.state().borrow().connects > 1);
    sender.stop().await;
    receiver.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stall_is_noticed_idle_and_busy() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    for is_busy in [false, true] {
        let proxy = Proxy::to(broker.port()).await;
        let link =
            TestLink::start_with(&proxy.url(), "f1", &[], AcceptedReports::Leave, |config| {
                config.limits.idle_timeout = Duration::from_secs(2);
                config.limits.outcome_timeout = Duration::from_secs(2);
            });
        link.up().await;
        proxy.stall(true);
        if is_busy {
            // More than the sockets' buffers take, so that the writer blocks.
            for n in 0..400 {
                link.send("factory.f1.ingress", envelope(format!("m{n}"), vec![b'x'; 100_000]));
            }
        }
        let state = link.handle.state();
        eventually("the stall is noticed", || {
            matches!(state.borrow().phase, LinkPhase::Down { .. })
        })
        .await;
        proxy.stall(false);
        link.up().await;
        if is_busy {
            eventually("everything is sent after all", || link.spool.waiting() == 0).await;
        }
        link.stop().await;
    }
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn after_an_outage_live_goes_first_and_the_backlog_is_marked() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let receiver = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    receiver.up().await;
    let proxy = Proxy::to(1).await;
    let sender =
        TestLink::start_with(&proxy.url(), "f1", &[], AcceptedReports::WaitForReceipt, |config| {
            config.brokers.push(broker.url().parse().expect("a url"));
            config.limits.backoff_min = Duration::from_millis(300);
        });
    // Written while the first address does not answer.
    for n in 1..=20 {
        sender.spool.push_report(address("factory.f1.ingress"), envelope(format!("m{n}"), "{}"), 7);
    }
    eventually("the backlog arrives over the second address", || receiver.inbox.ids().len() == 20)
        .await;
    let received = receiver.inbox.received.lock().clone();
    assert_eq!(receiver.inbox.ids()[0], "m20", "the newest first");
    assert!(!received[0].1.envelope.replay);
    assert!(received[1..].iter().all(|(_, d)| d.envelope.replay));
    let replayed: Vec<_> = receiver.inbox.ids()[1..].to_vec();
    assert_eq!(replayed, (1..=19).map(|n| format!("m{n}")).collect::<Vec<_>>());
    eventually("reports wait for their receipt", || sender.spool.sent() == 20).await;

    // The platform's receipt misses one.
    sender.spool.make_wait(&[RowId(5)]);
    sender.handle.rewind();
    eventually("it is sent again", || receiver.inbox.ids().last().is_some_and(|id| id == "m5"))
        .await;
    sender.stop().await;
    receiver.stop().await;
    broker.stop().await;
}
