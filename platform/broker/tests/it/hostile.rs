//! Peers that mean harm, before they have signed in and after: whatever they send, the process goes
//! on, its memory stays, and others are served.

use std::{net::Ipv4Addr, time::Duration};

use broker::QueueOptions;
use fe2o3_amqp_types::{messaging::DeliveryState, performatives::Performative};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::{TcpSocket, TcpStream},
    task::JoinSet,
};

use crate::{
    process::BrokerProcess,
    raw::{
        AMQP, AMQP_HEADER, NULL, RawPeer, SASL, SASL_HEADER, attach, begin, binary, described,
        entry, frame, map, nested, section, string, symbol, text, transfer, uint,
    },
    support::{TestBroker, TestLink, envelope, eventually, queue},
};

const INGRESS: &str = "factory.f1.ingress";
/// Growth of a process by all that a test sends it.
const GROWTH_MAX_KB: u64 = 32 * 1024;

/// A broker process with a user who is served, come what may.
struct Victim {
    _folder: tempfile::TempDir,
    process: BrokerProcess,
    honest: TestLink,
    sent: usize,
    peak_kb: u64,
}

impl Victim {
    async fn start() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let process = BrokerProcess::start(folder.path(), 0);
        let honest = TestLink::start(&process.url(), "f1", &[]);
        honest.up().await;
        let peak_kb = process.peak_kb();
        let mut victim = Self { _folder: folder, process, honest, sent: 0, peak_kb };
        victim.serves("at the start").await;
        victim
    }

    fn port(&self) -> u16 {
        self.process.port
    }

    /// Fails unless a message of the honest user is stored, over the connection that it has.
    async fn serves(&mut self, when: &str) {
        self.sent += 1;
        self.honest.send(INGRESS, envelope(format!("honest{}", self.sent), "{}"));
        eventually(&format!("the honest user is served {when}"), || {
            self.honest.spool.waiting() == 0
        })
        .await;
        assert!(self.honest.reason().is_empty(), "{}", self.honest.reason());
    }

    fn has_not_grown(&self, by: &str) {
        let growth = self.process.peak_kb().saturating_sub(self.peak_kb);
        assert!(growth < GROWTH_MAX_KB, "the process grew by {growth} KB from {by}");
    }

    async fn stop(self) {
        self.honest.stop().await;
        self.process.kill();
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn lengths_that_strangers_claim_are_not_allocated() {
    let mut victim = Victim::start().await;
    for length in [0x4000_0000_u32, 0xffff_fff0, 0x00ff_ffff] {
        let long = |code: u8| [&[code][..], &length.to_be_bytes()].concat();
        let list = |code: u8| [&long(code)[..], &length.to_be_bytes()].concat();
        for (what, body) in [
            ("a descriptor", [&[0x00][..], &long(0xb3)].concat()),
            ("a list", section(0x41, &list(0xd0))),
            ("a mechanism", described(0x41, &[long(0xb3)])),
            ("a response", described(0x41, &[symbol("PLAIN"), long(0xb0)])),
            ("a host name", described(0x41, &[symbol("PLAIN"), NULL.to_vec(), long(0xb1)])),
            ("an array", described(0x40, &[list(0xf0)])),
        ] {
            let mut stranger = RawPeer::connect(victim.port()).await;
            stranger.send(&[SASL_HEADER, &frame(SASL, 0, &body)].concat()).await;
            // The header of the broker comes first.
            let _ = stranger.0.read_exact(&mut [0; 8]).await;
            stranger.closed().await;
            victim.has_not_grown(what);
        }
        // The size of the frame itself.
        let mut stranger = RawPeer::connect(victim.port()).await;
        stranger.send(&[SASL_HEADER, &length.to_be_bytes(), &[2, SASL, 0, 0]].concat()).await;
        let _ = stranger.0.read_exact(&mut [0; 8]).await;
        stranger.closed().await;
    }
    victim.has_not_grown("strangers");
    victim.serves("after the strangers").await;
    victim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn frames_before_the_sign_in_have_512_bytes_at_most() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    for (bytes, is_served) in [(512, true), (513, false)] {
        let empty = described(0x41, &[symbol("PLAIN"), binary(b"")]).len() + 8;
        let response = vec![b'x'; bytes - empty];
        let init = frame(SASL, 0, &described(0x41, &[symbol("PLAIN"), binary(&response)]));
        assert_eq!(init.len(), bytes);
        let mut stranger = RawPeer::connect(broker.port()).await;
        stranger.send(&[SASL_HEADER, &init].concat()).await;
        let _ = stranger.0.read_exact(&mut [0; 8]).await;
        stranger.read().await.expect("mechanisms");
        // An outcome for a frame that was read, and none for one that was not.
        assert_eq!(stranger.read().await.is_ok(), is_served, "{bytes} bytes");
        stranger.closed().await;
    }
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nested_properties_are_refused_with_an_error() {
    let mut victim = Victim::start().await;
    for levels in [100, 2_000, 8_000, 30_000] {
        let deep = || entry(nested(levels));
        for (what, body) in [
            ("attach", attach(INGRESS, 0, deep())),
            ("begin", begin(deep())),
            ("a list", begin(nested(levels))),
        ] {
            let mut peer = RawPeer::open(victim.port(), "f1", None).await;
            peer.send(&frame(AMQP, 0, &body)).await;
            let error = peer.closed().await.unwrap_or_default();
            assert!(error.contains("DecodeError"), "{what} of {levels} levels: {error:?}");
            victim.serves(what).await;
        }
    }
    victim.has_not_grown("nested properties");
    victim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nested_messages_are_rejected_and_their_link_goes_on() {
    let mut victim = Victim::start().await;
    let mut peer = RawPeer::open(victim.port(), "f1", Some(INGRESS)).await;
    let good = section(0x75, &binary(b"{}"));
    let mut id = 0;
    for levels in [100, 2_000, 8_000, 30_000] {
        let deep = |code: u8| [section(code, &entry(nested(levels))), good.clone()].concat();
        for (what, message) in [
            ("a body", section(0x77, &nested(levels))),
            ("a sequence", section(0x76, &nested(levels))),
            ("delivery annotations", deep(0x71)),
            ("message annotations", deep(0x72)),
            ("application properties", deep(0x74)),
            ("a footer", [good.clone(), section(0x78, &entry(nested(levels)))].concat()),
        ] {
            for (message, is_good) in [(&message, false), (&good, true)] {
                peer.send(&frame(AMQP, 0, &[transfer(0, id, false), message.clone()].concat()))
                    .await;
                let answer = peer.until(what, |p| matches!(p, Performative::Disposition(_))).await;
                let Performative::Disposition(answer) = answer else { unreachable!() };
                assert_eq!(answer.first, id, "{what}");
                let is_accepted = matches!(answer.state, Some(DeliveryState::Accepted(_)));
                assert_eq!(is_accepted, is_good, "{what} of {levels} levels: {:?}", answer.state);
                id += 1;
            }
        }
    }
    victim.has_not_grown("nested messages");
    victim.serves("after nested messages").await;
    victim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn many_small_values_cost_no_memory() {
    let mut victim = Victim::start().await;
    let mut peer = RawPeer::open(victim.port(), "f1", Some(INGRESS)).await;
    let nulls = vec![NULL.to_vec(); 60_000];
    let properties: Vec<_> = (0..300).flat_map(|n| [string(&n.to_string()), uint(n)]).collect();
    let properties = [section(0x74, &map(&properties)), section(0x75, &binary(b"{}"))].concat();
    let hostile = [
        ("a list", described(0x77, &nulls)),
        ("a sequence", described(0x76, &nulls)),
        ("properties", properties),
        ("a body of no bytes", section(0x77, NULL)),
    ];
    for (id, (what, message)) in (0..).zip(hostile.iter().cycle().take(40)) {
        peer.send(&frame(AMQP, 0, &[&transfer(0, id, false)[..], message].concat())).await;
        let answer = peer.until(what, |p| matches!(p, Performative::Disposition(_))).await;
        let Performative::Disposition(answer) = answer else { unreachable!() };
        let state = format!("{:?}", answer.state);
        assert!(state.contains("Rejected") && state.contains("NotAllowed"), "{what}: {state}");
    }
    victim.has_not_grown("many small values");
    victim.serves("after many small values").await;
    victim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn truncated_frames_end_their_own_connection_and_panic_nowhere() {
    let mut victim = Victim::start().await;
    let whole = frame(AMQP, 0, &attach(INGRESS, 0, map(&[])));
    let mut frames: Vec<Vec<u8>> = Vec::new();
    // Sizes below that of the header, with the bytes that they claim.
    for size in 0_u8..8 {
        frames.push([&[0, 0, 0, size][..], &whole[4..usize::from(size).max(4)]].concat());
    }
    // Bodies cut off, in frames that say so.
    frames.extend((0..whole.len() - 8).step_by(7).map(|end| frame(AMQP, 0, &whole[8..8 + end])));
    // Data offsets, types and channels that are none.
    frames.extend([0, 1, 3, 255].map(|doff| [&whole[..4], &[doff], &whole[5..]].concat()));
    frames.extend([1, 2, 255].map(|kind| [&whole[..5], &[kind], &whole[6..]].concat()));
    frames.push([&whole[..6], &[0xff, 0xff], &whole[8..]].concat());
    for bad in &frames {
        let mut peer = RawPeer::open(victim.port(), "f1", None).await;
        peer.send(bad).await;
        peer.0.shutdown().await.expect("the end");
        peer.closed().await;
        let mut stranger = RawPeer::connect(victim.port()).await;
        stranger.send(&[SASL_HEADER, bad].concat()).await;
        stranger.0.shutdown().await.expect("the end");
        let _ = stranger.0.read_exact(&mut [0; 8]).await;
        stranger.closed().await;
    }
    victim.serves("after truncated frames").await;
    assert_eq!(victim.process.panics(), 0, "a frame made a task panic");
    victim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_a_user_never_ends_is_bounded() {
    let mut victim = Victim::start().await;
    // Deliveries that never end, in frames without bytes and with one.
    let mut peer = RawPeer::open(victim.port(), "f1", Some(INGRESS)).await;
    for payload in [&b""[..], b"x"] {
        let part = frame(AMQP, 0, &[&transfer(0, 0, true)[..], payload].concat());
        for _ in 0..500 {
            peer.send(&part.repeat(1000)).await;
        }
    }
    victim.has_not_grown("a delivery without end");
    // Flows of links that never come.
    let mut other = RawPeer::open(victim.port(), "f1", None).await;
    let counts = [uint(0), uint(1000), uint(0), uint(1000)];
    for first in (0..1_000_000_u32).step_by(1000) {
        let flows = (first..first + 1000).map(|handle| {
            let link = [uint(handle), uint(0), uint(1)];
            frame(AMQP, 0, &described(0x13, &[&counts[..], &link].concat()))
        });
        other.send(&flows.collect::<Vec<_>>().concat()).await;
    }
    victim.has_not_grown("flows of no link");
    victim.serves("after endless deliveries").await;
    victim.stop().await;
}

/// Connects from one of many addresses of this machine.
async fn connect_from(source: Ipv4Addr, port: u16) -> std::io::Result<TcpStream> {
    let socket = TcpSocket::new_v4()?;
    socket.bind((source, 0).into())?;
    socket.connect(([127, 0, 0, 1], port).into()).await
}

/// Holds a connection open, with a byte now and then, and comes again when it is closed.
async fn besiege(source: Ipv4Addr, port: u16, is_silent: bool) {
    loop {
        if let Ok(mut stream) = connect_from(source, port).await {
            for byte in SASL_HEADER.iter().chain(&frame(SASL, 0, &text(0xb3, &"x".repeat(200)))) {
                if !is_silent && stream.write_all(&[*byte]).await.is_err() {
                    break;
                }
                let pause = Duration::from_millis(if is_silent { 60_000 } else { 500 });
                let answer = tokio::time::timeout(pause, stream.read(&mut [0; 64])).await;
                if matches!(answer, Ok(Ok(0) | Err(_))) {
                    break;
                }
            }
        }
        tokio::time::sleep(Duration::from_millis(500)).await;
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_thousand_silent_and_a_thousand_slow_peers_leave_an_honest_one_served() {
    let mut victim = Victim::start().await;
    let mut siege = JoinSet::new();
    for n in 0..1000_u16 {
        let [high, low] = (n / 8).to_be_bytes();
        // Eight each of 125 addresses, and a hundred of the honest user's own.
        let of_many = Ipv4Addr::new(127, 1, high, low.max(1));
        let source = if n % 10 == 0 { Ipv4Addr::LOCALHOST } else { of_many };
        siege.spawn(besiege(source, victim.port(), true));
        siege.spawn(besiege(source, victim.port(), false));
    }
    tokio::time::sleep(Duration::from_secs(2)).await;
    for round in 0..5 {
        let came = std::time::Instant::now();
        let newcomer = TestLink::start(&victim.process.url(), "platform", &[]);
        newcomer.up().await;
        newcomer.send(INGRESS, envelope(format!("newcomer{round}"), "{}"));
        eventually("a newcomer is served", || newcomer.spool.waiting() == 0).await;
        let took = came.elapsed();
        assert!(took < Duration::from_secs(5), "a newcomer waited for {took:?}");
        newcomer.stop().await;
        victim.serves("under siege").await;
    }
    assert!(siege.try_join_next().is_none(), "the siege goes on");
    victim.has_not_grown("2000 peers");
    siege.shutdown().await;
    victim.serves("after the siege").await;
    victim.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_message_too_large_for_its_consumer_becomes_a_dead_letter() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    broker.handle.declare_queue(&queue(INGRESS), QueueOptions::default()).await.expect("declared");
    let sender = TestLink::start(&broker.url(), "f1", &[]);
    sender.send(INGRESS, envelope("large", vec![b'x'; 300_000]));
    sender.send(INGRESS, envelope("small", "{}"));
    let receiver = TestLink::start_with(
        &broker.url(),
        "platform",
        &[INGRESS],
        messaging::spool::memory::AcceptedReports::Leave,
        |config| config.limits.message_bytes_max = 50_000,
    );
    eventually("what is behind it arrives", || receiver.inbox.ids() == ["small"]).await;
    eventually("it is set aside", || broker.ready("dead-letters") == 1).await;
    let letters = broker.handle.dead_letters(0, 10).await.expect("read");
    assert_eq!(letters[0].code, "amqp:link:message-size-exceeded");
    assert_eq!(letters[0].message_id.as_deref(), Some("large"));
    sender.stop().await;
    receiver.stop().await;
    broker.stop().await;
}

/// AMQP without SASL is no way in.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nobody_skips_the_sign_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let broker = TestBroker::start(folder.path()).await;
    let mut stranger = RawPeer::connect(broker.port()).await;
    let open = frame(AMQP, 0, &described(0x10, &[text(0xb1, "stranger")]));
    stranger.send(&[AMQP_HEADER, &open].concat()).await;
    let _ = stranger.0.read_exact(&mut [0; 8]).await;
    stranger.closed().await;
    assert!(broker.handle.connections().is_empty());
    broker.stop().await;
}
