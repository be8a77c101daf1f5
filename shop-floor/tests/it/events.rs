//! Events and conditions as inputs.

use asi_model::{
    NodeId, Scalar, StatusCode, Variant,
    values::{LocalizedText, QualifiedName},
};
use shop_floor::{
    BrowsePath, EventSelection, EventValue, InputKey, MonitorOptions, ShopFloorError, SourceId,
};
use simulator::{MachineCondition, MachineFault, MachineHandle};

use crate::support::{Simulation, TestShopFloor, unprotected, until};

/// The Server object, which all events of a server come to.
const SERVER: NodeId = NodeId::ua(2253);

/// The last event's field in namespace 0.
pub fn field(name: &str) -> EventValue {
    let name = QualifiedName { name: Some(name.into()), ..QualifiedName::default() };
    EventValue::Field { path: BrowsePath(vec![name]) }
}

pub fn selection(value: EventValue) -> EventSelection {
    EventSelection { value, event_type: None, source_node: None, severity_min: None }
}

pub fn options(events: EventSelection) -> MonitorOptions {
    MonitorOptions { events: Some(Box::new(events)), ..MonitorOptions::default() }
}

/// A text as the simulator's messages have it.
pub fn message(text: &str) -> Variant {
    let text = LocalizedText { locale: Some("en".into()), text: Some(text.into()) };
    Variant::Scalar(Scalar::LocalizedText(Box::new(text)))
}

impl TestShopFloor {
    pub fn monitor_events(
        &self,
        input: u64,
        source: &SourceId,
        notifier: NodeId,
        events: EventSelection,
    ) {
        self.handle
            .monitor(InputKey(input), source.clone(), notifier, options(events))
            .expect("a valid request");
    }
}

fn alarm(message: &str, severity: u16) -> MachineCondition {
    let message = message.to_owned();
    MachineCondition { message, severity, is_active: true, is_acknowledged: true }
}

fn ended(message: &str, severity: u16) -> MachineCondition {
    MachineCondition { is_active: false, ..alarm(message, severity) }
}

async fn set(machine: &MachineHandle, name: &str, condition: MachineCondition) {
    machine.set_condition(name, condition).await.expect("a machine");
}

#[tokio::test]
async fn the_last_event_makes_the_value_with_its_time() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;
    let root = NodeId::string(&cell.config().namespace_uri(), "Machine");
    let severe = EventSelection { severity_min: Some(500), ..selection(field("Message")) };
    floor.monitor_events(1, &source, SERVER, severe);
    floor.monitor_events(2, &source, root.clone(), selection(field("Severity")));
    let of_another = EventSelection {
        source_node: Some(NodeId::ua(2253)),
        event_type: Some(NodeId::ua(2130)),
        ..selection(field("Message"))
    };
    floor.monitor_events(3, &source, root, of_another);
    for input in 1..=3 {
        floor.until_status(input, StatusCode::BAD_WAITING_FOR_INITIAL_DATA).await;
    }
    let waiting = floor.status(&source).not_live;
    assert_eq!(waiting.len(), 3);
    assert_eq!(waiting[0].reason, "waiting for the first event");

    cell.raise("a part is done", 100).await.expect("raised");
    floor.until_value(2, 100_u16).await;
    let at = cell.raise("the door is open", 700).await.expect("raised");
    let arrived = floor.until_value(1, message("the door is open")).await;
    assert_eq!((arrived.status, arrived.source_timestamp), (StatusCode::GOOD, Some(at)));
    floor.until_value(2, 700_u16).await;
    let severities: Vec<_> = floor.heard(2).into_iter().map(|value| value.value).collect();
    assert_eq!(
        severities[severities.len() - 2..],
        [Variant::from(100_u16), Variant::from(700_u16)]
    );
    assert!(
        floor.heard(1).iter().all(|value| value.value != message("a part is done")),
        "the server left out what is less severe"
    );
    assert_eq!(floor.newest(3).map(|value| value.status.is_bad()), Some(true));
    assert_eq!(floor.status(&source).live, 2);
}

#[tokio::test]
async fn the_last_event_outlives_a_connection_as_uncertain() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;
    floor.monitor_events(1, &source, SERVER, selection(field("Message")));
    floor.until_status(1, StatusCode::BAD_WAITING_FOR_INITIAL_DATA).await;
    let at = cell.raise("the door is open", 700).await.expect("raised");
    floor.until_value(1, message("the door is open")).await;

    cell.inject(MachineFault::DropConnections).await.expect("injected");
    floor.until_status(1, StatusCode::UNCERTAIN_LAST_USABLE_VALUE).await;
    let last = floor.newest(1).expect("it was just there");
    assert_eq!((last.value, last.source_timestamp), (message("the door is open"), Some(at)));
    cell.raise("the door is closed", 100).await.expect("raised");
    let next = floor.until_value(1, message("the door is closed")).await;
    assert_eq!(next.status, StatusCode::GOOD);
}

