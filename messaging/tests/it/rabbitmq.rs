//! RabbitMQ 3.10 through its AMQP 1.0 plugin, with generated definitions. One broker for all, for it starts slowly.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use asi_model::MessageId;
use messaging::{
    BrokerProfile, Envelope, Link, LinkConfig, LinkHandle, LinkPhase, LogicalAddress, Login, Settlement,
    definitions::{Account, Plan, QueueLimits, rabbitmq_definitions},
    spool::memory::{AcceptedReports, MemorySpool},
    test_support::RecordingInbox,
};
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

use crate::rabbitmq_process::RabbitMq;

struct TestLink {
    handle: LinkHandle,
    spool: Arc<MemorySpool>,
    inbox: Arc<RecordingInbox>,
    stop: CancellationToken,
    running: JoinHandle<()>,
}

impl TestLink {
    fn start(url: &str, user: &str, password: &str, consumed: &[&str]) -> Self {
        let mut config = LinkConfig::new(url.parse().expect("a url"), Login::new(user, password), user);
        config.profile = BrokerProfile::rabbitmq_3();
        config.consumed = consumed.iter().map(|a| address(a)).collect();
        config.limits.backoff_min = Duration::from_millis(100);
        config.limits.backoff_max = Duration::from_secs(1);
        config.limits.address_rest = Duration::from_millis(300);
        let spool = Arc::new(MemorySpool::new(AcceptedReports::Leave));
        let inbox = Arc::new(RecordingInbox::default());
        let (store, receiver): (Arc<MemorySpool>, Arc<RecordingInbox>) = (Arc::clone(&spool), Arc::clone(&inbox));
        let (link, handle) = Link::new(config, store, receiver).expect("a link");
        let stop = CancellationToken::new();
        let running = tokio::spawn(link.run(stop.clone()));
        Self { handle, spool, inbox, stop, running }
    }

    fn send(&self, to: &str, id: &str) {
        self.spool.push(address(to), Envelope::new(MessageId::new(id).expect("an id"), "test", "{}"));
        self.handle.wake();
    }

    fn reason(&self) -> String {
        self.handle.state().borrow().reason.clone().unwrap_or_default()
    }

    async fn stop(self) {
        self.stop.cancel();
        self.running.await.expect("the link ends");
    }
}

fn address(text: &str) -> LogicalAddress {
    text.parse().expect("an address")
}

async fn eventually(what: &str, mut holds: impl FnMut() -> bool) {
    let deadline = Instant::now() + Duration::from_secs(60);
    while !holds() {
        assert!(Instant::now() < deadline, "not in time: {what}");
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
}

fn plan() -> Plan {
    let account = |name: &str| Account { user_name: name.to_owned(), password: format!("secret of {name}").into() };
    Plan {
        platform: account("platform"),
        factories: ["f1", "f2"].map(|id| (id.parse().expect("an id"), account(id))).to_vec(),
        tools: Vec::new(),
        limits: QueueLimits::default(),
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_link_keeps_its_promises_on_rabbitmq() {
    let mut broker = RabbitMq::start(&rabbitmq_definitions(&plan(), "/", rand::random)).await;
    let url = broker.url();
    let platform = TestLink::start(&url, "platform", "secret of platform", &["factory.f1.ingress", "dead-letters"]);
    let factory = TestLink::start(&url, "f1", "secret of f1", &["factory.f1.requests"]);
    platform.inbox.answer("poison", Settlement::reject("verbund:rubbish", "it is not JSON"));
    platform.inbox.answer("later", Settlement::Release);

    // Both ways, with every answer.
    platform.send("factory.f1.requests", "request");
    for id in ["poison", "later", "good"] {
        factory.send("factory.f1.ingress", id);
    }
    eventually("the request arrives", || factory.inbox.ids() == ["request"]).await;
    let count = |id: &str| platform.inbox.ids().iter().filter(|seen| *seen == id).count();
    eventually("the released one comes again", || count("later") == 2 && count("good") >= 1).await;
    let is_dead = || {
        let received = platform.inbox.received.lock();
        received
            .iter()
            .any(|(at, d)| *at == LogicalAddress::DeadLetters && d.envelope.message_id == "poison".parse().ok())
    };
    eventually("the rejected one is a dead letter", is_dead).await;
    eventually("the spools are empty", || platform.spool.waiting() + factory.spool.waiting() == 0).await;

    // Another factory's addresses are closed to it, and that hinders nothing else.
    let intruder = TestLink::start(&url, "f2", "secret of f2", &["factory.f1.requests"]);
    intruder.send("factory.f1.ingress", "forged");
    intruder.send("factory.f2.ingress", "mine");
    eventually("it is refused", || intruder.reason().contains("amqp:unauthorized-access")).await;
    eventually("its own message goes", || intruder.spool.waiting() == 1).await;
    platform.send("factory.f1.requests", "second");
    eventually("the owner receives", || factory.inbox.ids().contains(&"second".to_owned())).await;
    assert!(intruder.inbox.ids().is_empty() && count("forged") == 0);
    intruder.stop().await;

    let stranger = TestLink::start(&url, "f1", "wrong", &[]);
    let state = stranger.handle.state();
    eventually("a bad password is told", || matches!(state.borrow().phase, LinkPhase::Down { is_permanent: true, .. }))
        .await;
    stranger.stop().await;

    // A kill in the middle loses nothing.
    for n in 0..500 {
        factory.send("factory.f1.ingress", &format!("m{n}"));
    }
    eventually("some arrive", || platform.inbox.ids().len() > 50).await;
    broker.kill_and_restart().await;
    for n in 500..600 {
        factory.send("factory.f1.ingress", &format!("m{n}"));
    }
    eventually("all arrive", || {
        let mut ids: Vec<_> = platform.inbox.ids().into_iter().filter(|id| id.starts_with('m')).collect();
        ids.sort();
        ids.dedup();
        ids.len() == 600
    })
    .await;
    eventually("nothing waits", || factory.spool.waiting() == 0).await;
    platform.stop().await;
    factory.stop().await;
}
