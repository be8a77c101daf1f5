//! Everything at once: at least a thousand silent and a thousand slow connections to each listener, floods of
//! sign-ins, and oversize and nested frames; each is counted. Honest requests stay under ten times their usual time,
//! memory stays bounded, no program ends, and afterwards memory comes back.

mod crowd;

use std::{
    net::Ipv4Addr,
    sync::{Arc, atomic::Ordering},
    time::{Duration, Instant},
};

use crowd::{Count, Tally};
use tokio::task::JoinSet;

use super::{
    amqp, http, opcua,
    process::mib,
    route::Route,
    scene::{MEMORY_MAX, Scene, Target, honest_request},
};
use crate::harness::{Deadline, say};

/// Guesses of each kind, at least.
const GUESSES_MIN: u64 = 500;
/// Rounds of each repeated attack, at least.
const REPEATS_MIN: u64 = 3;
/// Usual time of an honest request, at least: below it a delay of the scheduler would be many times as long.
const USUAL_MIN: Duration = Duration::from_millis(2);
/// Time under siege.
const SPAN: Duration = Duration::from_secs(90);
/// Rounds of honest requests before the siege.
const ROUNDS: usize = 40;
/// Factor by which an honest request may take longer under siege.
const FACTOR_MAX: f64 = 10.0;
/// Memory that a program may keep of a siege, beside a half of what it had.
const KEPT_MAX: u64 = 64 << 20;
/// Time after which memory has to be back.
const RELIEF: Duration = Duration::from_secs(90);

/// Durations of one kind of honest requests.
#[derive(Debug, Default, Clone)]
struct Times(Vec<Duration>);

impl Times {
    /// Returns the duration that this part of all do not exceed.
    fn part(&self, part: f64) -> Duration {
        let mut sorted = self.0.clone();
        sorted.sort_unstable();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss
        )]
        let place = (sorted.len() as f64 * part) as usize;
        sorted.get(place.min(sorted.len().saturating_sub(1))).copied().unwrap_or_default()
    }
}

/// Kinds of honest requests.
const KINDS: [&str; 6] = [
    "a page of the platform",
    "a page of the connector",
    "a new caller of the platform",
    "a new caller of the connector",
    "a sign-in at the broker",
    "a discovery at the OPC UA server",
];

pub(super) async fn run(scene: &mut Scene) -> anyhow::Result<()> {
    raise_the_limit_of_files()?;
    let usual = honest(scene, None, &mut Vec::new()).await;
    let programs = [Target::Platform, Target::Broker, Target::Connector];
    let mut before = Vec::new();
    for target in programs {
        let memory = scene.memory(target)?;
        memory.reset_peak()?;
        before.push((memory, memory.resident()?));
    }
    let (mut siege, tally) = besiege(scene)?;
    tokio::time::sleep(Duration::from_secs(5)).await;
    let mut failed = Vec::new();
    let under = honest(scene, Some(Instant::now() + SPAN), &mut failed).await;
    let mut faults = Vec::new();
    if let Some(ended) = siege.try_join_next() {
        faults.push(format!("a part of the siege ended: {ended:?}"));
    }
    siege.shutdown().await;
    faults.extend(tally.judge());
    say(&format!("  (A usual time below {USUAL_MIN:?} counts as {USUAL_MIN:?}.)"));
    for (kind, (usual, under)) in KINDS.iter().zip(usual.iter().zip(&under)) {
        let ratio =
            |part| under.part(part).as_secs_f64() / usual.part(part).max(USUAL_MIN).as_secs_f64();
        let (median, most) = (ratio(0.5), ratio(0.95));
        say(&format!(
            "  {kind}: usually {:?} (95 % {:?}), under siege {:?} (95 % {:?}): {median:.1} and {most:.1} times, of {}",
            usual.part(0.5),
            usual.part(0.95),
            under.part(0.5),
            under.part(0.95),
            under.0.len()
        ));
        if under.0.len() < 10 || median > FACTOR_MAX || most > FACTOR_MAX {
            faults.push(format!(
                "{kind} took {median:.1} and {most:.1} times as long, of {}",
                under.0.len()
            ));
        }
    }
    faults.extend(failed.into_iter().map(|error| format!("under siege: {error}")));
    for (target, (memory, before)) in programs.into_iter().zip(before) {
        // A supervisor starts a broker again that has crashed.
        if scene.memory(target)? != memory {
            faults.push(format!("{target:?} ended and was started again"));
        }
        faults.extend(memory_of(scene, target, before).await?);
    }
    for fault in faults {
        say(&format!("  FAIL siege: {fault}"));
        scene.failures.push(format!("siege: {fault}"));
    }
    Ok(())
}

/// Prints what a program needed, and waits until it gave it back.
async fn memory_of(
    scene: &mut Scene,
    target: Target,
    before: u64,
) -> anyhow::Result<Option<String>> {
    scene.runs(target)?;
    let memory = scene.memory(target)?;
    let peak = memory.peak()?;
    let allowed = before + before / 2 + KEPT_MAX;
    let deadline = Deadline::after(RELIEF);
    let mut after = memory.resident()?;
    while after > allowed && !deadline.has_passed() {
        tokio::time::sleep(Duration::from_secs(1)).await;
        after = memory.resident()?;
    }
    say(&format!(
        "  {target:?}: {} MiB before, {} MiB at most, {} MiB after the siege",
        mib(before),
        mib(peak),
        mib(after)
    ));
    Ok(if peak > MEMORY_MAX {
        Some(format!("{target:?} took {} MiB", mib(peak)))
    } else {
        (after > allowed).then(|| format!("{target:?} keeps {} MiB", mib(after)))
    })
}

