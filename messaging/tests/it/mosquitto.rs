//! Mosquitto over MQTT 5, on TCP and in WebSockets, with a generated access control list.

use asi_model::MessageId;
use messaging::{
    BrokerProfile, Envelope, LinkPhase, RowId, Settlement,
    test_support::{Mosquitto, Saving, ServerCertificate},
};

use crate::support::{TestLink, address, eventually, plan};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_link_keeps_its_promises_over_mqtt() {
    let broker = Mosquitto::start(&plan(), Saving::Always).await;
    let url = broker.url();
    promises(broker, &url, None).await;
}

/// Side by side: Mosquitto looks after WebSockets ten times a second only.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_link_keeps_its_promises_over_mqtt_in_websockets() {
    let plain = async {
        let broker = Mosquitto::start(&plan(), Saving::Always).await;
        let url = format!("mqtt+ws://127.0.0.1:{}", broker.websocket_port());
        promises(broker, &url, None).await;
    };
    let encrypted = async {
        let certified =
            rcgen::generate_simple_self_signed(["localhost".to_owned()]).expect("a certificate");
        let (certificate, key) = (certified.cert.pem(), certified.signing_key.serialize_pem());
        let certificate = ServerCertificate { certificate: &certificate, key: &key };
        let broker = Mosquitto::start_with(&plan(), Saving::Always, Some(certificate)).await;
        let url = format!("mqtt+wss://localhost:{}/any/path", broker.websocket_port());
        promises(broker, &url, Some(certificate.certificate)).await;
    };
    tokio::join!(plain, encrypted);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_is_no_websocket_for_mqtt_is_told() {
    let broker = Mosquitto::start(&plan(), Saving::Always).await;
    let plain = broker.url().rsplit_once(':').expect("a port").1.to_owned();
    let link = TestLink::start(
        BrokerProfile::mqtt(),
        &format!("mqtt+ws://127.0.0.1:{plain}"),
        "f1",
        "secret of f1",
        &[],
    );
    // Mosquitto closes at once what is not MQTT; a broker that answered something else would be a
    // lasting fault.
    eventually("the fault is told", || link.reason().contains("broke off")).await;
    link.stop().await;
}

async fn promises(mut broker: Mosquitto, url: &str, root: Option<&str>) {
    let start = |user: &str, password: &str, consumed: &[&str]| {
        TestLink::start_trusting(root, BrokerProfile::mqtt(), url, user, password, consumed)
    };
    let platform = start("platform", "secret of platform", &["factory.f1.ingress"]);
    let factory = start("f1", "secret of f1", &["factory.f1.requests"]);

    // Both ways. What is sent before the other side ever subscribed waits in the spool, not
    // nowhere.
    let mut state = factory.handle.state();
    state.wait_for(messaging::LinkState::is_up).await.expect("the link runs");
    platform.send("factory.f1.requests", "request");
    eventually("the request arrives", || factory.inbox.ids() == ["request"]).await;
    platform.inbox.answer("poison", Settlement::reject("verbund:rubbish", "it is not JSON"));
    platform.inbox.answer("later", Settlement::Release);
    for id in ["poison", "later", "good"] {
        factory.send("factory.f1.ingress", id);
    }
    let count = |id: &str| platform.inbox.ids().iter().filter(|seen| *seen == id).count();
    eventually("the released one comes again", || count("later") >= 2 && count("good") >= 1).await;
    eventually("the spools are empty", || platform.spool.waiting() + factory.spool.waiting() == 0)
        .await;
    assert_eq!(count("poison"), 1);

    // What is sent under a lease says so on the other side.
    factory.send_under(7, "factory.f1.ingress", "leased");
    let is_leased = || {
        let received = platform.inbox.received.lock();
        received.iter().any(|(_, d)| {
            d.envelope.message_id == "leased".parse().ok() && d.envelope.lease == Some(7)
        })
    };
    eventually("it arrives with its mark", is_leased).await;

    // Another factory's topics are closed to it.
    let intruder = start("f2", "secret of f2", &["factory.f1.requests", "factory.f2.requests"]);
    intruder.send("factory.f1.ingress", "forged");
    eventually("it is refused", || intruder.reason().contains("amqp:unauthorized-access")).await;
    platform.send("factory.f1.requests", "second");
    eventually("the owner receives", || factory.inbox.ids().contains(&"second".to_owned())).await;
    assert!(intruder.inbox.ids().is_empty() && count("forged") == 0);
    intruder.stop().await;

    let stranger = start("f2", "wrong", &[]);
    let told = stranger.handle.state();
    eventually("a bad password is told", || {
        matches!(told.borrow().phase, LinkPhase::Down { is_permanent: true, .. })
    })
    .await;
    stranger.stop().await;

    // The broker keeps what comes for a connector that is away, and over its own restart.
    factory.stop().await;
    platform.send("factory.f1.requests", "while-away");
    eventually("the broker has it", || platform.spool.waiting() == 0).await;
    broker.restart().await;
    let factory = start("f1", "secret of f1", &["factory.f1.requests"]);
    eventually("it is delivered afterwards", || {
        factory.inbox.ids().contains(&"while-away".to_owned())
    })
    .await;

    // A backlog goes to the topic of its own.
    factory.spool.push_report(address("factory.f1.ingress"), crate::support::envelope("old"), 7);
    factory.spool.push_report(address("factory.f1.ingress"), crate::support::envelope("new"), 7);
    factory.spool.make_wait(&[RowId(1)]);
    factory.handle.rewind();
    factory.handle.wake();
    eventually("both arrive", || count("old") >= 1 && count("new") >= 1).await;

    // A message of many frames, and many at once.
    let large =
        Envelope::new(MessageId::new("large").expect("an id"), "test", vec![b'x'; 1_000_000]);
    factory.spool.push(address("factory.f1.ingress"), large);
    for n in 0..100 {
        factory.send("factory.f1.ingress", &format!("m{n}"));
    }
    eventually("all arrive", || {
        let ids: std::collections::HashSet<_> = platform.inbox.ids().into_iter().collect();
        ids.contains("large") && (0..100).all(|n| ids.contains(&format!("m{n}")))
    })
    .await;
    platform.stop().await;
    factory.stop().await;
}
