//! AMQP in WebSockets: the link's promises, and peers that promise nothing.

use std::{
    path::Path,
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

use messaging::{HttpProxy, LinkPhase, Login, Roots, spool::memory::AcceptedReports};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
};

use crate::{
    proxy::{Proxy, http_proxy},
    support::{TestBroker, TestLink, certificate, envelope, eventually, with_websockets},
};

async fn plain_broker(folder: &Path) -> TestBroker {
    TestBroker::start_with(folder, |config| {
        config.limits.handshake_timeout = Duration::from_millis(500);
        with_websockets(config);
    })
    .await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_link_goes_through_an_encrypted_websocket_and_a_proxy_with_credentials() {
    let folder = tempfile::tempdir().expect("a folder");
    let (identity, root) = certificate();
    let broker = TestBroker::start_with(folder.path(), |config| {
        config.listeners[0].tls = Some(identity);
        with_websockets(config);
    })
    .await;
    let proxy = format!("http://{}", http_proxy().await);
    let url = format!("amqp+wss://localhost:{}/any/path", broker.websocket_port());
    let start = |user: &str, password: &str, consumed: &[&str]| {
        let login = Login::new("plant", password);
        TestLink::start_with(&url, user, consumed, AcceptedReports::Leave, |config| {
            config.tls.roots = Roots::Pem(root.clone());
            config.proxy = Some(HttpProxy::new(&proxy, Some(login)).expect("a proxy"));
        })
    };
    let platform = start("platform", "gate", &["factory.f1.ingress"]);
    let factory = start("f1", "gate", &["factory.f1.requests"]);
    platform.send("factory.f1.requests", envelope("r1", "{}"));
    // Of many frames, and many at once.
    factory.send("factory.f1.ingress", envelope("large", vec![b'x'; 1_500_000]));
    for n in 0..500 {
        factory.send("factory.f1.ingress", envelope(format!("m{n}"), "{}"));
    }
    eventually("all arrive", || factory.inbox.ids() == ["r1"] && platform.inbox.ids().len() == 501)
        .await;
    let large = platform.inbox.received.lock().iter().map(|(_, d)| d.envelope.body.len()).max();
    assert_eq!(large, Some(1_500_000));

    let stranger = start("f1", "wrong", &[]);
    let state = stranger.handle.state();
    eventually("the refusal is told", || {
        matches!(state.borrow().phase, LinkPhase::Down { is_permanent: true, .. })
    })
    .await;
    assert!(stranger.reason().contains("proxy"), "{}", stranger.reason());
    for link in [stranger, factory, platform] {
        link.stop().await;
    }
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn cuts_and_stalls_of_a_websocket_are_noticed_and_lose_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = plain_broker(folder.path()).await;
    let proxy = Proxy::to(broker.websocket_port()).await;
    let url = format!("amqp+ws://{}", proxy.address);
    let start = |user: &str, consumed: &[&str]| {
        TestLink::start_with(&url, user, consumed, AcceptedReports::Leave, |config| {
            config.limits.idle_timeout = Duration::from_secs(2);
            config.limits.outcome_timeout = Duration::from_secs(2);
        })
    };
    let (sender, receiver) = (start("f1", &[]), start("platform", &["factory.f1.ingress"]));
    let distinct = || {
        let mut ids = receiver.inbox.ids();
        ids.sort();
        ids.dedup();
        ids.len()
    };
    for round in 0..3 {
        for n in 0..500 {
            sender.send("factory.f1.ingress", envelope(format!("m{round}.{n}"), vec![b'x'; 2000]));
        }
        let seen = distinct();
        eventually("some more pass", || distinct() > seen || sender.spool.waiting() == 0).await;
        if round < 2 {
            proxy.cut();
        } else {
            let state = sender.handle.state();
            proxy.stall(true);
            eventually("the stall is noticed", || {
                matches!(state.borrow().phase, LinkPhase::Down { .. })
            })
            .await;
            proxy.stall(false);
        }
    }
    eventually("all arrive", || distinct() == 1500).await;
    eventually("nothing is left", || {
        sender.spool.waiting() == 0 && broker.ready("factory.f1.ingress") == 0
    })
    .await;
    assert!(proxy.connections.load(Ordering::SeqCst) > 2);
    sender.stop().await;
    receiver.stop().await;
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_wrong_port_is_reported_with_the_remedy() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = plain_broker(folder.path()).await;
    let permanent = |link: &TestLink| {
        matches!(link.handle.state().borrow().phase, LinkPhase::Down { is_permanent: true, .. })
    };
    let link = TestLink::start(&format!("amqp+ws://127.0.0.1:{}", broker.port()), "f1", &[]);
    eventually("a WebSocket where there is none", || permanent(&link)).await;
    assert!(link.reason().contains("is the port right?"), "{}", link.reason());
    link.stop().await;

    let link =
        TestLink::start(&format!("mqtt+ws://127.0.0.1:{}", broker.websocket_port()), "f1", &[]);
    eventually("another subprotocol", || permanent(&link)).await;
    assert!(link.reason().contains("answered 400"), "{}", link.reason());
    link.stop().await;

    let link =
        TestLink::start(&format!("amqp+ws://127.0.0.1:{}", broker.websocket_port()), "f1", &[]);
    link.up().await;
    link.stop().await;
    broker.stop().await;
}

/// Sends these bytes to a broker; returns its answer until it closes, and the time. The frame follows
/// once a WebSocket is open.
async fn exchange(port: u16, request: &[u8], frame: &[u8]) -> (Vec<u8>, Duration) {
    let begun = Instant::now();
    let mut tcp = TcpStream::connect(("127.0.0.1", port)).await.expect("connected");
    let mut answer = Vec::new();
    // A reset is an end, too.
    let _ = tcp.write_all(request).await;
    while !frame.is_empty() && !answer.ends_with(b"\r\n\r\n") {
        let Ok(byte) = tcp.read_u8().await else { return (answer, begun.elapsed()) };
        answer.push(byte);
    }
    let _ = tcp.write_all(frame).await;
    let _ = tcp.read_to_end(&mut answer).await;
    (answer, begun.elapsed())
}

fn asking(line: &str) -> Vec<u8> {
    format!(
        "GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{line}\r\n"
    )
    .into_bytes()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn peers_that_promise_nothing_are_sent_away_and_leave_room_for_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start_with(folder.path(), |config| {
        config.limits.handshake_timeout = Duration::from_millis(500);
        config.limits.connections_max = 1;
        with_websockets(config);
    })
    .await;
    let port = broker.websocket_port();
    let close = |code: u16| [&[0x88, 2][..], &code.to_be_bytes()].concat();
    let (opened, amqp) = ("HTTP/1.1 101", asking("Sec-WebSocket-Protocol: amqp\r\n"));
    let text = [0x81, 0x84, 0, 0, 0, 0, b'A', b'M', b'Q', b'P'];
    let gigabytes = [0x82, 0xFF, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0];
    for (what, request, frame, begins, ends, is_waited_for) in [
        ("no subprotocol", asking(""), &[][..], "HTTP/1.1 400", Vec::new(), false),
        (
            "another subprotocol",
            asking("Sec-WebSocket-Protocol: mqtt\r\n"),
            &[],
            "HTTP/1.1 400",
            Vec::new(),
            false,
        ),
        (
            "no WebSocket",
            b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n".to_vec(),
            &[],
            "",
            Vec::new(),
            false,
        ),
        ("AMQP without WebSocket", b"AMQP\x03\x01\0\0".to_vec(), &[], "", Vec::new(), false),
        ("silence", Vec::new(), &[], "", Vec::new(), true),
        ("a slow request", b"GET / HTTP/1.1\r\nHost:".to_vec(), &[], "", Vec::new(), true),
        ("silence in the WebSocket", amqp.clone(), &[], opened, Vec::new(), true),
        ("half a frame", amqp.clone(), &[0x82, 0x88, 0, 0, 0, 0, b'A'], opened, Vec::new(), true),
        ("text", amqp.clone(), &text, opened, close(1003), false),
        ("a frame of gigabytes", amqp, &gigabytes, opened, close(1009), false),
    ] {
        // There is one place for all: until the one before has left it, a peer is cut off without a
        // word.
        let deadline = Instant::now() + Duration::from_secs(20);
        loop {
            let (answer, took) = exchange(port, &request, frame).await;
            let is_begun = if begins.is_empty() {
                answer.is_empty()
            } else {
                answer.starts_with(begins.as_bytes())
            };
            let is_timely = !is_waited_for || took > Duration::from_millis(400);
            if is_begun && is_timely && answer.ends_with(&ends) && took < Duration::from_secs(5) {
                break;
            }
            let shown = String::from_utf8_lossy(&answer);
            assert!(Instant::now() < deadline, "{what}: {shown:?} after {took:?}");
        }
    }
    let link = TestLink::start(&format!("amqp+ws://127.0.0.1:{port}"), "f1", &[]);
    link.send("factory.f1.ingress", envelope("m1", "{}"));
    eventually("a good one is served", || broker.ready("factory.f1.ingress") == 1).await;
    link.stop().await;
    broker.stop().await;
}
