//! Servers that grant what ordinary controllers grant: slow publishing, slow sampling, short queues.

use std::time::{Duration, Instant};

use shop_floor::{SourceId, SourceState};
use simulator::{MachineConfig, MachineFault, MachineHandle, MachineKind};

use crate::support::{Simulation, TestShopFloor, node, unprotected, until};

const COUNTER: &str = "Production.PartCounter";

/// A machine whose server grants nothing faster, and a source on it that is given up after so long a
/// silence.
async fn controller(
    change: impl FnOnce(&mut MachineConfig),
    silence_ms_max: u32,
) -> (Simulation, MachineHandle, TestShopFloor, SourceId) {
    let mut config = MachineConfig::new("Cell", MachineKind::MillingCell);
    change(&mut config);
    let simulation = Simulation::of(vec![config]).await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect_with_silence(&cell, silence_ms_max).await;
    floor.monitor(0, &source, node(&cell, COUNTER));
    until("it is live", || floor.status(&source).live == 1).await;
    (simulation, cell, floor, source)
}

#[tokio::test]
async fn a_controller_at_rest_that_publishes_slowly_is_not_taken_for_silent() {
    for publishing_ms in [100, 500, 1000] {
        let grants = |config: &mut MachineConfig| config.publishing_interval_ms_min = publishing_ms;
        let (_simulation, cell, floor, source) = controller(grants, 1500).await;
        cell.inject(MachineFault::StopUpdating).await.expect("at rest");
        let begun = Instant::now();
        until("some signs of life", || begun.elapsed() > Duration::from_secs(9)).await;
        let status = floor.status(&source);
        assert_eq!((status.sessions, status.state), (1, SourceState::Connected), "{publishing_ms}");
        let granted = status.granted.expect("a subscription");
        assert_eq!(granted.publishing_ms, u64::from(publishing_ms));
        assert!(granted.keep_alive_ms <= 2000, "{granted:?}");
        assert!(granted.silence_ms_max > granted.keep_alive_ms, "{granted:?}");
        assert!(status.coarse.is_empty(), "its queue holds what may come");
        cell.set(COUNTER, 7_u32).await.expect("set");
        floor.until_value(0, 7_u32).await;
    }
}

#[tokio::test]
async fn a_controller_that_publishes_more_rarely_than_it_is_looked_at_is_not_taken_for_stalled() {
    let grants = |config: &mut MachineConfig| config.publishing_interval_ms_min = 3000;
    let (_simulation, cell, floor, source) = controller(grants, 1000).await;
    let begun = Instant::now();
    for count in 100_u32.. {
        // Each read of the audit sees another value than the last that was published.
        cell.set(COUNTER, count).await.expect("set");
        tokio::time::sleep(Duration::from_millis(100)).await;
        if begun.elapsed() > Duration::from_secs(12) {
            break;
        }
    }
    assert_eq!(floor.status(&source).sessions, 1);
}

#[tokio::test]
async fn what_a_short_queue_loses_is_shown_with_the_input() {
    let grants = |config: &mut MachineConfig| {
        config.publishing_interval_ms_min = 500;
        config.sampling_interval_ms_min = 50;
        config.queue_size_max = 2;
    };
    let (_simulation, cell, floor, source) = controller(grants, 5000).await;
    for count in 100_u32..130 {
        cell.set(COUNTER, count).await.expect("set");
        tokio::time::sleep(Duration::from_millis(60)).await;
    }
    floor.until_value(0, 129_u32).await;
    until("the loss is shown", || {
        let coarse = floor.status(&source).coarse;
        coarse.iter().any(|input| input.input.0 == 0 && input.overflows > 0)
    })
    .await;
    let coarse = floor.status(&source).coarse;
    assert_eq!((coarse[0].sampling_ms, coarse[0].queue_size), (Some(50.0), Some(2)));
    let granted = floor.status(&source).granted.expect("a subscription");
    assert_eq!((granted.sampling_ms, granted.queue_size), (Some(50.0), Some(2)));
}

#[tokio::test]
async fn a_source_that_samples_as_seldom_as_its_server_publishes_needs_no_queue() {
    let mut config = MachineConfig::new("Cell", MachineKind::MillingCell);
    (config.publishing_interval_ms_min, config.queue_size_max) = (500, 1);
    let simulation = Simulation::of(vec![config]).await;
    let cell = simulation.machine("Cell");
    for (sampling_interval_ms, is_coarse) in [(None, true), (Some(500), false)] {
        let floor = TestShopFloor::start();
        let mut source = unprotected(&cell);
        source.sampling_interval_ms = sampling_interval_ms;
        let id = floor.connect_to(source).await;
        floor.monitor(0, &id, node(&cell, COUNTER));
        until("it is live", || floor.status(&id).live == 1).await;
        assert_eq!(!floor.status(&id).coarse.is_empty(), is_coarse, "{sampling_interval_ms:?}");
    }
}
