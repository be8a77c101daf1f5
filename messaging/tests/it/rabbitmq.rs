//! RabbitMQ 3.10 through its AMQP 1.0 plugin, with generated definitions. One broker for all, for
//! it starts slowly.

use messaging::{
    BrokerProfile, LinkPhase, LogicalAddress, Settlement, definitions::rabbitmq_definitions,
    test_support::RabbitMq,
};

use crate::support::{TestLink, eventually, plan};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_link_keeps_its_promises_on_rabbitmq() {
    let mut broker = RabbitMq::start(&rabbitmq_definitions(&plan(), "/", rand::random)).await;
    let url = broker.url();
    let platform = TestLink::start(
        BrokerProfile::rabbitmq_3(),
        &url,
        "platform",
        "secret of platform",
        &["factory.f1.ingress", "dead-letters"],
    );
    let factory = TestLink::start(
        BrokerProfile::rabbitmq_3(),
        &url,
        "f1",
        "secret of f1",
        &["factory.f1.requests"],
    );
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
        received.iter().any(|(at, d)| {
            *at == LogicalAddress::DeadLetters && d.envelope.message_id == "poison".parse().ok()
        })
    };
    eventually("the rejected one is a dead letter", is_dead).await;
    eventually("the spools are empty", || platform.spool.waiting() + factory.spool.waiting() == 0)
        .await;

    // A second connector of the factory gets no requests while the first is there, but hears about
    // the lease; and what is sent under a lease says so on the other side.
    let leases = ["factory.f1.leases"];
    let second = TestLink::start(BrokerProfile::rabbitmq_3(), &url, "f1", "secret of f1", &leases);
    let mut state = second.handle.state();
    state.wait_for(messaging::LinkState::is_up).await.expect("the link runs");
    platform.send("factory.f1.leases", "lease");
    eventually("the second hears about the lease", || second.inbox.ids() == ["lease"]).await;
    second.stop().await;
    factory.send_under(u64::MAX, "factory.f1.ingress", "leased");
    let lease_of = |id: &str| {
        let received = platform.inbox.received.lock();
        received
            .iter()
            .find(|(_, d)| d.envelope.message_id == id.parse().ok())
            .map(|(_, d)| d.envelope.lease)
    };
    eventually("it arrives", || lease_of("leased").is_some()).await;
    assert_eq!((lease_of("leased"), lease_of("good")), (Some(Some(u64::MAX)), Some(None)));

    // Another factory's addresses are closed to it, and that hinders nothing else.
    let intruder = TestLink::start(
        BrokerProfile::rabbitmq_3(),
        &url,
        "f2",
        "secret of f2",
        &["factory.f1.requests"],
    );
    intruder.send("factory.f1.ingress", "forged");
    intruder.send("factory.f2.ingress", "mine");
    eventually("it is refused", || intruder.reason().contains("amqp:unauthorized-access")).await;
    eventually("its own message goes", || intruder.spool.waiting() == 1).await;
    platform.send("factory.f1.requests", "second");
    eventually("the owner receives", || factory.inbox.ids().contains(&"second".to_owned())).await;
    assert!(intruder.inbox.ids().is_empty() && count("forged") == 0);
    intruder.stop().await;

    let stranger = TestLink::start(BrokerProfile::rabbitmq_3(), &url, "f1", "wrong", &[]);
    let state = stranger.handle.state();
    eventually("a bad password is told", || {
        matches!(state.borrow().phase, LinkPhase::Down { is_permanent: true, .. })
    })
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
        let mut ids: Vec<_> =
            platform.inbox.ids().into_iter().filter(|id| id.starts_with('m')).collect();
        ids.sort();
        ids.dedup();
        ids.len() == 600
    })
    .await;
    eventually("nothing waits", || factory.spool.waiting() == 0).await;
    platform.stop().await;
    factory.stop().await;
}
