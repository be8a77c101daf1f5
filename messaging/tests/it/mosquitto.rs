//! Mosquitto over MQTT 5, on TCP and in WebSockets, with a generated access control list.

use std::{collections::HashSet, time::Duration};

use asi_model::MessageId;
use messaging::{
    BrokerProfile, Envelope, LinkPhase, RowId, Settlement,
    test_support::{Mosquitto, Saving, ServerCertificate},
};
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};

use crate::support::{Authority, TestLink, address, envelope, eventually, plan, signature};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_link_keeps_its_guarantees_over_mqtt() {
    let broker = Mosquitto::start(&plan(), Saving::Always).await;
    let url = broker.url();
    check_guarantees(broker, &url, None).await;
}

/// Runs both at the same time: Mosquitto serves WebSockets only ten times a second.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_link_keeps_its_guarantees_over_mqtt_in_websockets() {
    let plain = async {
        let broker = Mosquitto::start(&plan(), Saving::Always).await;
        let url = format!("mqtt+ws://127.0.0.1:{}", broker.websocket_port());
        check_guarantees(broker, &url, None).await;
    };
    let encrypted = async {
        let certified =
            rcgen::generate_simple_self_signed(["localhost".to_owned()]).expect("a certificate");
        let (certificate, key) = (certified.cert.pem(), certified.signing_key.serialize_pem());
        let certificate =
            ServerCertificate { certificate: &certificate, key: &key, client_authority: None };
        let broker = Mosquitto::start_with(&plan(), Saving::Always, Some(certificate)).await;
        let url = format!("mqtt+wss://localhost:{}/any/path", broker.websocket_port());
        check_guarantees(broker, &url, Some(certificate.certificate)).await;
    };
    tokio::join!(plain, encrypted);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_port_without_mqtt_websockets_is_reported() {
    let broker = Mosquitto::start(&plan(), Saving::Always).await;
    let plain = broker.url().rsplit_once(':').expect("a port").1.to_owned();
    let link = TestLink::start(
        BrokerProfile::mqtt(),
        &format!("mqtt+ws://127.0.0.1:{plain}"),
        "f1",
        "secret of f1",
        &[],
    );
    // Mosquitto closes at once, which may pass. A broker with another answer would be a permanent
    // fault.
    eventually("the fault is reported", || link.reason().contains("broke off")).await;
    link.stop().await;
}

/// Its store is written at an orderly end alone: what it has when it is killed is lost.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_message_that_mosquitto_loses_in_a_crash_is_sent_again() {
    let mut broker = Mosquitto::start(&plan(), Saving::AtTheEnd).await;
    let url = broker.url();
    let platform = start(None, &url, "platform", &["factory.f1.ingress"]);
    let factory = start(None, &url, "f1", &[]);
    factory.send("factory.f1.ingress", "kept");
    eventually("it arrives", || platform.has_received("kept")).await;
    eventually("it counts as sent", || factory.spool.waiting() == 0).await;
    // Its session stays.
    platform.stop().await;
    let state = factory.handle.state();
    let before = state.borrow().last_accepted_at;
    factory.send("factory.f1.ingress", "lost");
    eventually("the broker accepts it", || state.borrow().last_accepted_at != before).await;
    broker.kill_and_restart().await;
    assert_eq!(factory.spool.waiting(), 1, "it does not count as sent yet");
    let platform = start(None, &url, "platform", &["factory.f1.ingress"]);
    eventually("it arrives after all", || platform.has_received("lost")).await;
    eventually("it counts as sent", || factory.spool.waiting() == 0).await;
    platform.stop().await;
    factory.stop().await;
}

/// A CONNECT of MQTT 5 by which a user gives itself a client id.
fn connect_as(client_id: &str, user: &str) -> Vec<u8> {
    let text = |text: &str| {
        let length = u16::try_from(text.len()).expect("short").to_be_bytes();
        [&length[..], text.as_bytes()].concat()
    };
    // Version 5; user, password and a clean start; a minute of keep-alive; no properties.
    let flags = vec![5, 0xC2, 0, 60, 0];
    let password = text(&format!("secret of {user}"));
    let rest = [text("MQTT"), flags, text(client_id), text(user), password].concat();
    let length = u8::try_from(rest.len()).expect("short");
    assert!(length < 128, "its length is one byte");
    [vec![0x10, length], rest].concat()
}

