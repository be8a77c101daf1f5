//! Everything at once: at least a thousand silent and a thousand slow connections to each listener, more that go
//! through TLS and WebSockets first, floods of sign-ins, and oversize and nested frames and documents; each is counted.
//! Honest requests of each kind stay under ten times their usual time, and each single one under a bound; the memory of
//! each process stays bounded, none ends, and afterwards the memory of each comes back.

mod attackers;
mod crowd;
mod honest;
mod judgement;

use std::{
    net::Ipv4Addr,
    sync::{Arc, atomic::Ordering},
    time::{Duration, Instant},
};

use attackers::Attackers;
use crowd::{CROWD, CROWD_BEHIND_LAYERS, Count, Crowd, Tally};
use honest::{Honest, Kind};

use super::{
    amqp,
    entrance::{Entrance, Layers, trusting},
    http, opcua,
    route::{Relay, Route},
    scene::Scene,
};
use crate::harness::say;

/// Guesses at each of the pages, at least. All these minima are about half of what attackers that take no processor from
/// those that they attack get done on a machine of two processors: a siege that falls behind that is starved.
const PAGE_GUESSES_MIN: u64 = 1000;
/// Guesses at the broker, at least.
const BROKER_GUESSES_MIN: u64 = 850;
/// Enrolments with made-up tokens, at least.
const ENROLMENTS_MIN: u64 = 500;
/// Guesses at the OPC UA server, at least: each opens a channel of its own, which takes both sides an RSA key.
const TWIN_GUESSES_MIN: u64 = 23;
/// People who guess at the OPC UA server.
const TWIN_GUESSERS: usize = 2;
/// Rounds of each repeated attack, at least.
const REPEATS_MIN: u64 = 19;
/// Connections of a plain crowd that have to be open at the same time, at least: each listener has 512 to 1 024 places
/// for all that have not signed in, which two or more crowds fill.
const OPEN_MIN: u64 = 250;
/// The same of a crowd behind layers. Some four thousand connections a second come to the broker's 512 places, so each
/// is displaced after about an eighth of a second, and of the handshakes only some tens are completed in a second.
const OPEN_MIN_BEHIND_LAYERS: u64 = 5;
/// Time under siege.
const SPAN: Duration = Duration::from_secs(90);

/// Honest people, and how long what they ask for takes without a siege.
pub(super) struct Usual {
    honest: Honest,
    times: Vec<judgement::Times>,
}

/// Measures what is usual: before all attacks, since those that guess slow down each sign-in of their network.
pub(super) async fn usual(scene: &Scene) -> anyhow::Result<Usual> {
    let honest = Honest::among(scene).await?;
    let (times, failed) = honest.ask(None).await;
    anyhow::ensure!(failed.is_empty(), "without a siege: {failed:?}");
    Ok(Usual { honest, times })
}

pub(super) async fn run(
    scene: &mut Scene,
    Usual { honest, times: usual }: Usual,
) -> anyhow::Result<()> {
    raise_the_limit_of_files()?;
    let watched = judgement::watched(scene)?;
    let (mut siege, tally, _relay) = besiege(scene).await?;
    tokio::time::sleep(Duration::from_secs(5)).await;
    let begun = Instant::now();
    let (under, failed) = honest.ask(Some(begun + SPAN)).await;
    let mut faults = Vec::from_iter(siege.ended());
    let (used, span) = (siege.processor_time(), begun.elapsed());
    siege.leave().await;
    faults.extend(judgement::of_attackers(used, span));
    faults.extend(tally.judge());
    faults.extend(judgement::of_times(&Kind::ALL.map(Kind::name), &usual, &under));
    faults.extend(failed.into_iter().map(|error| format!("under siege: {error}")));
    faults.extend(judgement::of_memory(&watched).await);
    faults.extend(judgement::of_logs(scene));
    for fault in faults {
        say(&format!("  FAIL siege: {fault}"));
        scene.failures.push(format!("siege: {fault}"));
    }
    Ok(())
}

/// Begins all attacks. They go on until the set is dropped; the tally says how many there were.
async fn besiege(scene: &Scene) -> anyhow::Result<(Attackers, Tally, Relay)> {
    let (mut siege, mut tally) = (Attackers::gather()?, Tally::default());
    for crowd in crowds(scene)? {
        crowd.gather(&mut siege, &mut tally);
    }
    flood_pages(scene, &mut siege, &mut tally);
    flood_the_broker(scene, &mut siege, &mut tally);
    let relay = flood_the_twin(scene, &mut siege, &mut tally).await?;
    Ok((siege, tally, relay))
}

