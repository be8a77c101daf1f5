//! Servers come and go, change their minds or fall silent.

use std::time::Duration;

use asi_model::{StatusCode, Variant};
use shop_floor::{SourceProblemKind, SourceState};
use simulator::{Layout, MachineConfig, MachineFault, MachineHandle, MachineKind};

use crate::support::{Simulation, TestShopFloor, node, until, within};

const KEYS: [&str; 5] = [
    "Production.PartCounter",
    "Status.StateText",
    "Spindle.Temperature",
    "Energy.Power",
    "Axes.Loads",
];

/// A cell with inputs 0 to 4 on its [`KEYS`], all live.
async fn watched_cell() -> (Simulation, MachineHandle, TestShopFloor, shop_floor::SourceId) {
    watched_cell_with_silence(1000).await
}

async fn watched_cell_with_silence(
    ms: u32,
) -> (Simulation, MachineHandle, TestShopFloor, shop_floor::SourceId) {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect_with_silence(&cell, ms).await;
    for (input, key) in (0..).zip(KEYS) {
        floor.monitor(input, &source, node(&cell, key));
    }
    until("all are live", || floor.status(&source).live == KEYS.len()).await;
    (simulation, cell, floor, source)
}

/// Sets a value and waits for it.
async fn proves_to_be_live(cell: &MachineHandle, floor: &TestShopFloor, value: u32) {
    cell.set("Production.PartCounter", value).await.expect("set");
    floor.until_value(0, value).await;
}

#[tokio::test]
async fn a_killed_server_is_reported_to_all_inputs_and_found_again_within_five_seconds() {
    let (_simulation, cell, floor, source) = watched_cell().await;
    cell.inject(MachineFault::Kill).await.expect("killed");
    for input in 0..KEYS.len() as u64 {
        floor.until_status(input, StatusCode::BAD_NOT_CONNECTED).await;
    }
    until("the source waits", || floor.status(&source).state != SourceState::Connected).await;
    let status = floor.status(&source);
    assert_eq!((status.live, status.not_live.len()), (0, KEYS.len()));
    assert!(status.problem.is_some());

    cell.inject(MachineFault::Restart { layout: Layout::default(), down_ms: 0 })
        .await
        .expect("back");
    within(Duration::from_secs(5), "all are live again", || {
        floor.status(&source).live == KEYS.len()
    })
    .await;
    proves_to_be_live(&cell, &floor, 9001).await;
    assert_eq!(floor.status(&source).sessions, 2);
}

#[tokio::test]
async fn cut_connections_are_made_again() {
    let (_simulation, cell, floor, source) = watched_cell().await;
    for round in 0..3 {
        cell.inject(MachineFault::DropConnections).await.expect("cut");
        until("a new session", || floor.status(&source).sessions == round + 2).await;
        within(Duration::from_secs(5), "all are live again", || {
            floor.status(&source).live == KEYS.len()
        })
        .await;
    }
    proves_to_be_live(&cell, &floor, 9002).await;
}

/// Killed, cut off and restarted with other indexes and ids, a hundred times in a seeded order.
#[tokio::test]
async fn a_hundred_faults_later_everything_is_live() {
    let (_simulation, cell, floor, source) = watched_cell().await;
    until("all paths are learned", || floor.status(&source).findable == KEYS.len()).await;
    let seed = 20_261_121;
    for round in 0..100_u32 {
        let dice = simulator::signals::hash(seed, 0, u64::from(round));
        let sessions = floor.status(&source).sessions;
        let layout = Layout {
            namespaces_before: (dice >> 8) as u16 % 4,
            renumbered: (dice >> 16) as u32 % 3,
        };
        match dice % 3 {
            0 => cell.inject(MachineFault::DropConnections).await,
            1 => cell.inject(MachineFault::Restart { layout, down_ms: 0 }).await,
            _ => {
                cell.inject(MachineFault::Kill).await.expect("killed");
                floor.until_status(0, StatusCode::BAD_NOT_CONNECTED).await;
                cell.inject(MachineFault::Restart { layout, down_ms: (dice >> 24) % 100 }).await
            }
        }
        .unwrap_or_else(|error| panic!("round {round} of seed {seed}: {error}"));
        cell.set("Production.PartCounter", round).await.expect("set");
        let what = format!("all live in round {round} of seed {seed}");
        within(Duration::from_secs(5), &what, || {
            let status = floor.status(&source);
            status.sessions > sessions && status.live == KEYS.len()
        })
        .await;
        floor.until_value(0, round).await;
    }
}

#[tokio::test]
async fn other_namespace_indexes_after_a_restart_do_not_matter() {
    let (_simulation, cell, floor, source) = watched_cell().await;
    let before = floor.status(&source).sessions;
    let layout = Layout { namespaces_before: 3, renumbered: 0 };
    cell.inject(MachineFault::Restart { layout, down_ms: 0 }).await.expect("back");
    until("a new session", || floor.status(&source).sessions > before).await;
    within(Duration::from_secs(5), "all are live again", || {
        floor.status(&source).live == KEYS.len()
    })
    .await;
    proves_to_be_live(&cell, &floor, 9003).await;
}

