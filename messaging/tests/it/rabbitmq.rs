//! RabbitMQ 3.10 through its AMQP 1.0 plugin, with generated definitions. One broker for all checks,
//! because it starts slowly.

use std::time::Duration;

use messaging::{
    BrokerProfile, LinkPhase, LogicalAddress, Settlement,
    definitions::rabbitmq_definitions,
    test_support::{RabbitMq, ServerCertificate},
};

use crate::support::{Authority, TestLink, eventually, plan, signature};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_link_keeps_its_guarantees_on_rabbitmq() {
    let own = Authority::new("own");
    let certified =
        rcgen::generate_simple_self_signed(["localhost".to_owned()]).expect("a certificate");
    let (root, key) = (certified.cert.pem(), certified.signing_key.serialize_pem());
    let certificate = ServerCertificate {
        certificate: &root,
        key: &key,
        client_authority: Some(&own.certificate),
    };
    let definitions = rabbitmq_definitions(&plan(), "/", rand::random);
    let mut broker = RabbitMq::start_with(&definitions, Some(certificate)).await;
    check_certificates(&broker.tls_url(), &root, &own).await;
    let url = broker.url();
    let platform = start(&url, "platform", &["factory.f1.ingress", "dead-letters"]);
    let factory = start(&url, "f1", &["factory.f1.requests"]);
    check_settlements(&platform, &factory).await;
    check_leases(&url, &platform, &factory).await;
    check_access_control(&url, &platform, &factory).await;
    check_limits(&broker, &platform, &factory).await;
    check_kill(&mut broker, &platform, &factory).await;
    platform.stop().await;
    factory.stop().await;
}

fn start(url: &str, user: &str, consumed: &[&str]) -> TestLink {
    let password = format!("secret of {user}");
    TestLink::start(BrokerProfile::rabbitmq_3(), url, user, &password, consumed)
}

/// A link that shows a certificate of the broker's choice comes in; one with a password alone stays outside.
async fn check_certificates(url: &str, root: &str, authority: &Authority) {
    let start = |identity| {
        let profile = BrokerProfile::rabbitmq_3();
        TestLink::start_showing(identity, Some(root), profile, url, "f2", "secret of f2", &[])
    };
    let inside = start(Some(authority.identity("f2")));
    eventually("it comes in", || inside.handle.state().borrow().is_up()).await;
    inside.stop().await;
    let outside = start(None);
    eventually("it is kept out", || !outside.reason().is_empty()).await;
    assert!(!outside.handle.state().borrow().is_up(), "{}", outside.reason());
    outside.stop().await;
}

/// Sends in both directions, with every settlement.
async fn check_settlements(platform: &TestLink, factory: &TestLink) {
    platform.inbox.answer("poison", Settlement::reject("verbund:rubbish", "it is not JSON"));
    platform.inbox.answer("later", Settlement::Release);
    platform.send("factory.f1.requests", "request");
    for id in ["poison", "later", "good"] {
        factory.send("factory.f1.ingress", id);
    }
    eventually("the request arrives", || factory.inbox.ids() == ["request"]).await;
    eventually("the released one is delivered again", || {
        platform.deliveries_of("later") == 2 && platform.has_received("good")
    })
    .await;
    let is_dead = || {
        let received = platform.inbox.received.lock();
        received.iter().any(|(at, d)| {
            *at == LogicalAddress::DeadLetters && d.envelope.message_id == "poison".parse().ok()
        })
    };
    eventually("the rejected one is a dead letter", is_dead).await;
    eventually("the spools are empty", || platform.spool.waiting() + factory.spool.waiting() == 0)
        .await;
}

/// A second connector of the factory gets no requests while the first is connected, but the messages
/// about the lease. A message that is sent under a lease arrives with its number, and with
/// its signature.
async fn check_leases(url: &str, platform: &TestLink, factory: &TestLink) {
    let second = start(url, "f1", &["factory.f1.leases"]);
    let mut state = second.handle.state();
    state.wait_for(messaging::LinkState::is_up).await.expect("the link runs");
    platform.send("factory.f1.leases", "lease");
    eventually("the second one gets the lease", || second.inbox.ids() == ["lease"]).await;
    second.stop().await;
    factory.send_under(u64::MAX, "factory.f1.ingress", "leased");
    eventually("it arrives", || platform.has_received("leased")).await;
    assert_eq!(platform.lease_of("leased"), Some(Some(u64::MAX)));
    assert_eq!(platform.lease_of("good"), Some(None));
    assert_eq!(platform.signature_of("leased"), Some(signature()));
}

/// The addresses of one factory are closed to another one, which can still use its own.
async fn check_access_control(url: &str, platform: &TestLink, factory: &TestLink) {
    let intruder = start(url, "f2", &["factory.f1.requests"]);
    intruder.send("factory.f1.ingress", "forged");
    intruder.send("factory.f2.ingress", "mine");
    eventually("it is refused", || intruder.reason().contains("amqp:unauthorized-access")).await;
    eventually("its own message is sent", || intruder.spool.waiting() == 1).await;
    platform.send("factory.f1.requests", "second");
    eventually("the owner receives", || factory.has_received("second")).await;
    assert!(intruder.inbox.ids().is_empty() && !platform.has_received("forged"));
    intruder.stop().await;

    let stranger = TestLink::start(BrokerProfile::rabbitmq_3(), url, "f1", "wrong", &[]);
    let state = stranger.handle.state();
    eventually("a bad password is reported", || {
        matches!(state.borrow().phase, LinkPhase::Down { is_permanent: true, .. })
    })
    .await;
    stranger.stop().await;
}

/// A connection of an account beyond its limit is refused. Those that it has go on, and other accounts do not feel it.
async fn check_limits(broker: &RabbitMq, platform: &TestLink, factory: &TestLink) {
    const LIMIT: usize = 16;
    let url = broker.url();
    let is_up = |link: &TestLink| link.handle.state().borrow().is_up();
    let mut links = Vec::new();
    for _ in 0..LIMIT {
        links.push(start(&url, "f2", &["factory.f2.requests"]));
    }
    eventually("all are up", || links.iter().all(is_up)).await;
    // RabbitMQ counts them a moment later.
    tokio::time::sleep(Duration::from_secs(2)).await;
    assert!(!broker.has_said("connection limit"), "as many as are allowed");
    let one_more = start(&url, "f2", &["factory.f2.requests"]);
    let state = one_more.handle.state();
    eventually("one more is refused", || {
        broker.has_said("user connection limit (16) is reached")
            && matches!(state.borrow().phase, LinkPhase::Down { .. })
    })
    .await;
    assert!(links.iter().all(is_up), "the others go on");
    factory.send("factory.f1.ingress", "of-another-account");
    eventually("another account is served", || platform.has_received("of-another-account")).await;
    let third = start(&url, "f1", &["factory.f1.leases"]);
    platform.send("factory.f1.leases", "another-lease");
    eventually("and may connect", || third.has_received("another-lease")).await;
    for link in links.into_iter().chain([one_more, third]) {
        link.stop().await;
    }
}

/// A kill in the middle of 600 messages loses none.
async fn check_kill(broker: &mut RabbitMq, platform: &TestLink, factory: &TestLink) {
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
    eventually("no row waits", || factory.spool.waiting() == 0).await;
}
