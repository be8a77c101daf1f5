//! Servers of three other stacks with the limits of a small controller: at rest the connection stays, what the server keeps
//! arrives, each limit is said, and after each fault every input is live within 5 s of the server's return.

use std::time::{Duration, Instant};

use asi_model::{Scalar, StatusCode, Variant};
use shop_floor::{
    InputKey, MonitorOptions, SourceId, SourceProblemKind, SourceState, SourceStatus,
};
use simulator::signals::hash;

use crate::{
    peer::{Peer, SMALL_VARIABLES, Stack},
    support::{TestShopFloor, until, within},
};

const COUNTER: u64 = 1;
const RETURN_MAX: Duration = Duration::from_secs(5);
const SEED: u64 = 20_261_127;
/// Servers that share the faults of `make foreign-kills`.
const STACKS: u64 = 3;

/// Kinds of faults, as they are counted.
const KINDS: [&str; 3] = ["killed", "frozen", "moved"];

/// Fault of a server, with its end.
#[derive(Debug, Clone, Copy)]
enum ServerFault {
    /// Killed and started at the same address.
    Kill,
    /// Frozen for so long: it keeps its connections and sessions, and does nothing.
    Freeze(Duration),
    /// Killed and started at another address, which an engineer enters then.
    Move,
}

impl ServerFault {
    fn kind(self) -> &'static str {
        let [killed, frozen, moved] = KINDS;
        match self {
            Self::Kill => killed,
            Self::Freeze(_) => frozen,
            Self::Move => moved,
        }
    }

    /// Draws a fault. Of the freezes some are noticed as silence, and some outlive the session at the server (30 s).
    fn drawn(seed: u64, stack: Stack, round: u64) -> Self {
        let dice = hash(seed, stack as u64, round);
        let millis = |least: u64, span: u64| Duration::from_millis(least + (dice >> 16) % span);
        match (dice % 8, (dice >> 8) % 20) {
            (0..=2, _) => Self::Kill,
            (3 | 4, _) => Self::Move,
            (_, 0) => Self::Freeze(millis(31_000, 3000)),
            (_, 1..=6) => Self::Freeze(millis(6000, 3000)),
            _ => Self::Freeze(millis(200, 2800)),
        }
    }
}

/// Reads a number from the environment, as `make` passes it.
fn number_of(variable: &str) -> Option<u64> {
    let text = std::env::var(variable).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{variable} is no number: {text}")))
}

fn node_number(input: u64) -> u32 {
    u32::try_from(input).expect("a small number")
}

/// Values of the counter that arrived.
fn counted(floor: &TestShopFloor) -> Vec<i32> {
    let values = floor.heard(COUNTER).into_iter();
    values
        .filter_map(|value| match value.value {
            Variant::Scalar(Scalar::Int32(count)) => Some(count),
            _ => None,
        })
        .collect()
}

fn says_what_it_grants(status: &SourceStatus, publishing_ms: u32) {
    let granted = status.granted.expect("subscriptions");
    assert_eq!(granted.publishing_ms, u64::from(publishing_ms));
    assert_eq!((granted.sampling_ms, granted.queue_size), (Some(250.0), Some(1)));
    assert!(granted.keep_alive_ms <= 2000, "{granted:?}");
    assert!(granted.silence_ms_max > granted.keep_alive_ms, "{granted:?}");
    let limits = status.limits.expect("limits");
    assert_eq!(limits.nodes_per_read_max, Some(10));
    assert_eq!(limits.nodes_per_browse_max, Some(10));
    assert_eq!(limits.paths_per_translate_max, Some(10));
    assert_eq!(limits.items_per_call_max, Some(10));
    assert_eq!(limits.subscriptions_per_session_max, Some(2));
    assert_eq!(limits.sessions_max, Some(3));
    assert_eq!(limits.queue_size_max, Some(1));
    // A queue of one is too short for what is looked at more often than it is published, and that is said of each input.
    assert_eq!(status.coarse.len(), status.inputs);
    for input in &status.coarse {
        assert_eq!((input.sampling_ms, input.queue_size), (Some(250.0), Some(1)), "{input:?}");
    }
}

