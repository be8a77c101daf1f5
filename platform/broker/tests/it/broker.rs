//! Guarantees of the broker to any client.

use std::time::Duration;

use broker::{BrokerUser, QueueOptions};
use messaging::{LinkPhase, Settlement, spool::memory::AcceptedReports};

use crate::support::{SECRET, TestBroker, TestLink, envelope, eventually, pattern, queue};

/// Patience with a search that comes every few seconds.
const WAIT: Duration = Duration::from_secs(20);

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn consumers_compete_and_leave_what_they_did_not_settle() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let sender = TestLink::start(&broker.url(), "f1", &[]);
    let slow = TestLink::start_with(
        &broker.url(),
        "platform",
        &["factory.f1.ingress"],
        AcceptedReports::Leave,
        |config| {
            config.limits.credit = 10;
        },
    );
    slow.up().await;
    *slow.inbox.delay.lock() = Duration::from_millis(300);
    for n in 0..100 {
        sender.send("factory.f1.ingress", envelope(format!("m{n}"), "{}"));
    }
    let quick = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    eventually("both together get all", || {
        let mut ids = slow.inbox.ids();
        ids.extend(quick.inbox.ids());
        ids.sort();
        ids.dedup();
        ids.len() == 100
    })
    .await;
    assert!(!quick.inbox.ids().is_empty());
    slow.stop().await;
    eventually("the queue is empty", || {
        broker
            .handle
            .queue(&queue("factory.f1.ingress"))
            .is_some_and(|q| q.ready + q.unsettled == 0)
    })
    .await;
    quick.stop().await;
    sender.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_single_active_consumer_hands_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let options = QueueOptions { is_single_active_consumer: true, ..QueueOptions::default() };
    broker.handle.declare_queue(&queue("factory.f1.ingress"), options).await.expect("declared");
    let first = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    let consumers =
        |n| broker.handle.queue(&queue("factory.f1.ingress")).is_some_and(|q| q.consumers == n);
    eventually("the first consumes", || consumers(1)).await;
    let second = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    eventually("the second waits", || consumers(2)).await;
    let sender = TestLink::start(&broker.url(), "f1", &[]);
    for n in 0..50 {
        sender.send("factory.f1.ingress", envelope(format!("m{n}"), "{}"));
    }
    eventually("the first gets all", || first.inbox.ids().len() == 50).await;
    assert!(second.inbox.ids().is_empty());
    // What the first had not settled when it ended would come again.
    eventually("the first has settled all", || {
        let status = broker.handle.queue(&queue("factory.f1.ingress"));
        status.is_some_and(|q| q.ready + q.unsettled == 0)
    })
    .await;
    first.stop().await;
    sender.send("factory.f1.ingress", envelope("next", "{}"));
    eventually("the second takes over", || second.inbox.ids() == ["next"]).await;
    second.stop().await;
    sender.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_full_queue_refuses_until_there_is_room() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let options = QueueOptions { messages_max: 10, ..QueueOptions::default() };
    broker.handle.declare_queue(&queue("factory.f1.ingress"), options).await.expect("declared");
    let sender = TestLink::start(&broker.url(), "f1", &[]);
    for n in 0..25 {
        sender.send("factory.f1.ingress", envelope(format!("m{n:02}"), "{}"));
    }
    eventually("the queue fills", || broker.ready("factory.f1.ingress") == 10).await;
    eventually("the link tells why", || sender.reason().contains("amqp:resource-limit-exceeded"))
        .await;
    assert!(sender.spool.parked().is_empty());
    let receiver = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    eventually("all arrive", || receiver.inbox.ids().len() == 25).await;
    // A place that becomes free between two refusals goes to no message behind a refused one.
    let sent: Vec<_> = (0..25).map(|n| format!("m{n:02}")).collect();
    assert_eq!(receiver.inbox.ids(), sent, "each once, in order");
    eventually("no obstacle is left", || sender.reason().is_empty()).await;
    sender.stop().await;
    receiver.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_nobody_fetches_in_time_expires() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let sender = TestLink::start(&broker.url(), "f1", &[]);
    let mut short = envelope("short", "{}");
    short.creation_time = Some(time::OffsetDateTime::now_utc());
    short.ttl = Some(Duration::from_millis(400));
    sender.send("factory.f1.ingress", short);
    sender.send("factory.f1.ingress", envelope("long", "{}"));
    eventually("both are stored", || sender.spool.waiting() == 0).await;
    eventually("the sweep removes one", || broker.ready("factory.f1.ingress") == 1).await;
    let receiver = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    eventually("the other arrives", || receiver.inbox.ids() == ["long"]).await;
    receiver.stop().await;
    sender.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_revoked_user_is_cut_and_stays_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let link = TestLink::start(&broker.url(), "f1", &["factory.f1.requests"]);
    link.up().await;
    eventually("it is listed", || broker.handle.connections().iter().any(|c| c.user_name == "f1"))
        .await;
    broker.users.remove("f1");
    assert_eq!(broker.handle.disconnect_user("f1"), 1);
    let state = link.handle.state();
    eventually("it is refused for good", || {
        matches!(state.borrow().phase, LinkPhase::Down { is_permanent: true, .. })
    })
    .await;
    assert!(broker.handle.connections().is_empty());
    link.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_user_has_a_bounded_number_of_connections() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker =
        TestBroker::start_with(folder.path(), |config| config.limits.connections_per_user_max = 1)
            .await;
    let first = TestLink::start(&broker.url(), "f1", &[]);
    first.up().await;
    let second = TestLink::start(&broker.url(), "f1", &[]);
    eventually("the second is told", || second.reason().contains("too many connections")).await;
    second.stop().await;
    first.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_user_and_its_organisation_have_a_bounded_number_of_links_and_others_do_not_feel_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start_with(folder.path(), |config| {
        config.limits.links_per_user_max = 2;
        config.limits.links_per_organisation_max = 3;
        config.auto_created = vec![pattern("tool.*.reports")];
    })
    .await;
    for (name, organisation) in [("one", "a"), ("two", "a"), ("three", "b")] {
        let user = BrokerUser::with_secret(SECRET.as_bytes());
        let user = user.may_consume(pattern("tool.*.reports")).of_organisation(organisation);
        broker.users.put(name, user);
    }
    let consumers = |tool: &str| {
        broker.handle.queue(&queue(&format!("tool.{tool}.reports"))).map_or(0, |q| q.consumers)
    };
    let first = TestLink::start(&broker.url(), "one", &["tool.t1.reports"]);
    let second = TestLink::start(&broker.url(), "one", &["tool.t2.reports"]);
    eventually("two links of a user", || consumers("t1") + consumers("t2") == 2).await;
    let third = TestLink::start(&broker.url(), "one", &["tool.t3.reports"]);
    let condition = "amqp:resource-limit-exceeded";
    eventually("the third is refused", || third.reason().contains(condition)).await;
    third.stop().await;
    let of_other = TestLink::start(&broker.url(), "two", &["tool.t4.reports"]);
    eventually("the organisation's last link", || consumers("t4") == 1).await;
    let beyond = TestLink::start(&broker.url(), "two", &["tool.t5.reports"]);
    eventually("the organisation has no more", || beyond.reason().contains(condition)).await;
    let other = TestLink::start(&broker.url(), "three", &["tool.t6.reports", "tool.t7.reports"]);
    eventually("another organisation", || consumers("t6") + consumers("t7") == 2).await;
    first.stop().await;
    eventually("a place that became free is taken", || consumers("t5") == 1).await;
    for link in [second, of_other, beyond, other] {
        link.stop().await;
    }
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_the_links_of_a_user_leave_unsettled_is_bounded_and_others_do_not_feel_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start_with(folder.path(), |config| {
        config.limits.unsettled_bytes_per_user_max = 2_500;
        config.auto_created = vec![pattern("tool.*.reports")];
    })
    .await;
    let sender = TestLink::start(&broker.url(), "platform", &[]);
    for tool in ["t1", "t2", "t3"] {
        broker.declare(&format!("tool.{tool}.reports")).await;
        for number in 0..10 {
            let message = envelope(format!("{tool}-{number}"), vec![b'x'; 1_000]);
            sender.send(&format!("tool.{tool}.reports"), message);
        }
    }
    let ready = |tool: &str| broker.ready(&format!("tool.{tool}.reports"));
    eventually("all wait", || ready("t1") + ready("t2") + ready("t3") == 30).await;
    for name in ["one", "two"] {
        let user = BrokerUser::with_secret(SECRET.as_bytes());
        broker.users.put(name, user.may_consume(pattern("tool.*.reports")));
    }
    let slow = [("one", "t1"), ("one", "t2"), ("two", "t3")].map(|(user, tool)| {
        let queue = format!("tool.{tool}.reports");
        let link = TestLink::start(&broker.url(), user, &[&queue]);
        *link.inbox.delay.lock() = Duration::from_secs(60);
        link
    });
    eventually("both users have some", || ready("t1") < 10 && ready("t2") < 10 && ready("t3") < 10)
        .await;
    tokio::time::sleep(Duration::from_millis(500)).await;
    let of_one = 20 - ready("t1") - ready("t2");
    assert!((2..=4).contains(&of_one), "{of_one} messages of 1 000 bytes over two links");
    let of_two = 10 - ready("t3");
    assert!((2..=4).contains(&of_two), "{of_two} messages");
    for link in slow.into_iter().chain([sender]) {
        link.stop().await;
    }
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_user_has_a_bounded_number_of_sessions_over_all_its_connections() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start_with(folder.path(), |config| {
        config.limits.sessions_per_user_max = 1;
    })
    .await;
    let first = TestLink::start(&broker.url(), "f1", &["factory.f1.requests"]);
    first.up().await;
    let second = TestLink::start(&broker.url(), "f1", &["factory.f1.requests"]);
    eventually("the second is told", || second.reason().contains("too many sessions")).await;
    broker.users.put("f2", BrokerUser::with_secret(SECRET.as_bytes()));
    let other = TestLink::start(&broker.url(), "f2", &[]);
    other.up().await;
    first.stop().await;
    second.up().await;
    for link in [second, other] {
        link.stop().await;
    }
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn each_queue_has_dead_letters_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start_with(folder.path(), |config| {
        config.limits.dead_letters_per_queue_max = 2;
    })
    .await;
    let consumed = ["factory.f1.requests", "factory.f2.requests"];
    let link = TestLink::start(&broker.url(), "platform", &consumed);
    link.up().await;
    for number in 0..10 {
        let id = format!("m{number}");
        link.inbox.answer(&id, Settlement::reject("unusable", "nobody can use it"));
        let to = if number == 0 { consumed[1] } else { consumed[0] };
        link.send(to, envelope(id, "{}"));
    }
    // The other queue's only one stays.
    let kept = testkit::wait::eventually("the oldest of one queue go", WAIT, || async {
        let letters = broker.handle.dead_letters(0, 100).await.expect("read");
        let mut ids: Vec<_> = letters.into_iter().filter_map(|letter| letter.message_id).collect();
        ids.sort();
        if ids == ["m0", "m8", "m9"] { Ok(()) } else { Err(format!("{ids:?}")) }
    });
    kept.await.expect("few are kept");
    broker.handle.delete_queue(&queue(consumed[0])).await.expect("deleted");
    let letters = broker.handle.dead_letters(0, 100).await.expect("read");
    let ids: Vec<_> = letters.into_iter().filter_map(|letter| letter.message_id).collect();
    assert_eq!(ids, ["m0"], "those of a queue that is deleted go with it");
    link.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn dead_letters_of_a_queue_have_a_bounded_number_of_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start_with(folder.path(), |config| {
        config.limits.dead_letter_bytes_per_queue_max = 25_000;
    })
    .await;
    let consumed = ["factory.f1.requests", "factory.f2.requests"];
    let link = TestLink::start(&broker.url(), "platform", &consumed);
    link.up().await;
    for number in 0..5 {
        let id = format!("m{number}");
        link.inbox.answer(&id, Settlement::reject("unusable", "x".repeat(5_000)));
        let to = if number == 0 { consumed[1] } else { consumed[0] };
        link.send(to, envelope(id, vec![b'x'; 10_000]));
    }
    let kept = testkit::wait::eventually("the oldest of one queue go", WAIT, || async {
        let letters = broker.handle.dead_letters(0, 100).await.expect("read");
        assert!(letters.iter().all(|letter| letter.reason.len() <= 1_000), "reasons are short");
        let mut ids: Vec<_> = letters.into_iter().filter_map(|letter| letter.message_id).collect();
        ids.sort();
        if ids == ["m0", "m3", "m4"] { Ok(()) } else { Err(format!("{ids:?}")) }
    });
    kept.await.expect("few bytes are kept");
    link.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_deleted_queue_ends_its_links_and_only_declared_names_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    broker.declare("tool.t1.reports").await;
    broker.users.put(
        "t1",
        BrokerUser::with_secret(SECRET.as_bytes()).may_consume(pattern("tool.t1.reports")),
    );
    let tool = TestLink::start(&broker.url(), "t1", &["tool.t1.reports"]);
    eventually("it consumes", || {
        broker.handle.queue(&queue("tool.t1.reports")).is_some_and(|q| q.consumers == 1)
    })
    .await;
    broker.handle.delete_queue(&queue("tool.t1.reports")).await.expect("deleted");
    eventually("the tool is told", || tool.reason().contains("amqp:")).await;
    eventually("the name is unknown", || tool.reason().contains("amqp:not-found")).await;
    tool.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_large_backlog_is_not_held_in_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let small_cache = |config: &mut broker::BrokerConfig| config.limits.cache_bytes_max = 50_000;
    let broker = TestBroker::start_with(folder.path(), small_cache).await;
    let sender = TestLink::start(&broker.url(), "f1", &[]);
    let body = vec![b'x'; 5000];
    for n in 0..500 {
        sender.send("factory.f1.ingress", envelope(format!("m{n}"), body.clone()));
    }
    eventually("all are stored", || sender.spool.waiting() == 0).await;
    let receiver = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    receiver.inbox.answer("m7", Settlement::Release);
    eventually("all arrive", || receiver.inbox.ids().len() == 501).await;
    assert!(receiver.inbox.received.lock().iter().all(|(_, d)| d.envelope.body == body));
    receiver.stop().await;
    sender.stop().await;
    broker.stop().await;
}