#[tokio::test]
async fn renumbered_nodes_are_found_at_their_browse_paths() {
    let mut robot = MachineConfig::new("Robot1", MachineKind::Robot);
    robot.asset_id = Some("eDO".into());
    let simulation =
        Simulation::of(vec![MachineConfig::new("Cell", MachineKind::MillingCell), robot]).await;
    let (cell, robot) = (simulation.machine("Cell"), simulation.machine("Robot1"));
    let floor = TestShopFloor::start();
    let (cell_source, robot_source) = (floor.connect(&cell).await, floor.connect(&robot).await);
    floor.monitor(0, &cell_source, node(&cell, "Production.PartCounter"));
    let key = "Controllers.Controller1.TaskControls.TaskControl1.ParameterSet.TaskProgramName";
    let old = node(&robot, key);
    floor.monitor(1, &robot_source, old.clone());
    robot.set(key, "BEFORE").await.expect("set");
    floor.until_value(1, "BEFORE").await;
    for source in [&cell_source, &robot_source] {
        until("its path is learned", || floor.status(source).findable == 1).await;
    }

    for machine in [&cell, &robot] {
        let layout = Layout { namespaces_before: 2, renumbered: 1 };
        machine.inject(MachineFault::Restart { layout, down_ms: 0 }).await.expect("back");
    }
    assert_ne!(node(&robot, key), old);
    cell.set("Production.PartCounter", 31_u32).await.expect("set");
    robot.set(key, "AFTER").await.expect("set");
    // The robot's old number names another node now; its values must never be taken for ours.
    floor.until_value(1, "AFTER").await;
    floor.until_value(0, 31_u32).await;
    let strangers: Vec<_> = floor
        .heard(1)
        .into_iter()
        .map(|heard| heard.value)
        .filter(|value| !value.is_null() && value.as_str().is_none())
        .collect();
    assert_eq!(strangers, Vec::<Variant>::new());
}

#[tokio::test]
async fn a_connection_that_looks_green_but_delivers_nothing_is_recovered() {
    let (_simulation, cell, floor, source) = watched_cell().await;
    proves_to_be_live(&cell, &floor, 1).await;
    cell.inject(MachineFault::StallSubscriptions).await.expect("stalled");
    let sessions = floor.status(&source).sessions;
    cell.set("Production.PartCounter", 2_u32).await.expect("set");
    let took = within(Duration::from_secs(10), "a new session", || {
        floor.status(&source).sessions > sessions
    })
    .await;
    assert!(
        took > Duration::from_millis(500),
        "one look is not enough to call it stalled: {took:?}"
    );
    floor.until_value(0, 2_u32).await;
    proves_to_be_live(&cell, &floor, 3).await;
}

#[tokio::test]
async fn an_idle_machine_is_not_taken_for_stalled() {
    // Long enough that a busy computer is not taken for a silent server.
    let (_simulation, cell, floor, source) = watched_cell_with_silence(3000).await;
    cell.inject(MachineFault::StopUpdating).await.expect("at rest");
    let begun = std::time::Instant::now();
    until("some rounds of the audit", || begun.elapsed() > Duration::from_secs(8)).await;
    assert_eq!(floor.status(&source).sessions, 1);
    assert_eq!(floor.status(&source).state, SourceState::Connected);
}

#[tokio::test]
async fn a_network_that_swallows_everything_is_noticed() {
    let (_simulation, cell, floor, source) = watched_cell().await;
    cell.inject(MachineFault::HangNetwork).await.expect("hangs");
    until("it is noticed", || {
        floor
            .status(&source)
            .problem
            .is_some_and(|problem| problem.kind == SourceProblemKind::Stalled)
    })
    .await;
    floor.until_status(0, StatusCode::BAD_NOT_CONNECTED).await;
    cell.inject(MachineFault::None).await.expect("healed");
    within(Duration::from_secs(8), "all are live again", || {
        floor.status(&source).live == KEYS.len()
    })
    .await;
    proves_to_be_live(&cell, &floor, 9004).await;
}

#[tokio::test]
async fn the_machines_statuses_and_wrong_clocks_are_passed_on() {
    let (_simulation, cell, floor, _source) = watched_cell().await;
    let failure = StatusCode::BAD_DEVICE_FAILURE;
    cell.inject(MachineFault::BadStatus { status: failure.0, variable: None }).await.expect("bad");
    floor.until_status(0, failure).await;
    cell.inject(MachineFault::None).await.expect("healed");
    floor.until_status(0, StatusCode::GOOD).await;

    let two_hours = 7_200_000;
    cell.inject(MachineFault::WrongClock { ahead_ms: two_hours }).await.expect("wrong");
    let at = cell.set("Production.PartCounter", 77_u32).await.expect("set");
    let arrived = floor.until_value(0, 77_u32).await;
    assert_eq!(arrived.source_timestamp, Some(at), "source times are not corrected");
    let now = asi_model::DateTime::from(std::time::SystemTime::now());
    assert!(at.since(now) > Duration::from_secs(7000));
}

#[tokio::test]
async fn a_removed_source_is_reported_to_its_inputs_and_comes_back() {
    let (_simulation, cell, floor, source) = watched_cell().await;
    floor.handle.remove_source(&source);
    floor.until_status(0, StatusCode::BAD_NOT_CONNECTED).await;
    assert!(floor.handle.states().is_empty());
    floor.connect(&cell).await;
    within(Duration::from_secs(5), "all are live again", || {
        floor.status(&source).live == KEYS.len()
    })
    .await;
}

#[tokio::test]
async fn a_source_without_inputs_stays_connected() {
    let (_simulation, cell, floor, source) = watched_cell().await;
    for input in 0..KEYS.len() as u64 {
        floor.handle.unmonitor(shop_floor::InputKey(input));
    }
    until("nothing is wanted", || floor.status(&source).inputs == 0).await;
    let begun = std::time::Instant::now();
    until("some times the allowed silence", || begun.elapsed() > Duration::from_secs(4)).await;
    assert_eq!(floor.status(&source).sessions, 1);
    floor.monitor(0, &source, node(&cell, KEYS[0]));
    proves_to_be_live(&cell, &floor, 5).await;
}
