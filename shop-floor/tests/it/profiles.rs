//! Profiles of servers that plants have: on simulated machines with their limits, and in the documentation.

use std::{fs, path::Path};

use shop_floor::ServerProfile;
use shop_floor_model::ProfileLimit as Limit;
use simulator::{MachineConfig, MachineKind};

use crate::support::{Simulation, TestShopFloor, node, unprotected, until};

const COUNTER: &str = "Production.PartCounter";

#[tokio::test]
async fn each_family_is_recognised_and_delivers_at_the_advised_intervals() {
    let machine = |profile: &ServerProfile| {
        let mut config = MachineConfig::new(&profile.family, MachineKind::MillingCell);
        config.profile = Some(profile.family.clone());
        config
    };
    let simulation = Simulation::of(ServerProfile::all().iter().map(machine).collect()).await;
    let floor = TestShopFloor::start();
    for (input, profile) in (0..).zip(ServerProfile::all()) {
        let cell = simulation.machine(&profile.family);
        let mut source = unprotected(&cell);
        source.publishing_interval_ms = profile.advised.publishing_interval_ms;
        source.sampling_interval_ms = Some(profile.advised.sampling_interval_ms);
        let id = floor.connect_to(source).await;
        floor.monitor(input, &id, node(&cell, COUNTER));
        until("it is live", || floor.status(&id).live == 1).await;
        let status = floor.status(&id);
        assert_eq!(status.family.as_deref(), Some(profile.family.as_str()));
        let granted = status.granted.expect("a subscription").publishing_ms;
        let least = profile.limit(Limit::PublishingIntervalMsMin).unwrap_or(0);
        assert!(granted >= u64::from(least), "{}: {granted} ms", profile.family);
        if let Some(most) = profile.limit(Limit::NodesPerCallMax) {
            let limits = status.limits.expect("limits");
            assert_eq!(limits.items_per_call_max, Some(most), "{}", profile.family);
        }
        assert!(status.coarse.is_empty(), "{}: {:?}", profile.family, status.coarse);
        cell.set(COUNTER, 7_u32).await.expect("set");
        floor.until_value(input, 7_u32).await;
    }
}

#[test]
fn each_family_has_a_page_with_all_that_is_known() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/machines");
    let read = |name: &str| {
        let path = folder.join(name);
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    let index = read("README.md");
    for profile in ServerProfile::all() {
        let file = format!("{}.md", profile.family);
        assert!(index.contains(&format!("({file})")), "{file} is not in the list");
        let page = read(&file);
        assert!(page.starts_with(&format!("# {}\n", profile.name)), "{file}");
        let has = |parts: &[&str]| {
            let is_there = page.lines().any(|line| parts.iter().all(|part| line.contains(part)));
            assert!(is_there, "{file} does not say {parts:?}");
        };
        for figure in &profile.figures {
            has(&[&format!("| {}", figure.value), &figure.source]);
        }
        for note in profile.expected.iter().chain(&profile.settings) {
            has(&[&note.en, &note.source]);
        }
        let advised = profile.advised;
        has(&[
            &format!("publishing interval {} ms", advised.publishing_interval_ms),
            &format!("sampling interval {} ms", advised.sampling_interval_ms),
        ]);
        let lines = page.lines().filter(|line| line.starts_with("- ") || line.starts_with("| "));
        let notes = profile.figures.len() + profile.expected.len() + profile.settings.len();
        let heads = if profile.figures.is_empty() { 0 } else { 1 };
        assert_eq!(lines.count(), notes + heads, "{file} says more than is known");
    }
}
