//! Peers of the broker that mean harm, before they have signed in and after.

mod peer;

use std::{
    net::Ipv4Addr,
    path::PathBuf,
    time::{Duration, Instant},
};

use peer::{ATTACH, CLOSE, DETACH, DISPOSITION, END, Peer};
use testkit::amqp::{
    AMQP, NULL, SASL, SASL_HEADER, attach, begin, binary, described, entry, frame, sasl_init,
    section, symbol, transfer,
};

use super::{entrance::Entrance, route::Route};
use crate::{
    frame_order::MUNICH,
    world::{OBSERVER, OBSERVER_PASSWORD},
};

const LEVELS: usize = 30_000;
/// Lengths that nobody has the bytes of.
const CLAIMED: [u32; 3] = [0x4000_0000, 0xffff_fff0, 0x00ff_ffff];
/// Links of one user, over all its connections.
const LINKS_MAX: usize = 32;
/// Code of the outcome *rejected* (part 3, 3.4.3).
const REJECTED: [u8; 3] = [0x00, 0x53, 0x25];

/// Signs an honest peer in through an entrance, and returns the time that it took.
pub(super) async fn sign_in(entrance: &Entrance) -> anyhow::Result<Duration> {
    let begun = Instant::now();
    let wire = entrance.open(Ipv4Addr::LOCALHOST).await?;
    Peer::open_on(wire, OBSERVER, OBSERVER_PASSWORD).await?;
    Ok(begun.elapsed())
}

/// Guesses the password of a user. Fails unless the broker answers that it is wrong, or that too many were.
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

/// Returns frames of the security layer, each of which claims a length in another form.
pub(super) fn claiming_frames() -> Vec<Vec<u8>> {
    let of = |length: u32| {
        let long = |code: u8| [&[code][..], &length.to_be_bytes()].concat();
        let list = |code: u8| [&long(code)[..], &length.to_be_bytes()].concat();
        let bodies = [
            [&[0x00][..], &long(0xb3)].concat(),
            section(0x41, &list(0xd0)),
            described(0x41, &[long(0xb3)]),
            described(0x41, &[symbol("PLAIN"), long(0xb0)]),
            described(0x40, &[list(0xf0)]),
        ];
        bodies.map(|body| frame(SASL, 0, &body))
    };
    CLAIMED.into_iter().flat_map(of).collect()
}

/// Fourteen bytes of a stranger that claim gigabytes.
pub(super) async fn claimed_lengths(route: Route) -> anyhow::Result<String> {
    let frames = claiming_frames();
    for claiming in &frames {
        let mut stranger = Peer::connect(route).await?;
        stranger.send(&[SASL_HEADER, claiming].concat()).await;
        stranger.header().await.ok();
        stranger.closed().await?;
    }
    Ok(format!("{} connections closed", frames.len()))
}

/// Frames that claim to be shorter than their own header, before the sign-in and after: each ends its connection, and
/// no task of the broker panics.
pub(super) async fn short_frames(route: Route, log: PathBuf) -> anyhow::Result<String> {
    let mut count = 0;
    for size in [0_u32, 1, 4, 7] {
        for rest in [&[][..], &[2, SASL, 0, 0], &[0; 16]] {
            let mut stranger = Peer::connect(route).await?;
            stranger.send(&[SASL_HEADER, &size.to_be_bytes(), rest].concat()).await;
            // Four bytes may be the beginning of a header that comes later.
            stranger.send(&[0; 8]).await;
            stranger.header().await.ok();
            stranger.closed().await?;
            let mut user = Peer::open(route).await?;
            user.send(&[&size.to_be_bytes(), rest].concat()).await;
            user.send(&[0; 8]).await;
            user.closed().await?;
            count += 2;
        }
    }
    // Frames that have a header and nothing else: an empty one is a sign of life, and no more.
    for size in [8_u32, 9] {
        let mut stranger = Peer::connect(route).await?;
        stranger.send(&[SASL_HEADER, &size.to_be_bytes(), &[2, SASL, 0, 0, 0]].concat()).await;
        stranger.header().await.ok();
        stranger.closed().await?;
        count += 1;
    }
    let log = tokio::fs::read_to_string(&log).await?;
    anyhow::ensure!(!log.contains("panicked at"), "a task panicked, as the log says");
    Ok(format!("{count} connections closed, no task panicked"))
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
    let answer = peer.until(&[DISPOSITION]).await?;
    let is_rejected = answer.windows(REJECTED.len()).any(|part| part == REJECTED);
    anyhow::ensure!(is_rejected, "not rejected: {answer:02x?}");
    Ok("rejected, the link goes on".to_owned())
}