/// Returns the crowds before each listener, and those that go on behind its layers.
fn crowds(scene: &Scene) -> anyhow::Result<Vec<Crowd>> {
    let places = &scene.world.places;
    let half_hello = half_client_hello()?;
    let url = format!("opc.tcp://127.0.0.1:{}", places.munich.twin);
    let opcua_hello = testkit::opcua::hello(&url, 65_535);
    let tls = trusting(&places.folder.join("platform"))?;
    let listeners = [
        ("platform", places.platform_web, http::HALF.to_vec()),
        ("broker with TLS", places.broker_tls, half_hello.clone()),
        ("broker", places.broker_plain, amqp::slow_beginning()),
        ("connector", places.munich.connector_web, http::HALF.to_vec()),
        ("OPC UA server", places.munich.twin, opcua_hello),
    ];
    let websocket = places.broker_websocket;
    let in_websockets = websocket.map(|port| ("broker in WebSockets", port, half_hello));
    let mut all = Vec::new();
    let mut add = |name: String, entrance: Entrance, slow: Option<Vec<u8>>| {
        let is_plain = matches!(entrance.layers, Layers::None);
        let (size, open_min) = if is_plain {
            (CROWD, OPEN_MIN)
        } else {
            (CROWD_BEHIND_LAYERS, OPEN_MIN_BEHIND_LAYERS)
        };
        all.push(Crowd { name, entrance, slow: slow.map(Into::into), size, open_min });
    };
    for (listener, port, slow) in listeners.into_iter().chain(in_websockets) {
        let name = |kind: &str| format!("{kind} connections to the {listener}");
        add(name("silent"), Entrance::plain(port), None);
        add(name("slow"), Entrance::plain(port), Some(slow));
    }
    let in_tls = |port: u16| Entrance { port, layers: Layers::Tls(Arc::clone(&tls)) };
    let tls_port = places.broker_tls;
    add("clients that are silent behind TLS".to_owned(), in_tls(tls_port), None);
    let frames = Some(amqp::slow_beginning());
    add("clients with slow frames behind TLS".to_owned(), in_tls(tls_port), frames.clone());
    if let Some(port) = websocket {
        let half = Some(amqp::half_upgrade().to_vec());
        add("clients with half a request for a WebSocket".to_owned(), in_tls(port), half);
        let inside = || Entrance { port, layers: Layers::WebSocket(Arc::clone(&tls)) };
        add("clients that are silent in a WebSocket".to_owned(), inside(), None);
        add("clients with slow frames in a WebSocket".to_owned(), inside(), frames);
    }
    Ok(all)
}

/// Sign-ins, enrolments, and documents that are too large or too deep, at both programs with pages.
fn flood_pages(scene: &Scene, siege: &mut Attackers, tally: &mut Tally) {
    let places = &scene.world.places;
    let pages = [("platform", places.platform_web), ("connector", places.munich.connector_web)];
    for (program, port) in pages {
        let guesses = tally.count(format!("guesses at the {program}"), PAGE_GUESSES_MIN);
        for n in 1..=10 {
            siege.spawn(guess_on(Ipv4Addr::new(127, 2, 0, n), port, Arc::clone(&guesses)));
        }
        let count = tally.count(format!("bodies too large for the {program}"), REPEATS_MIN);
        siege.spawn(repeat(count, move || http::oversize(port)));
        let count = tally.count(format!("documents too deep for the {program}"), REPEATS_MIN);
        siege.spawn(repeat(count, move || http::nested_sign_ins(port)));
    }
    let enrolments = tally.count("enrolments with made-up tokens".to_owned(), ENROLMENTS_MIN);
    for n in 1..=10 {
        let source = Ipv4Addr::new(127, 2, 1, n);
        siege.spawn(enrol_from(source, places.platform_web, Arc::clone(&enrolments)));
    }
}

fn flood_the_broker(scene: &Scene, siege: &mut Attackers, tally: &mut Tally) {
    let port = scene.world.places.broker_plain;
    let sign_ins = tally.count("guesses at the broker".to_owned(), BROKER_GUESSES_MIN);
    for n in 1..=10 {
        let route = Route::new(Ipv4Addr::new(127, 2, 1, n), port);
        siege.spawn(repeat(Arc::clone(&sign_ins), move || amqp::guess(route)));
    }
    let mut again = |name: &str| tally.count(name.to_owned(), REPEATS_MIN);
    let broker = Route::hostile(port);
    siege.spawn(repeat(again("claimed lengths"), move || amqp::claimed_lengths(broker)));
    siege.spawn(repeat(again("nested frames"), move || amqp::nested(broker)));
    siege.spawn(repeat(again("nested messages"), move || amqp::nested_message(broker)));
}

