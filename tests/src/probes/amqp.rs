//! Peers of the broker that mean harm, before they have signed in and after.

use std::{
    io,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use testkit::amqp::{
    AMQP, AMQP_HEADER, NULL, SASL, SASL_HEADER, attach, begin, binary, described, entry, frame,
    sasl_init, section, string, symbol, transfer,
};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::TcpStream,
    time::timeout,
};

use super::route::Route;
use crate::{
    frame_order::MUNICH,
    world::{OBSERVER, OBSERVER_PASSWORD},
};

/// Time in which the broker has to answer or to close.
const PATIENCE: Duration = Duration::from_secs(10);
const LEVELS: usize = 30_000;

// Codes of performatives (AMQP 1.0, part 2, 2.7).
const OPEN: u8 = 0x10;
const BEGIN: u8 = 0x11;
const ATTACH: u8 = 0x12;
const DISPOSITION: u8 = 0x15;
const CLOSE: u8 = 0x18;
/// Code of the outcome *rejected* (part 3, 3.4.3).
const REJECTED: [u8; 3] = [0x00, 0x53, 0x25];

/// One end of a connection.
struct Peer(TcpStream);

impl Peer {
    async fn connect(route: Route) -> anyhow::Result<Self> {
        Ok(Self(route.connect().await?))
    }

    /// Signs in, opens the connection and begins a session.
    async fn open(route: Route) -> anyhow::Result<Self> {
        let mut peer = Self::connect(route).await?;
        let open = described(0x10, &[string("probe")]);
        peer.send(SASL_HEADER).await;
        peer.send(&frame(SASL, 0, &sasl_init(OBSERVER, OBSERVER_PASSWORD))).await;
        peer.send(AMQP_HEADER).await;
        peer.send(&frame(AMQP, 0, &open)).await;
        peer.send(&frame(AMQP, 0, &begin(NULL.to_vec()))).await;
        peer.header().await?;
        let (mechanisms, outcome) = (peer.read().await?, peer.read().await?);
        anyhow::ensure!(
            !mechanisms.is_empty() && outcome.get(2) == Some(&0x44),
            "no outcome of the sign-in"
        );
        peer.header().await?;
        peer.until(OPEN).await?;
        peer.until(BEGIN).await?;
        Ok(peer)
    }

    async fn header(&mut self) -> anyhow::Result<()> {
        timeout(PATIENCE, self.0.read_exact(&mut [0; 8])).await??;
        Ok(())
    }

    /// Sends, if the other end still reads.
    async fn send(&mut self, bytes: &[u8]) {
        let _ = timeout(PATIENCE, self.0.write_all(bytes)).await;
    }

    /// Reads the body of a frame.
    async fn read(&mut self) -> io::Result<Vec<u8>> {
        let reading = async {
            let mut head = [0; 8];
            self.0.read_exact(&mut head).await?;
            let size = u32::from_be_bytes([head[0], head[1], head[2], head[3]]);
            let mut body = vec![0; (size as usize).saturating_sub(8)];
            self.0.read_exact(&mut body).await?;
            Ok(body)
        };
        timeout(PATIENCE, reading).await.map_err(|_| io::ErrorKind::TimedOut)?
    }

    /// Reads up to a performative.
    async fn until(&mut self, code: u8) -> anyhow::Result<Vec<u8>> {
        loop {
            let body = self.read().await.with_context(|| format!("no performative {code:#x}"))?;
            if body.get(2) == Some(&code) {
                return Ok(body);
            }
        }
    }

    /// Waits until the other end closes. Returns whether it said why.
    async fn closed(&mut self) -> anyhow::Result<bool> {
        let mut is_reasoned = false;
        loop {
            match self.read().await {
                Ok(body) => is_reasoned |= body.get(2) == Some(&CLOSE),
                Err(error) if error.kind() == io::ErrorKind::TimedOut => {
                    anyhow::bail!("the connection is held open")
                }
                Err(_) => return Ok(is_reasoned),
            }
        }
    }
}

/// Signs an honest peer in, and returns the time that it took.
pub(super) async fn sign_in(route: Route) -> anyhow::Result<Duration> {
    let begun = Instant::now();
    Peer::open(route).await?;
    Ok(begun.elapsed())
}