/// A delivery of half a million frames that has no end: it is refused long before it has that many.
pub(super) async fn endless(route: Route) -> anyhow::Result<String> {
    let mut peer = attached(route).await?;
    let part = frame(AMQP, 0, &[&transfer(0, 0, true)[..], &[b'x'; 64]].concat()).repeat(1000);
    let mut sent = 0;
    while sent < 500_000 && peer.send(&part).await {
        sent += 1000;
    }
    let refused = peer.until(&[DETACH, END, CLOSE]).await;
    anyhow::ensure!(sent < 500_000 || refused.is_ok(), "all of {sent} frames were taken");
    let how = if refused.is_ok() { "refused by name" } else { "cut" };
    Ok(format!("{sent} frames sent, and then {how}"))
}

/// More links than one user may have, over several connections; a user of another organisation has its own.
pub(super) async fn links(route: Route) -> anyhow::Result<String> {
    const CONNECTIONS: u32 = 4;
    const TRIES: u32 = 16;
    let (mut peers, mut refused) = (Vec::new(), 0);
    let address = format!("factory.{MUNICH}.requests");
    for _ in 0..CONNECTIONS {
        let mut peer = Peer::open(route).await?;
        for handle in 0..TRIES {
            peer.send(&frame(AMQP, 0, &attach(&address, handle, NULL.to_vec()))).await;
        }
        // Each is attached; what is refused is detached right after.
        let mut answered = 0;
        loop {
            let patience = Duration::from_secs(if answered < TRIES { 10 } else { 1 });
            let Ok(frame) = tokio::time::timeout(patience, peer.read()).await else { break };
            match frame?.get(2) {
                Some(&ATTACH) => answered += 1,
                Some(&DETACH) => refused += 1,
                _ => {}
            }
        }
        anyhow::ensure!(answered == TRIES, "{answered} of {TRIES} links are answered");
        peers.push(peer);
    }
    let asked = (CONNECTIONS * TRIES) as usize;
    let held = asked - refused;
    anyhow::ensure!(held <= LINKS_MAX, "{held} of {asked} links are held");
    anyhow::ensure!(held > 0, "no link at all");
    Ok(format!("{held} of {asked} links are held, the others refused"))
}

/// Addresses that are another factory's: a factory that is signed in neither sends in its name nor to its tools.
pub(super) async fn foreign_addresses(
    route: Route,
    user: &str,
    password: &str,
) -> anyhow::Result<String> {
    let mut refusals = 0;
    for address in [format!("factory.{MUNICH}.ingress"), format!("factory.{MUNICH}.requests")] {
        let mut peer = Peer::open_as(route, user, password).await?;
        peer.send(&frame(AMQP, 0, &attach(&address, 0, NULL.to_vec()))).await;
        let answer = peer.until(&[DETACH, END, CLOSE]).await?;
        let condition = b"amqp:unauthorized-access";
        let is_named = answer.windows(condition.len()).any(|part| part == condition);
        anyhow::ensure!(is_named, "{address}: {}", String::from_utf8_lossy(&answer));
        refusals += 1;
    }
    Ok(format!("{refusals} refused as unauthorized"))
}

async fn attached(route: Route) -> anyhow::Result<Peer> {
    let mut peer = Peer::open(route).await?;
    let address = format!("factory.{MUNICH}.requests");
    peer.send(&frame(AMQP, 0, &attach(&address, 0, NULL.to_vec()))).await;
    peer.until(&[ATTACH]).await?;
    Ok(peer)
}

/// Returns what a peer sends that never gets to the end of its sign-in.
pub(super) fn slow_beginning() -> Vec<u8> {
    [SASL_HEADER, &frame(SASL, 0, &binary(&[b'x'; 200]))].concat()
}

/// Returns what a client of a WebSocket sends that never gets to the end of its request.
pub(super) const fn half_upgrade() -> &'static [u8] {
    b"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
      Sec-WebSocket-Protocol: amqp\r\nX-Slow: "
}
