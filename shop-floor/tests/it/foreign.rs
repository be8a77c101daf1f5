//! Other people's servers: asyncua and node-opcua, killed and restarted with other ids, protected
//! and not.

use std::time::{Duration, Instant};

use asi_model::{
    DataValue, NodeId, Scalar, StatusCode, Variant,
    values::{ExtensionBody, LocalizedText, StructureValue},
};
use shop_floor::{
    EventSelection, EventValue, InputKey, MonitorOptions, SourceId, SourceProblemKind, TrustState,
};

use crate::{
    events::{field, selection},
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

/// The Server object, which all events of a server come to.
const SERVER: NodeId = NodeId::ua(2253);
/// Inputs that take events.
const MESSAGE: u64 = 11;
const CONDITIONS: u64 = 12;
const SEVERITY: u64 = 13;

#[tokio::test]
async fn asyncua_events_make_values_and_its_conditions_are_uncertain() {
    let mut peer = Peer::start(Stack::Asyncua, false).await;
    let floor = TestShopFloor::start();
    let id = floor.connect_to(peer.source()).await;
    let severe = EventSelection { severity_min: Some(500), ..selection(field("Message")) };
    floor.monitor_events(MESSAGE, &id, SERVER, severe);
    floor.until_status(MESSAGE, StatusCode::BAD_WAITING_FOR_INITIAL_DATA).await;
    peer.set(r#"{"event": {"message": "a part is done", "severity": 100}}"#).await;
    peer.set(r#"{"event": {"message": "the door is open", "severity": 700}}"#).await;
    let message = |text: &str| {
        let text = LocalizedText { locale: None, text: Some(text.into()) };
        Variant::Scalar(Scalar::LocalizedText(Box::new(text)))
    };
    let arrived = floor.until_value(MESSAGE, message("the door is open")).await;
    assert!(arrived.status.is_good() && arrived.source_timestamp.is_some());
    assert!(floor.heard(MESSAGE).iter().all(|value| value.value != message("a part is done")));

    // It cannot name conditions that were active before.
    floor.monitor_events(CONDITIONS, &id, SERVER, selection(EventValue::ActiveConditions));
    floor.until_status(CONDITIONS, StatusCode::UNCERTAIN_INITIAL_VALUE).await;
    assert_eq!(floor.newest(CONDITIONS).map(|value| value.value), Some(0_u32.into()));
}

#[tokio::test]
async fn node_opcua_conditions_are_right_after_each_connection() {
    let mut peer = Peer::start(Stack::NodeOpcua, false).await;
    let floor = TestShopFloor::start();
    let id = floor.connect_to(peer.source()).await;
    floor.monitor(TEMPERATURE, &id, peer.node(2));
    peer.set(r#"{"temperature": 95}"#).await;
    floor.until_value(TEMPERATURE, 95.0).await;
    // Active before anything listened to it.
    floor.monitor_events(CONDITIONS, &id, SERVER, selection(EventValue::ActiveConditions));
    floor.monitor_events(SEVERITY, &id, SERVER, selection(EventValue::ActiveSeverity));
    assert_eq!(floor.until_value(CONDITIONS, 1_u32).await.status, StatusCode::GOOD);
    until("a severity", || {
        let severity = floor.newest(SEVERITY).and_then(|value| value.value.as_f64());
        severity.is_some_and(|severity| severity > 0.0)
    })
    .await;
    peer.set(r#"{"temperature": 20}"#).await;
    floor.until_value(CONDITIONS, 0_u32).await;
    floor.until_value(SEVERITY, 0_u16).await;
    peer.set(r#"{"temperature": 5}"#).await;
    floor.until_value(CONDITIONS, 1_u32).await;

    // A field that no event of this server has.
    floor.monitor_events(MESSAGE, &id, SERVER, selection(field("NoSuchField")));
    until("the field is said to be unknown", || {
        let problems = floor.status(&id).not_live;
        problems.iter().any(|one| one.reason.contains("does not know a field of the events"))
    })
    .await;

    // Begun again, it has no alarm.
    peer.kill().await;
    floor.until_status(CONDITIONS, StatusCode::BAD_NOT_CONNECTED).await;
    peer.restart(1, 0).await;
    assert_eq!(floor.until_value(CONDITIONS, 0_u32).await.status, StatusCode::GOOD);
}