/// Guesses the password of a user. Returns whether the broker answered that it is wrong, or that too many were.
pub(super) async fn guess(route: Route) -> anyhow::Result<()> {
    let mut peer = Peer::connect(route).await?;
    peer.send(SASL_HEADER).await;
    peer.send(&frame(SASL, 0, &sasl_init(OBSERVER, "a guess like others"))).await;
    peer.header().await?;
    let (mechanisms, outcome) = (peer.read().await?, peer.read().await?);
    let is_refused = outcome.get(2) == Some(&0x44) && outcome.last() != Some(&0);
    anyhow::ensure!(!mechanisms.is_empty() && is_refused, "no refusal: {outcome:02x?}");
    Ok(())
}

/// Fourteen bytes of a stranger that claim gigabytes.
pub(super) async fn claimed_lengths(route: Route) -> anyhow::Result<String> {
    let mut count = 0;
    for length in [0x4000_0000_u32, 0xffff_fff0, 0x00ff_ffff] {
        let long = |code: u8| [&[code][..], &length.to_be_bytes()].concat();
        let list = |code: u8| [&long(code)[..], &length.to_be_bytes()].concat();
        let bodies = [
            [&[0x00][..], &long(0xb3)].concat(),
            section(0x41, &list(0xd0)),
            described(0x41, &[long(0xb3)]),
            described(0x41, &[symbol("PLAIN"), long(0xb0)]),
            described(0x40, &[list(0xf0)]),
        ];
        for body in bodies {
            let mut stranger = Peer::connect(route).await?;
            stranger.send(&[SASL_HEADER, &frame(SASL, 0, &body)].concat()).await;
            stranger.header().await.ok();
            stranger.closed().await?;
            count += 1;
        }
    }
    Ok(format!("{count} connections closed"))
}

/// Frames of a user who is signed in, nested as deep as they may be long.
pub(super) async fn nested(route: Route) -> anyhow::Result<String> {
    let mut reasons = 0;
    let deep = || entry(testkit::amqp::nested(LEVELS));
    let bodies = [
        begin(deep()),
        begin(testkit::amqp::nested(LEVELS)),
        attach("factory.F.requests", 0, deep()),
    ];
    for body in &bodies {
        let mut peer = Peer::open(route).await?;
        peer.send(&frame(AMQP, 0, body)).await;
        reasons += usize::from(peer.closed().await?);
    }
    anyhow::ensure!(reasons == bodies.len(), "{reasons} of {} said why", bodies.len());
    Ok("closed with an error each".to_owned())
}

/// A message whose annotations nest: it is rejected, and its link goes on.
pub(super) async fn nested_message(route: Route) -> anyhow::Result<String> {
    let mut peer = attached(route).await?;
    let body = section(0x77, &testkit::amqp::nested(LEVELS));
    peer.send(&frame(AMQP, 0, &[transfer(0, 0, false), body].concat())).await;
    let answer = peer.until(DISPOSITION).await?;
    let is_rejected = answer.windows(REJECTED.len()).any(|part| part == REJECTED);
    anyhow::ensure!(is_rejected, "not rejected: {answer:02x?}");
    Ok("rejected, the link goes on".to_owned())
}

/// A delivery of half a million frames that has no end.
pub(super) async fn endless(route: Route) -> anyhow::Result<String> {
    let mut peer = attached(route).await?;
    let part = frame(AMQP, 0, &[&transfer(0, 0, true)[..], b"x"].concat()).repeat(1000);
    let mut sent = 0;
    for _ in 0..500 {
        if !matches!(timeout(PATIENCE, peer.0.write_all(&part)).await, Ok(Ok(()))) {
            break;
        }
        sent += 1000;
    }
    Ok(format!("{sent} frames, and no more memory"))
}

async fn attached(route: Route) -> anyhow::Result<Peer> {
    let mut peer = Peer::open(route).await?;
    let address = format!("factory.{MUNICH}.requests");
    peer.send(&frame(AMQP, 0, &attach(&address, 0, NULL.to_vec()))).await;
    peer.until(ATTACH).await?;
    Ok(peer)
}

/// Returns what a peer sends that never gets to the end of its sign-in.
pub(super) fn slow_beginning() -> Vec<u8> {
    [SASL_HEADER, &frame(SASL, 0, &binary(&[b'x'; 200]))].concat()
}
