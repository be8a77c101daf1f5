//! Guarantees of the link against the embedded broker.

use std::{sync::atomic::Ordering, time::Duration};

use messaging::{
    BrokerProfile, HttpProxy, LinkPhase, Login, Roots, RowId, Settlement,
    spool::memory::AcceptedReports,
};

use crate::{
    proxy::{Proxy, http_proxy},
    support::{TestBroker, TestLink, address, certificate, envelope, eventually},
};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn messages_travel_both_ways_with_their_headers() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let platform = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    let factory = TestLink::start(&broker.url(), "f1", &["factory.f1.requests"]);

    let mut request = envelope("m1", r#"{"messageType":"comment"}"#);
    request.ttl = Some(Duration::from_secs(3600));
    request.creation_time = Some(time::OffsetDateTime::now_utc());
    request.correlation_id = Some("m0".parse().expect("an id"));
    request.lease = Some(u64::MAX);
    platform.send("factory.f1.requests", request.clone());
    factory.send("factory.f1.ingress", envelope("a1", "{}").compressed());

    eventually("both arrive", || factory.inbox.ids() == ["m1"] && platform.inbox.ids() == ["a1"])
        .await;
    let (at, delivery) = factory.inbox.received.lock()[0].clone();
    assert_eq!(at, address("factory.f1.requests"));
    assert_eq!(
        (delivery.envelope.message_id, delivery.envelope.correlation_id),
        (request.message_id, request.correlation_id)
    );
    assert_eq!((delivery.envelope.body, delivery.envelope.lease), (request.body, request.lease));
    assert!(!delivery.is_redelivered);
    assert!(delivery.envelope.ttl.is_some_and(|ttl| ttl > Duration::from_secs(3590)));

    eventually("the spools are empty", || platform.spool.waiting() + factory.spool.waiting() == 0)
        .await;
    let state = platform.handle.state().borrow().clone();
    assert!(
        state.last_accepted_at.is_some()
            && state.last_received_at.is_some()
            && state.reason.is_none()
    );
    assert_eq!(state.connects, 1);
    platform.stop().await;
    factory.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_wrong_password_is_reported_and_not_retried() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let proxy = Proxy::to(broker.port()).await;
    broker.users.remove("f1");
    let link = TestLink::start(&proxy.url(), "f1", &[]);
    let state = link.handle.state();
    eventually("the refusal is told", || {
        matches!(state.borrow().phase, LinkPhase::Down { is_permanent: true, .. })
    })
    .await;
    assert!(link.reason().contains("refused the user or password"), "{}", link.reason());
    assert_eq!(proxy.connections.load(Ordering::SeqCst), 1);

    // Mended, and reconnected on demand.
    broker.users.put("f1", broker::BrokerUser::with_secret(crate::support::SECRET.as_bytes()));
    link.handle.reconnect_now();
    link.up().await;
    link.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_refused_address_is_reported_and_the_others_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let link =
        TestLink::start(&broker.url(), "f1", &["factory.f2.requests", "factory.f1.requests"]);
    link.send("factory.f2.ingress", envelope("forged", "{}"));
    link.send("factory.f1.ingress", envelope("mine", "{}"));
    eventually("its own address works", || broker.ready("factory.f1.ingress") == 1).await;
    eventually("the refusal is told", || link.reason().contains("amqp:unauthorized-access")).await;
    assert!(link.handle.state().borrow().is_up());
    eventually("what was taken is let go", || link.spool.waiting() == 1).await;
    assert!(broker.handle.queue(&crate::support::queue("factory.f2.ingress")).is_none());

    let platform = TestLink::start(&broker.url(), "platform", &[]);
    platform.send("factory.f1.requests", envelope("r1", "{}"));
    eventually("its own requests arrive", || link.inbox.ids() == ["r1"]).await;
    assert_eq!(link.spool.waiting(), 1, "what is refused stays");
    platform.stop().await;
    link.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_oversize_message_is_set_aside_with_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker =
        TestBroker::start_with(folder.path(), |config| config.limits.message_bytes_max = 10_000)
            .await;
    let link = TestLink::start(&broker.url(), "f1", &[]);
    link.send("factory.f1.ingress", envelope("small", "{}"));
    link.send("factory.f1.ingress", envelope("large", vec![b'x'; 20_000]));
    link.send("factory.f1.ingress", envelope("next", "{}"));
    eventually("the others pass", || broker.ready("factory.f1.ingress") == 2).await;
    eventually("the large one is set aside", || link.spool.parked().len() == 1).await;
    let (row, rejection) = link.spool.parked().remove(0);
    assert_eq!((row, rejection.code.as_str()), (RowId(2), "amqp:link:message-size-exceeded"));
    assert!(rejection.reason.contains("10000"), "{}", rejection.reason);
    link.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn answers_of_the_inbox_are_honoured() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let receiver = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    receiver.inbox.answer("poison", Settlement::reject("verbund:rubbish", "it is not JSON"));
    receiver.inbox.answer("later", Settlement::Release);
    let sender = TestLink::start(&broker.url(), "f1", &[]);
    for id in ["poison", "later", "good"] {
        sender.send("factory.f1.ingress", envelope(id, "{}"));
    }
    eventually("the released one comes again", || {
        receiver.inbox.ids().iter().filter(|id| *id == "later").count() == 2
    })
    .await;
    assert!(receiver.inbox.received.lock().iter().any(|(_, d)| d.is_redelivered));
    eventually("the rejected one is a dead letter", || broker.ready("dead-letters") == 1).await;
    let letters = broker.handle.dead_letters(0, 10).await.expect("dead letters");
    assert_eq!(
        (letters[0].code.as_str(), letters[0].reason.as_str()),
        ("verbund:rubbish", "it is not JSON")
    );
    assert_eq!(
        (letters[0].message_id.as_deref(), letters[0].principal.as_deref()),
        (Some("poison"), Some("f1"))
    );
    assert_eq!(letters[0].queue.as_str(), "factory.f1.ingress");
    assert_eq!(
        broker.handle.dead_letter_body(letters[0].id).await.expect("read").as_deref(),
        Some(b"{}".as_slice())
    );
    assert_eq!(broker.handle.replay_dead_letters(&[letters[0].id]).await.expect("replayed"), 1);
    eventually("the replayed one comes again", || {
        receiver.inbox.ids().iter().filter(|id| *id == "poison").count() == 2
    })
    .await;
    eventually("nothing is left", || {
        broker.ready("dead-letters") + broker.ready("factory.f1.ingress") == 0
    })
    .await;
    assert!(broker.handle.dead_letters(0, 10).await.expect("dead letters").is_empty());
    sender.stop().await;
    receiver.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn tls_is_checked_against_the_configured_roots() {
    let folder = tempfile::tempdir().expect("a folder");
    let (identity, root) = certificate();
    let (_, stranger) = certificate();
    let broker =
        TestBroker::start_with(folder.path(), |config| config.listeners[0].tls = Some(identity))
            .await;
    let url = format!("amqps://localhost:{}", broker.port());
    let trusting = TestLink::start_with(&url, "f1", &[], AcceptedReports::Leave, |config| {
        config.tls.roots = Roots::Pem(root);
        config.profile = BrokerProfile::embedded();
    });
    trusting.send("factory.f1.ingress", envelope("m1", "{}"));
    eventually("it arrives", || broker.ready("factory.f1.ingress") == 1).await;

    let wary = TestLink::start_with(&url, "f1", &[], AcceptedReports::Leave, |config| {
        config.tls.roots = Roots::Pem(stranger);
    });
    let state = wary.handle.state();
    eventually("the distrust is told", || {
        matches!(state.borrow().phase, LinkPhase::Down { is_permanent: true, .. })
    })
    .await;
    assert!(wary.reason().contains("certificate"), "{}", wary.reason());
    wary.stop().await;
    trusting.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn addresses_come_and_go_while_the_link_is_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let link = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    for name in ["factory.f1.ingress", "factory.f2.ingress"] {
        link.send(name, envelope(name, "{}"));
    }
    eventually("the first arrives", || link.inbox.ids() == ["factory.f1.ingress"]).await;
    link.handle.set_consumed(vec![address("factory.f1.ingress"), address("factory.f2.ingress")]);
    eventually("the second arrives", || link.inbox.ids().len() == 2).await;
    link.handle.set_consumed(vec![address("factory.f2.ingress")]);
    eventually("the first has no consumer", || {
        broker
            .handle
            .queue(&crate::support::queue("factory.f1.ingress"))
            .is_some_and(|q| q.consumers == 0)
    })
    .await;
    assert_eq!(link.handle.state().borrow().connects, 1);
    link.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_volatile_message_is_not_stored_and_a_backoff_leaves_the_broker() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let platform = TestLink::start(&broker.url(), "platform", &["factory.f1.ingress"]);
    let factory = TestLink::start(&broker.url(), "f1", &["factory.f1.requests"]);
    let send = |id: &str| {
        factory.handle.send_volatile(address("factory.f1.ingress"), envelope(id, "{}"));
    };
    send("before-all-others");
    eventually("the message arrives", || platform.inbox.ids() == ["before-all-others"]).await;
    assert_eq!(factory.spool.waiting(), 0, "it was never in the spool");

    factory.handle.back_off("another one is to have it", Duration::from_secs(3600));
    let mut state = factory.handle.state();
    let backing_off = state
        .wait_for(|state| matches!(state.phase, LinkPhase::Down { .. }))
        .await
        .expect("it runs")
        .clone();
    assert!(matches!(backing_off.phase, LinkPhase::Down { is_permanent: true, .. }));
    assert_eq!(backing_off.reason.as_deref(), Some("another one is to have it"));
    platform.send("factory.f1.requests", envelope("r1", "{}"));
    eventually("it waits at the broker", || broker.ready("factory.f1.requests") == 1).await;
    factory.handle.reconnect_now();
    eventually("it is received after the back-off", || factory.inbox.ids() == ["r1"]).await;
    send("after-the-backoff");
    eventually("the next message arrives", || platform.inbox.ids().len() == 2).await;
    assert_eq!(factory.handle.state().borrow().connects, 2);
    platform.stop().await;
    factory.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_proxy_with_credentials_is_passed() {
    let folder = tempfile::tempdir().expect("a folder");
    let (identity, root) = certificate();
    let broker =
        TestBroker::start_with(folder.path(), |config| config.listeners[0].tls = Some(identity))
            .await;
    let proxy = format!("http://{}", http_proxy().await);
    let url = format!("amqps://localhost:{}", broker.port());
    let start = |password: &str| {
        let login = Login::new("plant", password);
        TestLink::start_with(&url, "f1", &[], AcceptedReports::Leave, |config| {
            config.tls.roots = Roots::Pem(root.clone());
            config.proxy = Some(HttpProxy::new(&proxy, Some(login)).expect("a proxy"));
        })
    };
    let link = start("gate");
    link.send("factory.f1.ingress", envelope("m1", "{}"));
    eventually("it arrives", || broker.ready("factory.f1.ingress") == 1).await;
    let stranger = start("wrong");
    let state = stranger.handle.state();
    eventually("the refusal is told", || {
        matches!(state.borrow().phase, LinkPhase::Down { is_permanent: true, .. })
    })
    .await;
    assert!(stranger.reason().contains("proxy"), "{}", stranger.reason());
    stranger.stop().await;
    link.stop().await;
    broker.stop().await;
}