/// One source at rest, in two subscriptions, and one with a counter that counts every 100 ms: for 15 s, or for
/// `FOREIGN_REST_MINUTES` (`make foreign-rest`).
async fn is_left_in_peace_and_loses_nothing(stack: Stack, publishing_ms: u32) {
    let mut peer = Peer::small(stack, publishing_ms).await;
    let (quiet, counting) = (TestShopFloor::start(), TestShopFloor::start());
    let id = quiet.connect_to(peer.source()).await;
    counting.connect_to(peer.source()).await;
    for input in Peer::small_numbers().filter(|input| *input != COUNTER) {
        quiet.monitor(input, &id, peer.node(node_number(input)));
    }
    counting.monitor(COUNTER, &id, peer.node(node_number(COUNTER)));
    let inputs = usize::try_from(SMALL_VARIABLES).expect("few") - 1;
    until("all are live", || (quiet.status(&id).live, counting.status(&id).live) == (inputs, 1))
        .await;
    says_what_it_grants(&quiet.status(&id), publishing_ms);
    says_what_it_grants(&counting.status(&id), publishing_ms);

    let rest = number_of("FOREIGN_REST_MINUTES").map_or(15, |minutes| 60 * minutes);
    peer.set(r#"{"counting": true}"#).await;
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(rest) {
        for floor in [&quiet, &counting] {
            let status = floor.status(&id);
            let after = begun.elapsed();
            assert_eq!(status.sessions, 1, "{stack:?} after {after:?}: {:?}", status.problem);
            let is_live = status.state == SourceState::Connected && status.live == status.inputs;
            assert!(is_live, "{stack:?} after {after:?}: {status:?}");
        }
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    let intervals = begun.elapsed().as_millis() / u128::from(publishing_ms);
    peer.set(r#"{"counting": false}"#).await;
    peer.set(r#"{"counter": -1}"#).await;
    counting.until_value(COUNTER, -1_i32).await;
    until("the server says that it sent the last one", || peer.kept().last() == Some(&-1)).await;

    let (kept, arrived) = (peer.kept(), counted(&counting));
    assert_eq!(arrived, kept, "{stack:?}: what the server kept, in its order");
    // It found a request to answer when it had something to say: little was overwritten because none was there.
    assert!(kept.len() as u128 * 2 >= intervals, "{} of {intervals}", kept.len());
}

#[tokio::test]
async fn asyncua_with_the_limits_of_a_small_controller_is_left_in_peace_and_loses_nothing() {
    is_left_in_peace_and_loses_nothing(Stack::Asyncua, 500).await;
}

#[tokio::test]
async fn node_opcua_with_the_limits_of_a_small_controller_is_left_in_peace_and_loses_nothing() {
    is_left_in_peace_and_loses_nothing(Stack::NodeOpcua, 1000).await;
}

#[tokio::test]
async fn open62541_with_the_limits_of_a_small_controller_is_left_in_peace_and_loses_nothing() {
    is_left_in_peace_and_loses_nothing(Stack::Open62541, 500).await;
}

#[tokio::test]
async fn open62541_that_publishes_every_second_is_left_in_peace_and_loses_nothing() {
    is_left_in_peace_and_loses_nothing(Stack::Open62541, 1000).await;
}

/// Monitors all variables of a small controller, each with its browse path as the connector keeps it with a mapping.
async fn monitor_all(floor: &TestShopFloor, source: &SourceId, peer: &Peer) {
    for input in Peer::small_numbers() {
        let node = peer.node(node_number(input));
        let path = floor.handle.browse_path(source, &node).await.expect("a path");
        let options = MonitorOptions { browse_path: Some(path), ..MonitorOptions::default() };
        floor
            .handle
            .monitor(InputKey(input), source.clone(), node, options)
            .expect("a valid request");
    }
}

/// Suffers one fault; the server is back when this returns.
async fn suffer(
    fault: ServerFault,
    round: u32,
    peer: &mut Peer,
    floor: &TestShopFloor,
    ports: [u16; 4],
) {
    match fault {
        ServerFault::Kill => {
            peer.kill().await;
            floor.until_status(COUNTER, StatusCode::BAD_NOT_CONNECTED).await;
            peer.restart(round % 3, round).await;
        }
        ServerFault::Freeze(span) => {
            peer.freeze().await;
            tokio::time::sleep(span).await;
            peer.thaw().await;
        }
        ServerFault::Move => {
            let address = format!("127.0.0.{}", 2 + round % 5);
            peer.move_to(&address, ports[round as usize % ports.len()], round % 3, round).await;
            floor.handle.put_source(peer.source()).expect("valid");
        }
    }
}

/// Suffers these faults, or its share of `FOREIGN_KILLS` drawn ones (`make foreign-kills`), of `FOREIGN_SEED`.
async fn is_live_after_each(stack: Stack, publishing_ms: u32, usual: &[ServerFault]) {
    let seed = number_of("FOREIGN_SEED").unwrap_or(SEED);
    let faults = number_of("FOREIGN_KILLS").map_or_else(
        || usual.to_vec(),
        |all| {
            let share = all.div_ceil(STACKS);
            (0..share).map(|round| ServerFault::drawn(seed, stack, round)).collect()
        },
    );
    let inputs = usize::try_from(SMALL_VARIABLES).expect("few");
    let mut peer = Peer::small(stack, publishing_ms).await;
    let ports = free_ports::reserve().expect("free ports");
    let floor = TestShopFloor::start();
    let id = floor.connect_to(peer.source()).await;
    monitor_all(&floor, &id, &peer).await;
    until("all are live", || floor.status(&id).live == inputs).await;
    let mut returns = Vec::with_capacity(faults.len());
    for (round, fault) in (1_u32..).zip(faults) {
        suffer(fault, round, &mut peer, &floor, ports).await;
        let count = i32::try_from(round).expect("few rounds");
        peer.set(&format!(r#"{{"counter": {count}}}"#)).await;
        let what = format!("{stack:?} is live, {fault:?} in round {round} of seed {seed}");
        let took = within(RETURN_MAX, &what, || {
            floor.status(&id).live == inputs
                && floor.newest(COUNTER).is_some_and(|newest| newest.value == Variant::from(count))
        })
        .await;
        returns.push((fault.kind(), took));
    }
    show(stack, seed, &returns);
    // No value of another node was ever taken for the counter's.
    let is_counter = |value: &Variant| matches!(value, Variant::Scalar(Scalar::Int32(_)));
    let heard = floor.heard(COUNTER);
    assert!(heard.iter().all(|heard| heard.value.is_null() || is_counter(&heard.value)));
}

/// Shows how long the returns took.
#[allow(clippy::print_stdout, reason = "`make foreign-kills` shows it")]
fn show(stack: Stack, seed: u64, returns: &[(&str, Duration)]) {
    println!("{stack:?}, seed {seed}: until all {SMALL_VARIABLES} inputs were live again");
    for kind in KINDS {
        let mut times: Vec<_> =
            returns.iter().filter(|(of, _)| *of == kind).map(|(_, took)| took).collect();
        times.sort();
        let Some(last) = times.len().checked_sub(1) else { continue };
        let at = |part: usize| times[last * part / 100];
        println!(
            "  {kind} {} times: median {:.2?}, 90 % {:.2?}, 99 % {:.2?}, longest {:.2?}",
            times.len(),
            at(50),
            at(90),
            at(99),
            times[last],
        );
    }
}

/// Faults of each kind, with a freeze that is noticed as silence and one that is not.
const USUAL: [ServerFault; 5] = [
    ServerFault::Kill,
    ServerFault::Freeze(Duration::from_millis(1500)),
    ServerFault::Freeze(Duration::from_secs(7)),
    ServerFault::Move,
    ServerFault::Kill,
];

#[tokio::test]
async fn asyncua_is_live_again_through_kills_freezes_and_moves() {
    is_live_after_each(Stack::Asyncua, 1000, &USUAL).await;
}

#[tokio::test]
async fn node_opcua_is_live_again_through_kills_freezes_and_moves() {
    is_live_after_each(Stack::NodeOpcua, 500, &USUAL).await;
}

#[tokio::test]
async fn open62541_is_live_again_through_kills_freezes_and_moves() {
    let outlives_the_session = [ServerFault::Freeze(Duration::from_secs(32)), ServerFault::Move];
    is_live_after_each(Stack::Open62541, 500, &[&USUAL[..], &outlives_the_session[..]].concat())
        .await;
}

/// A machine that loads a program lets clients in and shows them nothing: each attempt gives its place back.
#[tokio::test]
async fn attempts_while_a_controller_starts_do_not_fill_it() {
    let mut peer = Peer::small(Stack::Open62541, 500).await;
    peer.set(r#"{"starting": true}"#).await;
    let begun = Instant::now();
    until("it has heard that", || begun.elapsed() > Duration::from_secs(1)).await;
    let floor = TestShopFloor::start();
    let source = peer.source();
    let id = source.source_id.clone();
    floor.handle.put_source(source).expect("valid");
    floor.monitor(COUNTER, &id, peer.node(node_number(COUNTER)));
    let is_refused = || {
        let problem = floor.status(&id).problem;
        problem.is_some_and(|problem| problem.kind == SourceProblemKind::Refused)
    };
    until("it is refused", is_refused).await;
    // More attempts than there are places.
    let begun = Instant::now();
    until("some attempts", || begun.elapsed() > Duration::from_secs(6)).await;
    assert!(is_refused(), "{:?}", floor.status(&id).problem);
    peer.set(r#"{"starting": false, "counter": 7}"#).await;
    within(RETURN_MAX, "it is live when it has started", || {
        floor.newest(COUNTER).is_some_and(|newest| newest.value == Variant::from(7_i32))
    })
    .await;
}

/// A session that is given up keeps its place at the server until it is closed there.
#[tokio::test]
async fn sessions_that_were_given_up_do_not_fill_a_controller_with_room_for_three() {
    let mut peer = Peer::small(Stack::Open62541, 500).await;
    let floor = TestShopFloor::start();
    let mut source = peer.source();
    source.silence_ms_max = 1500;
    let id = floor.connect_to(source).await;
    floor.monitor(COUNTER, &id, peer.node(node_number(COUNTER)));
    until("it is live", || floor.status(&id).live == 1).await;
    for count in 1..=6_i32 {
        peer.freeze().await;
        until("its silence is noticed", || {
            let status = floor.status(&id);
            status.state != SourceState::Connected
                && status.problem.is_some_and(|problem| problem.kind == SourceProblemKind::Stalled)
        })
        .await;
        peer.thaw().await;
        peer.set(&format!(r#"{{"counter": {count}}}"#)).await;
        within(RETURN_MAX, &format!("it is live after freeze {count}"), || {
            floor.newest(COUNTER).is_some_and(|newest| newest.value == Variant::from(count))
        })
        .await;
    }
}