/// Connects as a factory under a client id of the platform; whether the platform's link had to connect again.
async fn ends_the_platforms_link(url: &str, platform: &TestLink) -> bool {
    let connects = || platform.handle.state().borrow().connects;
    let before = connects();
    let address = url.strip_prefix("mqtt://").expect("plain");
    let mut thief = tokio::net::TcpStream::connect(address).await.expect("connected");
    thief.write_all(&connect_as("platform:sender", "f1")).await.expect("sent");
    let mut answer = [0; 4];
    thief.read_exact(&mut answer).await.expect("an answer");
    assert_eq!((answer[0], answer[3]), (0x20, 0), "the broker takes it");
    // An end of the link shows within its pause.
    tokio::time::sleep(Duration::from_secs(3)).await;
    connects() > before
}

/// The session of a user's name and that of each address would be ended by any user who gives their ids as its own.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_factory_ends_no_link_of_others_on_a_listener_as_the_definitions_say() {
    let broker = Mosquitto::start(&plan(), Saving::AtTheEnd).await;
    let platform = start(None, &broker.url(), "platform", &["factory.f1.ingress"]);
    let mut state = platform.handle.state();
    state.wait_for(messaging::LinkState::is_up).await.expect("the link runs");
    assert!(!ends_the_platforms_link(&broker.url_of_accounts(), &platform).await);
    assert!(ends_the_platforms_link(&broker.url(), &platform).await, "as where all have one");
    platform.stop().await;
}

/// A broker that asks for certificates knows by them who may connect at all; who it is, is said by user name and password
/// as ever.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_broker_that_requires_certificates_is_shown_one() {
    let (own, stranger) = (Authority::new("own"), Authority::new("stranger"));
    let certified =
        rcgen::generate_simple_self_signed(["localhost".to_owned()]).expect("a certificate");
    let (root, key) = (certified.cert.pem(), certified.signing_key.serialize_pem());
    let certificate = ServerCertificate {
        certificate: &root,
        key: &key,
        client_authority: Some(&own.certificate),
    };
    let broker = Mosquitto::start_with(&plan(), Saving::Always, Some(certificate)).await;
    let url = broker.tls_url();
    let start = |identity, user: &str, consumed: &[&str]| {
        let password = format!("secret of {user}");
        let profile = BrokerProfile::mqtt();
        TestLink::start_showing(identity, Some(&root), profile, &url, user, &password, consumed)
    };
    let platform = start(Some(own.identity("platform")), "platform", &["factory.f1.ingress"]);
    let factory = start(Some(own.identity("f1")), "f1", &[]);
    factory.send("factory.f1.ingress", "shown");
    eventually("it arrives", || platform.has_received("shown")).await;
    factory.stop().await;
    for (who, identity) in [("nobody", None), ("stranger", Some(stranger.identity("f1")))] {
        let link = start(identity, "f1", &[]);
        link.send("factory.f1.ingress", who);
        // Its words are an alert of TLS, or those of a connection that broke off before it was read.
        eventually("it is kept out", || !link.reason().is_empty()).await;
        assert!(!link.handle.state().borrow().is_up(), "{who}: {}", link.reason());
        assert_eq!(link.spool.waiting(), 1, "{who}");
        link.stop().await;
    }
    assert_eq!(platform.inbox.ids(), ["shown"]);
    platform.stop().await;
}

/// The two sides of one broker.
struct Sides<'a> {
    url: &'a str,
    root: Option<&'a str>,
    platform: TestLink,
    factory: TestLink,
}