/// Makes honest requests of each kind, some rounds or until a time.
async fn honest(scene: &Scene, until: Option<Instant>, failed: &mut Vec<String>) -> Vec<Times> {
    let places = &scene.world.places;
    let mut times = vec![Times::default(); KINDS.len()];
    let mut round = 0;
    while until.map_or(round < ROUNDS, |until| Instant::now() < until) {
        round += 1;
        let outcomes = [
            honest_request(&scene.cast.platform).await,
            honest_request(&scene.cast.munich).await,
            new_caller(places.platform_web).await,
            new_caller(places.munich.connector_web).await,
            amqp::sign_in(Route::honest(places.broker_plain)).await,
            opcua::discover(Route::honest(places.munich.twin)).await,
        ];
        for ((times, outcome), kind) in times.iter_mut().zip(outcomes).zip(KINDS) {
            match outcome {
                Ok(took) => times.0.push(took),
                Err(error) => failed.push(format!("{kind}: {error:#}")),
            }
        }
        tokio::time::sleep(Duration::from_millis(200)).await;
    }
    times
}

/// Asks over a connection of its own, and returns the time that it took.
async fn new_caller(port: u16) -> anyhow::Result<Duration> {
    let begun = Instant::now();
    http::client()?
        .get(format!("http://127.0.0.1:{port}/healthz"))
        .send()
        .await?
        .error_for_status()?;
    Ok(begun.elapsed())
}

/// Begins all attacks. They go on until the set is dropped; the tally says how many there were.
fn besiege(scene: &Scene) -> anyhow::Result<(JoinSet<()>, Tally)> {
    let places = &scene.world.places;
    let (broker, twin) = (places.broker_plain, places.munich.twin);
    let half_hello = half_client_hello()?;
    let opcua_hello = testkit::opcua::hello(&format!("opc.tcp://127.0.0.1:{twin}"), 65_535);
    let listeners = [
        ("platform", places.platform_web, http::HALF.to_vec()),
        ("broker with TLS", places.broker_tls, half_hello.clone()),
        ("broker", broker, amqp::slow_beginning()),
        ("connector", places.munich.connector_web, http::HALF.to_vec()),
        ("OPC UA server", twin, opcua_hello),
    ];
    let websocket = places.broker_websocket.map(|port| ("broker in WebSockets", port, half_hello));
    let (mut siege, mut tally) = (JoinSet::new(), Tally::default());
    for (listener, port, slow) in listeners.into_iter().chain(websocket) {
        crowd::gather(&mut siege, &mut tally, listener, port, slow.into());
    }
    let pages = [("platform", places.platform_web), ("connector", places.munich.connector_web)];
    for (program, port) in pages {
        let guesses = tally.count(format!("guesses at the {program}"), GUESSES_MIN);
        for n in 1..=10 {
            siege.spawn(guess_on(Ipv4Addr::new(127, 2, 0, n), port, Arc::clone(&guesses)));
        }
        let count = tally.count(format!("bodies too large for the {program}"), REPEATS_MIN);
        siege.spawn(repeat(count, move || http::oversize(port)));
    }
    let enrolments = tally.count("enrolments with made-up tokens".to_owned(), GUESSES_MIN);
    let sign_ins = tally.count("guesses at the broker".to_owned(), GUESSES_MIN);
    for n in 1..=10 {
        let source = Ipv4Addr::new(127, 2, 1, n);
        siege.spawn(enrol_from(source, places.platform_web, Arc::clone(&enrolments)));
        let route = Route::new(source, broker);
        siege.spawn(repeat(Arc::clone(&sign_ins), move || amqp::guess(route)));
    }
    let mut again = |name: &str| tally.count(name.to_owned(), REPEATS_MIN);
    let (broker, twin) = (Route::hostile(broker), Route::hostile(twin));
    siege.spawn(repeat(again("claimed lengths"), move || amqp::claimed_lengths(broker)));
    siege.spawn(repeat(again("nested frames"), move || amqp::nested(broker)));
    siege.spawn(repeat(again("nested messages"), move || amqp::nested_message(broker)));
    siege.spawn(repeat(again("nested headers"), move || opcua::nested_headers(twin)));
    siege.spawn(repeat(again("claimed sizes"), move || opcua::claimed_sizes(twin)));
    siege.spawn(repeat(again("claimed ranks"), move || opcua::claimed_ranks(twin)));
    Ok((siege, tally))
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

/// Guesses passwords from an address, one after the other.
async fn guess_on(source: Ipv4Addr, port: u16, count: Count) {
    let client =
        reqwest::Client::builder().local_address(Some(source.into())).timeout(SPAN).build();
    let Ok(client) = client else { return };
    loop {
        if http::sign_in(&client, port, "stranger".to_owned()).await.is_ok() {
            count.fetch_add(1, Ordering::Relaxed);
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

/// Tries to enrol from an address, again and again.
async fn enrol_from(source: Ipv4Addr, port: u16, count: Count) {
    let client =
        reqwest::Client::builder().local_address(Some(source.into())).timeout(SPAN).build();
    let Ok(client) = client else { return };
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

/// The siege itself has twelve thousand connections.
fn raise_the_limit_of_files() -> anyhow::Result<()> {
    use rustix::process::{Resource, getrlimit, setrlimit};

    let mut limit = getrlimit(Resource::Nofile);
    limit.current = limit.maximum;
    setrlimit(Resource::Nofile, limit)?;
    let most = limit.current.unwrap_or(u64::MAX);
    anyhow::ensure!(most > 15_000, "the siege needs 15 000 files; this system allows {most}");
    Ok(())
}