/// Guesses come through a relay, since the library chooses the address of a client; it is to live as long as they do.
async fn flood_the_twin(
    scene: &Scene,
    siege: &mut Attackers,
    tally: &mut Tally,
) -> anyhow::Result<Relay> {
    let twin = Route::hostile(scene.world.places.munich.twin);
    let relay = siege.prepare(Relay::along(twin)).await??;
    let url = relay.route().opcua_url();
    let guesses = tally.count("guesses at the OPC UA server".to_owned(), TWIN_GUESSES_MIN);
    for number in 0..TWIN_GUESSERS {
        let guesser = opcua::Client::named(&format!("probe that guesses under siege {number}"))?;
        opcua::trust(&scene.cast.munich, &guesser).await?;
        siege.spawn(guess_at_the_twin(guesser, url.clone(), Arc::clone(&guesses)));
    }
    let mut again = |name: &str| tally.count(name.to_owned(), REPEATS_MIN);
    siege.spawn(repeat(again("nested headers"), move || opcua::nested_headers(twin)));
    siege.spawn(repeat(again("claimed sizes"), move || opcua::claimed_sizes(twin)));
    siege.spawn(repeat(again("claimed ranks"), move || opcua::claimed_ranks(twin)));
    Ok(relay)
}

/// Attacks again and again, and counts the attacks that were answered as they should be.
async fn repeat<T, F: Future<Output = anyhow::Result<T>>>(count: Count, attack: impl Fn() -> F) {
    loop {
        if attack().await.is_ok() {
            count.fetch_add(1, Ordering::Relaxed);
        }
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
}

/// Guesses passwords from an address, one after the other: mostly of an honest person, which a throttle stops, and now
/// and then of a name that was never tried, which has to be checked.
async fn guess_on(source: Ipv4Addr, port: u16, count: Count) {
    let Ok(client) = http::client_from(source) else { return };
    for number in 0_u64.. {
        let stranger = format!("stranger-{number}");
        let name = if number % 5 == 0 { stranger } else { honest::NAME.to_owned() };
        let refused = http::sign_in(&client, port, name).await;
        if refused.is_ok_and(|status| {
            status.is_none_or(|status| status.is_client_error() || status == 503)
        }) {
            count.fetch_add(1, Ordering::Relaxed);
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

/// Guesses the password of an honest person at the OPC UA server.
async fn guess_at_the_twin(guesser: opcua::Client, url: String, count: Count) {
    let Ok(folder) = tempfile::tempdir() else { return };
    for number in 0_u64.. {
        let password = format!("a guess like others, number {number}");
        let user = (honest::NAME, password.as_str());
        if let Ok(false) = guesser.signs_in(folder.path(), &url, user).await {
            count.fetch_add(1, Ordering::Relaxed);
        }
        // A guess takes both sides several operations with an RSA key, and both share the processors.
        tokio::time::sleep(Duration::from_secs(1)).await;
    }
}

/// Tries to enrol from an address, again and again.
async fn enrol_from(source: Ipv4Addr, port: u16, count: Count) {
    let Ok(client) = http::client_from(source) else { return };
    repeat(count, || http::enrol(&client, port)).await;
}

/// Returns the first half of what a client of TLS says.
fn half_client_hello() -> anyhow::Result<Vec<u8>> {
    let config = rustls::ClientConfig::builder()
        .with_root_certificates(rustls::RootCertStore::empty())
        .with_no_client_auth();
    let mut client = rustls::ClientConnection::new(Arc::new(config), "localhost".try_into()?)?;
    let mut hello = Vec::new();
    client.write_tls(&mut hello)?;
    hello.truncate(hello.len() / 2);
    Ok(hello)
}

/// The siege itself has more than thirteen thousand connections.
fn raise_the_limit_of_files() -> anyhow::Result<()> {
    use rustix::process::{Resource, getrlimit, setrlimit};

    let mut limit = getrlimit(Resource::Nofile);
    limit.current = limit.maximum;
    setrlimit(Resource::Nofile, limit)?;
    let most = limit.current.unwrap_or(u64::MAX);
    anyhow::ensure!(most > 17_000, "the siege needs 17 000 files; this system allows {most}");
    Ok(())
}