async fn check_guarantees(mut broker: Mosquitto, url: &str, root: Option<&str>) {
    let platform = start(root, url, "platform", &["factory.f1.ingress"]);
    let factory = start(root, url, "f1", &["factory.f1.requests"]);
    let mut sides = Sides { url, root, platform, factory };
    sides.check_both_directions().await;
    sides.check_access_control().await;

    // The broker stores messages for a connector that is away, also over its own restart.
    sides.factory.stop().await;
    sides.platform.send("factory.f1.requests", "while-away");
    eventually("the broker has it", || sides.platform.spool.waiting() == 0).await;
    broker.restart().await;
    sides.factory = start(root, url, "f1", &["factory.f1.requests"]);
    eventually("it is delivered afterwards", || sides.factory.has_received("while-away")).await;

    sides.check_backlog_and_size().await;
    sides.platform.stop().await;
    sides.factory.stop().await;
}

fn start(root: Option<&str>, url: &str, user: &str, consumed: &[&str]) -> TestLink {
    let password = format!("secret of {user}");
    TestLink::start_trusting(root, BrokerProfile::mqtt(), url, user, &password, consumed)
}

impl Sides<'_> {
    async fn check_both_directions(&self) {
        let Self { platform, factory, .. } = self;
        // A message that is sent before the other side ever subscribed stays in the spool.
        let mut state = factory.handle.state();
        state.wait_for(messaging::LinkState::is_up).await.expect("the link runs");
        platform.send("factory.f1.requests", "request");
        eventually("the request arrives", || factory.inbox.ids() == ["request"]).await;
        platform.inbox.answer("poison", Settlement::reject("verbund:rubbish", "it is not JSON"));
        platform.inbox.answer("later", Settlement::Release);
        for id in ["poison", "later", "good"] {
            factory.send("factory.f1.ingress", id);
        }
        eventually("the released one is delivered again", || {
            platform.deliveries_of("later") >= 2 && platform.has_received("good")
        })
        .await;
        eventually("the spools are empty", || {
            platform.spool.waiting() + factory.spool.waiting() == 0
        })
        .await;
        assert_eq!(platform.deliveries_of("poison"), 1);
        // A message that is sent under a lease arrives with its number.
        factory.send_under(7, "factory.f1.ingress", "leased");
        eventually("the lease arrives", || platform.lease_of("leased") == Some(Some(7))).await;
        assert_eq!(platform.signature_of("leased"), Some(signature()));
    }

    async fn check_access_control(&self) {
        let Self { platform, factory, .. } = self;
        let foreign = ["factory.f1.requests", "factory.f2.requests"];
        let intruder = start(self.root, self.url, "f2", &foreign);
        intruder.send("factory.f1.ingress", "forged");
        eventually("it is refused", || intruder.reason().contains("amqp:unauthorized-access"))
            .await;
        platform.send("factory.f1.requests", "second");
        eventually("the owner receives", || factory.has_received("second")).await;
        assert!(intruder.inbox.ids().is_empty() && !platform.has_received("forged"));
        intruder.stop().await;

        let profile = BrokerProfile::mqtt();
        let stranger = TestLink::start_trusting(self.root, profile, self.url, "f2", "wrong", &[]);
        let state = stranger.handle.state();
        eventually("a bad password is reported", || {
            matches!(state.borrow().phase, LinkPhase::Down { is_permanent: true, .. })
        })
        .await;
        stranger.stop().await;
    }

    async fn check_backlog_and_size(&self) {
        let Self { platform, factory, .. } = self;
        let ingress = || address("factory.f1.ingress");
        // A backlog goes to the replay topic.
        factory.spool.push_report(ingress(), envelope("old"), 7);
        factory.spool.push_report(ingress(), envelope("new"), 7);
        factory.spool.make_wait(&[RowId(1)]);
        factory.handle.rewind();
        factory.handle.wake();
        eventually("both arrive", || platform.has_received("old") && platform.has_received("new"))
            .await;

        // A message of many frames, and many at once.
        let large =
            Envelope::new(MessageId::new("large").expect("an id"), "test", vec![b'x'; 1_000_000]);
        factory.spool.push(ingress(), large);
        for n in 0..100 {
            factory.send("factory.f1.ingress", &format!("m{n}"));
        }
        eventually("all arrive", || {
            let ids: HashSet<_> = platform.inbox.ids().into_iter().collect();
            ids.contains("large") && (0..100).all(|n| ids.contains(&format!("m{n}")))
        })
        .await;
    }
}
