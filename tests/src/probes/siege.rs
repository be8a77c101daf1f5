//! Everything at once: a thousand silent and a thousand slow connections to each listener, floods of
//! sign-ins, and oversize and nested frames. Honest requests stay under ten times their usual time,
//! memory stays bounded, no program ends, and afterwards memory comes back.

use std::{
    io,
    net::{Ipv4Addr, SocketAddr},
    sync::Arc,
    time::{Duration, Instant},
};

use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::{TcpSocket, TcpStream},
    task::JoinSet,
    time::timeout,
};

use super::{
    amqp, http, opcua,
    process::mib,
    scene::{MEMORY_MAX, Scene, Target, honest_request},
};
use crate::harness::{Deadline, say};

/// Connections of each kind to each listener.
const CROWD: u16 = 1000;
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
const KINDS: [&str; 5] = [
    "a page of the platform",
    "a page of the connector",
    "a new caller of the platform",
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
        before.push(memory.resident()?);
    }
    let mut siege = besiege(scene);
    tokio::time::sleep(Duration::from_secs(5)).await;
    let mut failed = Vec::new();
    let under = honest(scene, Some(Instant::now() + SPAN), &mut failed).await;
    let mut faults = Vec::new();
    if let Some(ended) = siege.try_join_next() {
        faults.push(format!("a part of the siege ended: {ended:?}"));
    }
    siege.shutdown().await;
    for (kind, (usual, under)) in KINDS.iter().zip(usual.iter().zip(&under)) {
        let ratio =
            |part| under.part(part).as_secs_f64() / usual.part(part).as_secs_f64().max(0.002);
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
    for (target, before) in programs.into_iter().zip(before) {
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
            amqp::sign_in(places.broker_plain).await,
            opcua::discover(places.munich.twin).await,
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

/// Begins all attacks. They go on until the set is dropped.
fn besiege(scene: &Scene) -> JoinSet<()> {
    let places = &scene.world.places;
    let listeners = [
        places.platform_web,
        places.broker_tls,
        places.broker_plain,
        places.munich.connector_web,
        places.munich.twin,
    ]
    .into_iter()
    .chain(places.broker_websocket);
    let mut siege = JoinSet::new();
    for port in listeners {
        let slow: Arc<[u8]> = if port == places.munich.twin {
            testkit::opcua::hello(&format!("opc.tcp://127.0.0.1:{port}"), 65_535).into()
        } else if port == places.broker_plain {
            amqp::slow_beginning().into()
        } else {
            http::HALF.into()
        };
        for n in 0..CROWD {
            let [high, low] = (n / 8).to_be_bytes();
            // Eight of each kind from each of 125 addresses; honest people have another one.
            let source = Ipv4Addr::new(127, 1, high, low.max(1));
            for is_silent in [true, false] {
                siege.spawn(hold(source, port, Arc::clone(&slow), is_silent));
            }
        }
    }
    for port in [places.platform_web, places.munich.connector_web] {
        for n in 1..=10 {
            siege.spawn(guess_on(Ipv4Addr::new(127, 2, 0, n), port));
        }
        siege.spawn(repeat(move || async move { drop(http::oversize(port).await) }));
    }
    let (broker, twin) = (places.broker_plain, places.munich.twin);
    siege.spawn(repeat(move || async move { drop(amqp::claimed_lengths(broker).await) }));
    siege.spawn(repeat(move || async move { drop(amqp::nested(broker).await) }));
    siege.spawn(repeat(move || async move { drop(amqp::nested_message(broker).await) }));
    siege.spawn(repeat(move || async move { drop(opcua::nested_headers(twin).await) }));
    siege.spawn(repeat(move || async move { drop(opcua::claimed_sizes(twin).await) }));
    siege
}

/// Attacks again and again.
async fn repeat<F: Future<Output = ()>>(attack: impl Fn() -> F) {
    loop {
        attack().await;
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
}

/// Guesses passwords from an address, one after the other.
async fn guess_on(source: Ipv4Addr, port: u16) {
    let client =
        reqwest::Client::builder().local_address(Some(source.into())).timeout(SPAN).build();
    let Ok(client) = client else { return };
    loop {
        http::sign_in(&client, port, "stranger".to_owned()).await.ok();
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

/// Holds a connection open, silent or with a byte now and then, and comes again when it is closed.
async fn hold(source: Ipv4Addr, port: u16, slow: Arc<[u8]>, is_silent: bool) {
    loop {
        if let Ok(mut stream) = connect_from(source, port).await {
            for byte in slow.iter() {
                if !is_silent && stream.write_all(&[*byte]).await.is_err() {
                    break;
                }
                let pause = Duration::from_millis(if is_silent { 60_000 } else { 500 });
                let answer = timeout(pause, stream.read(&mut [0; 64])).await;
                if matches!(answer, Ok(Ok(0) | Err(_))) {
                    break;
                }
            }
        }
        tokio::time::sleep(Duration::from_millis(500)).await;
    }
}

async fn connect_from(source: Ipv4Addr, port: u16) -> io::Result<TcpStream> {
    let socket = TcpSocket::new_v4()?;
    socket.bind(SocketAddr::new(source.into(), 0))?;
    socket.connect(SocketAddr::new(Ipv4Addr::LOCALHOST.into(), port)).await
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