#[tokio::test]
async fn conditions_are_right_after_a_connection_and_each_change() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    set(&cell, "Oil", alarm("the oil is low", 400)).await;
    set(&cell, "Door", alarm("the door is open", 700)).await;
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;
    let severe =
        EventSelection { severity_min: Some(500), ..selection(EventValue::ActiveConditions) };
    floor.monitor_events(1, &source, SERVER, selection(EventValue::ActiveConditions));
    floor.monitor_events(2, &source, SERVER, selection(EventValue::ActiveSeverity));
    floor.monitor_events(3, &source, SERVER, selection(EventValue::ActiveMessage));
    floor.monitor_events(4, &source, SERVER, severe);
    assert_eq!(floor.until_value(1, 2_u32).await.status, StatusCode::GOOD);
    floor.until_value(2, 700_u16).await;
    floor.until_value(3, message("the door is open")).await;
    floor.until_value(4, 1_u32).await;
    let said: Vec<_> = floor.heard(1).into_iter().filter(|value| !value.status.is_bad()).collect();
    assert_eq!(said.len(), 1, "no number was said before all were named: {said:?}");

    // Less severe than is asked for, and no more of those.
    set(&cell, "Door", alarm("the door is ajar", 300)).await;
    floor.until_value(4, 0_u32).await;
    floor.until_value(2, 400_u16).await;
    floor.until_value(3, message("the oil is low")).await;
    set(&cell, "Door", ended("the door is closed", 300)).await;
    floor.until_value(1, 1_u32).await;

    // Conditions come and go while nobody listens.
    cell.inject(MachineFault::Kill).await.expect("injected");
    floor.until_status(1, StatusCode::BAD_NOT_CONNECTED).await;
    set(&cell, "Oil", ended("the oil is filled", 400)).await;
    set(&cell, "Tool", alarm("the tool is worn", 600)).await;
    set(&cell, "Air", alarm("the air is away", 800)).await;
    cell.inject(MachineFault::None).await.expect("healed");
    floor.until_value(1, 2_u32).await;
    floor.until_value(2, 800_u16).await;
    floor.until_value(3, message("the air is away")).await;
    floor.until_value(4, 2_u32).await;
}

#[tokio::test]
async fn lost_events_are_shown_with_their_input() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let mut source = unprotected(&cell);
    source.publishing_interval_ms = 1000;
    let source = floor.connect_to(source).await;
    let short = MonitorOptions { queue_size: Some(3), ..options(selection(field("Message"))) };
    floor.handle.monitor(InputKey(1), source.clone(), SERVER, short).expect("valid");
    floor.until_status(1, StatusCode::BAD_WAITING_FOR_INITIAL_DATA).await;
    for number in 0..40 {
        cell.raise(&format!("event {number}"), 100).await.expect("raised");
    }
    floor.until_value(1, message("event 39")).await;
    until("the overflow is shown", || {
        floor.status(&source).coarse.iter().any(|input| input.overflows > 0)
    })
    .await;
    assert!(floor.heard(1).len() < 40, "the queue holds three");
}

#[tokio::test]
async fn conditions_are_asked_for_again_when_events_were_lost() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let mut source = unprotected(&cell);
    source.publishing_interval_ms = 500;
    let source = floor.connect_to(source).await;
    let short =
        MonitorOptions { queue_size: Some(4), ..options(selection(EventValue::ActiveConditions)) };
    floor.handle.monitor(InputKey(1), source.clone(), SERVER, short).expect("valid");
    floor.until_value(1, 0_u32).await;
    // Both begin and end of many are lost between two publishings.
    for number in 0..20 {
        set(&cell, &format!("Alarm{number}"), alarm("an alarm", 500)).await;
    }
    for number in 1..20 {
        set(&cell, &format!("Alarm{number}"), ended("an alarm", 500)).await;
    }
    floor.until_value(1, 1_u32).await;
    assert!(floor.status(&source).coarse.iter().any(|input| input.overflows > 0));
}

#[tokio::test]
async fn events_that_cannot_be_had_say_why() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;
    // A variable has no events.
    let counter = cell.node_id("Production.PartCounter").expect("a counter");
    floor.monitor_events(1, &source, counter, selection(field("Message")));
    let elsewhere = EventSelection {
        source_node: Some(NodeId::string("urn:another:machine", "Ram")),
        ..selection(field("Message"))
    };
    floor.monitor_events(2, &source, SERVER, elsewhere);
    floor.until_status(2, StatusCode::BAD_NODE_ID_UNKNOWN).await;
    until("both are refused", || {
        let problems = floor.status(&source).not_live;
        problems.iter().any(|one| one.reason.contains("monitor events of this node"))
            && problems.iter().any(|one| one.reason.contains("urn:another:machine"))
    })
    .await;

    let check = |options: MonitorOptions| {
        let refused = floor.handle.monitor(InputKey(9), source.clone(), SERVER, options);
        assert!(matches!(refused, Err(ShopFloorError::Invalid(_))), "{refused:?}");
    };
    check(options(selection(EventValue::Field { path: BrowsePath::default() })));
    check(options(EventSelection { severity_min: Some(1001), ..selection(field("Message")) }));
    check(MonitorOptions {
        index_range: Some("1:2".into()),
        ..options(selection(EventValue::ActiveSeverity))
    });
}
