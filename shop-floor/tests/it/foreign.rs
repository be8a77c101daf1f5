//! Other people's servers: asyncua and node-opcua, killed and restarted with other ids, protected
//! and not.

use std::time::{Duration, Instant};

use asi_model::{
    DataValue, Scalar, StatusCode, Variant,
    values::{ExtensionBody, StructureValue},
};
use shop_floor::{InputKey, MonitorOptions, SourceId, SourceProblemKind, TrustState};

use crate::{
    peer::{Peer, Stack},
    support::{TestShopFloor, until, within},
};

const COUNTER: u64 = 1;
const TEMPERATURE: u64 = 2;
const TEXT: u64 = 3;
const POWER: u64 = 4;

fn structure(value: Option<DataValue>) -> Option<StructureValue> {
    match value?.value {
        Variant::Scalar(Scalar::ExtensionObject(object)) => match object.body {
            ExtensionBody::Structure(structure) => Some(structure),
            _ => None,
        },
        _ => None,
    }
}

fn monitor_all(floor: &TestShopFloor, source: &SourceId, peer: &Peer) {
    for input in [COUNTER, TEMPERATURE, TEXT, POWER] {
        floor.monitor(input, source, peer.node(u32::try_from(input).expect("small")));
    }
}

/// Values, structures and types arrive, and after each of some kills all is live again within 5 s.
async fn is_a_good_source(stack: Stack, restarts: u32) {
    let mut peer = Peer::start(stack, false).await;
    let floor = TestShopFloor::start();
    let source = peer.source();
    let id = source.source_id.clone();
    floor.handle.put_source(source).expect("valid");
    floor.until_connected(&id).await;
    monitor_all(&floor, &id, &peer);
    until("all are live", || floor.status(&id).live == 4).await;
    peer.set(r#"{"counter": 7, "temperature": 21.25, "text": "running"}"#).await;
    let counter = floor.until_value(COUNTER, 7_i32).await;
    assert!(counter.source_timestamp.is_some());
    floor.until_value(TEMPERATURE, 21.25).await;
    floor.until_value(TEXT, "running").await;
    until("a decoded structure", || structure(floor.newest(POWER)).is_some()).await;
    let power = structure(floor.newest(POWER)).expect("it was just there");
    assert_eq!(power.fields["Watts"], Variant::from(812.5));

    let found = floor.handle.search(&id, "temper", 10).await.expect("search");
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].node_id, peer.node(2));
    assert_eq!(
        found[0].browse_path.as_ref().map(ToString::to_string).as_deref(),
        Some("Machine/Temperature")
    );
    until("all paths are learned", || floor.status(&id).findable == 4).await;

    for round in 1..=restarts {
        peer.kill().await;
        floor.until_status(COUNTER, StatusCode::BAD_NOT_CONNECTED).await;
        peer.restart(round % 3, round).await;
        let returned = Instant::now();
        let number = i32::try_from(round).expect("few rounds");
        peer.set(&format!(r#"{{"counter": {number}, "text": "round {round}"}}"#)).await;
        within(Duration::from_secs(5), "all are live again", || floor.status(&id).live == 4).await;
        floor.until_value(COUNTER, number).await;
        floor.until_value(TEXT, format!("round {round}").as_str()).await;
        assert!(returned.elapsed() < Duration::from_secs(5), "{:?}", returned.elapsed());
    }
    // No value of another node was ever taken for the counter's.
    let is_counter = |value: &DataValue| {
        value.value.is_null() || matches!(value.value, Variant::Scalar(Scalar::Int32(_)))
    };
    assert!(floor.heard(COUNTER).iter().all(is_counter));
}

/// While nobody was connected the server got other indexes and ids; what was kept with the mapping
/// finds the variable.
async fn is_found_by_the_path_that_was_kept(stack: Stack) {
    let mut peer = Peer::start(stack, false).await;
    let id = peer.source().source_id;
    let path = {
        let floor = TestShopFloor::start();
        floor.handle.put_source(peer.source()).expect("valid");
        floor.until_connected(&id).await;
        floor.handle.browse_path(&id, &peer.node(1)).await.expect("a path")
    };
    peer.restart(2, 5).await;
    let floor = TestShopFloor::start();
    floor.handle.put_source(peer.source()).expect("valid");
    let options = MonitorOptions { browse_path: Some(path), ..MonitorOptions::default() };
    floor
        .handle
        .monitor(InputKey(COUNTER), id.clone(), peer.node(1), options)
        .expect("a valid request");
    peer.set(r#"{"counter": 41}"#).await;
    floor.until_value(COUNTER, 41_i32).await;
    assert!(floor.heard(COUNTER).iter().all(|value| {
        value.value.is_null() || matches!(value.value, Variant::Scalar(Scalar::Int32(_)))
    }));
}

#[tokio::test]
async fn asyncua_variables_are_found_by_paths_kept_from_before() {
    is_found_by_the_path_that_was_kept(Stack::Asyncua).await;
}

#[tokio::test]
async fn node_opcua_variables_are_found_by_paths_kept_from_before() {
    is_found_by_the_path_that_was_kept(Stack::NodeOpcua).await;
}

async fn is_a_good_protected_source(stack: Stack) {
    let mut peer = Peer::start(stack, true).await;
    let floor = TestShopFloor::start();
    let source = peer.source();
    let id = source.source_id.clone();
    floor.handle.put_source(source).expect("valid");
    let kind = SourceProblemKind::ServerCertificateUntrusted;
    until("the certificate is shown", || {
        floor.status(&id).problem.is_some_and(|problem| problem.kind == kind)
    })
    .await;
    let shown = floor.handle.certificates().await.expect("certificates");
    floor.handle.set_trust(&shown[0].thumbprint, TrustState::Trusted).await.expect("approved");
    floor.until_connected(&id).await;
    monitor_all(&floor, &id, &peer);
    peer.set(r#"{"counter": 12}"#).await;
    floor.until_value(COUNTER, 12_i32).await;
    until("a decoded structure", || structure(floor.newest(POWER)).is_some()).await;
}

#[tokio::test]
async fn asyncua_is_a_good_source_through_kills_and_renumbering() {
    is_a_good_source(Stack::Asyncua, 4).await;
}

#[tokio::test]
async fn node_opcua_is_a_good_source_through_kills_and_renumbering() {
    is_a_good_source(Stack::NodeOpcua, 3).await;
}

#[tokio::test]
async fn asyncua_is_a_good_source_with_protection_and_a_user() {
    is_a_good_protected_source(Stack::Asyncua).await;
}

#[tokio::test]
async fn node_opcua_is_a_good_source_with_protection_and_a_user() {
    is_a_good_protected_source(Stack::NodeOpcua).await;
}
