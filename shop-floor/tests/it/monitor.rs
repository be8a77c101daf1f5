//! Values, statuses and times as the machine has them.

use asi_model::{
    DataValue, NodeId, Scalar, StatusCode, Variant,
    values::{ExtensionBody, StructureValue},
};
use shop_floor::{InputKey, MonitorOptions, MonitorRequest, ShopFloorError, SourceId};
use simulator::{MachineConfig, MachineKind};

use crate::support::{Simulation, TestShopFloor, node, until};

#[tokio::test]
async fn a_change_arrives_with_value_status_and_source_time() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;
    floor.monitor(1, &source, node(&cell, "Production.PartCounter"));
    until("a first value", || floor.newest(1).is_some_and(|value| value.status.is_good())).await;

    let at = cell.set("Production.PartCounter", 4711_u32).await.expect("set");
    let arrived = floor.until_value(1, 4711_u32).await;
    assert_eq!(arrived.source_timestamp, Some(at));
    assert_eq!(arrived.status, StatusCode::GOOD);

    let sensor = StatusCode::BAD_SENSOR_FAILURE;
    cell.set_with_status("Production.PartCounter", 4711_u32, sensor).await.expect("set");
    floor.until_status(1, sensor).await;

    let status = floor.status(&source);
    assert_eq!(status.inputs, 1);
    assert_eq!(status.live, 1);
    assert_eq!(status.not_live.len(), 0);
    assert!(
        status.changes >= 3 && status.last_change_at.is_some() && status.clock_ahead_ms.is_some()
    );
}

#[tokio::test]
async fn every_change_between_two_publishings_arrives_in_order() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;
    let options = MonitorOptions { sampling_interval_ms: Some(0.0), ..MonitorOptions::default() };
    let counter = node(&cell, "Production.TotalParts");
    floor.handle.monitor(InputKey(1), source, counter, options).expect("valid");
    until("a first value", || floor.newest(1).is_some_and(|value| value.status.is_good())).await;
    // Above 2^53, where a double would lose the last digit.
    let first = (1_u64 << 60) + 1;
    for step in 0..8 {
        cell.set("Production.TotalParts", first + step).await.expect("set");
    }
    floor.until_value(1, first + 7).await;
    let heard: Vec<_> = floor
        .heard(1)
        .into_iter()
        .filter_map(|value| value.value.as_scalar().and_then(Scalar::as_i128))
        .filter(|value| *value >= i128::from(first))
        .collect();
    assert_eq!(heard, (0..8).map(|step| i128::from(first + step)).collect::<Vec<_>>());
}

#[tokio::test]
async fn structures_come_decoded_and_arrays_in_parts() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;
    floor.monitor(1, &source, node(&cell, "Energy.Power"));
    let part = MonitorOptions { index_range: Some("1:2".into()), ..MonitorOptions::default() };
    floor
        .handle
        .monitor(InputKey(2), source.clone(), node(&cell, "Axes.Loads"), part)
        .expect("valid");

    let structure = |value: &DataValue| -> Option<StructureValue> {
        match value.value.as_scalar()? {
            Scalar::ExtensionObject(object) => match &object.body {
                ExtensionBody::Structure(structure) => Some(structure.clone()),
                _ => None,
            },
            _ => None,
        }
    };
    until("a decoded structure", || floor.newest(1).as_ref().and_then(structure).is_some()).await;
    let undecoded = floor
        .heard(1)
        .iter()
        .filter(|value| value.status.is_good() && structure(value).is_none())
        .count();
    assert_eq!(undecoded, 0, "a structure is held back until its type is known");
    let power = structure(&floor.newest(1).expect("heard")).expect("a structure");
    assert_eq!(power.fields["SecondsAggregated"], Variant::from(10_u32));
    assert!(power.fields["WattsAvg"].as_f64().is_some_and(|watts| watts > 0.0));

    until(
        "a part of the array",
        || matches!(floor.newest(2).map(|value| value.value), Some(Variant::Array(loads)) if loads.elements.len() == 2),
    )
    .await;
    let read = floor.handle.read(&source, &[node(&cell, "Energy.Power")]).await.expect("read");
    assert!(structure(&read[0]).is_some());
}

#[tokio::test]
async fn an_input_that_cannot_be_monitored_says_why() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;
    let namespace = cell.config().namespace_uri();
    floor.monitor(1, &source, NodeId::string(&namespace, "No.Such.Node"));
    floor.monitor(2, &source, NodeId::string("urn:another:machine", "Counter"));
    floor.monitor(3, &source, node(&cell, "Status.StateText"));
    floor.monitor(4, &SourceId::new("nowhere").expect("valid"), NodeId::ua(2258));
    floor.until_status(1, StatusCode::BAD_NODE_ID_UNKNOWN).await;
    floor.until_status(2, StatusCode::BAD_NODE_ID_UNKNOWN).await;
    floor.until_status(3, StatusCode::GOOD).await;
    floor.until_status(4, StatusCode::BAD_NOT_CONNECTED).await;

    let status = floor.status(&source);
    assert_eq!((status.inputs, status.live), (3, 1));
    let reasons: Vec<_> =
        status.not_live.iter().map(|problem| (problem.input.0, problem.reason.clone())).collect();
    assert_eq!(reasons.len(), 2, "{reasons:?}");
    assert!(reasons[0].1.contains("does not know this node"), "{reasons:?}");
    assert!(reasons[1].1.contains("no namespace \"urn:another:machine\""), "{reasons:?}");
}

#[tokio::test]
async fn many_inputs_share_few_subscriptions_and_all_become_live() {
    let mut bank = MachineConfig::new("Bank", MachineKind::Bank);
    (bank.variables, bank.changes_per_second) = (12_000, 20_000.0);
    let simulation = Simulation::of(vec![bank]).await;
    let bank = simulation.machine("Bank");
    let floor = TestShopFloor::start();
    let source = floor.connect(&bank).await;
    let requests = (0..12_000_u64).map(|index| MonitorRequest {
        input: InputKey(index),
        source: source.clone(),
        node_id: node(&bank, &format!("Counter{index}")),
        options: MonitorOptions::default(),
    });
    floor.handle.monitor_many(requests.collect()).expect("within the limits");
    until("all inputs are live", || floor.status(&source).live == 12_000).await;
    until("all inputs change", || (0..12_000).all(|input| floor.heard(input).len() > 2)).await;

    floor.handle.unmonitor_many(&(1..12_000).map(InputKey).collect::<Vec<_>>());
    until("one input is left", || floor.status(&source).live == 1).await;
    let before = floor.heard(0).len();
    until("the one left goes on", || floor.heard(0).len() > before).await;
}

#[tokio::test]
async fn a_small_server_is_filled_to_its_limits_and_the_rest_says_so() {
    let mut bank = MachineConfig::new("Bank", MachineKind::Bank);
    (bank.variables, bank.changes_per_second) = (100, 1000.0);
    (bank.items_per_subscription_max, bank.subscriptions_per_session_max) = (20, 3);
    let simulation = Simulation::of(vec![bank]).await;
    let bank = simulation.machine("Bank");
    let floor = TestShopFloor::start();
    let source = floor.connect(&bank).await;
    for index in 0..100 {
        floor.monitor(index, &source, node(&bank, &format!("Counter{index}")));
    }
    let limit = "the server's limit of monitored items is reached";
    until("three subscriptions are full and the rest knows why", || {
        let status = floor.status(&source);
        status.live == 60 && status.not_live.iter().all(|problem| problem.reason.contains(limit))
    })
    .await;
    let status = floor.status(&source);
    assert_eq!((status.inputs, status.not_live.len()), (100, 40));

    // Room is used as soon as there is some.
    let live: Vec<_> = (0..100)
        .filter(|input| status.not_live.iter().all(|problem| problem.input.0 != *input))
        .collect();
    floor
        .handle
        .unmonitor_many(&live[..40].iter().map(|input| InputKey(*input)).collect::<Vec<_>>());
    until("all that are left are live", || {
        let status = floor.status(&source);
        (status.inputs, status.live) == (60, 60)
    })
    .await;
}

#[tokio::test]
async fn values_are_written_and_methods_called() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect(&cell).await;
    let (order, counter) =
        (node(&cell, "Production.OrderId"), node(&cell, "Production.PartCounter"));
    floor.monitor(1, &source, order.clone());
    let value = |text: &str| DataValue { value: text.into(), ..DataValue::default() };
    let statuses = floor
        .handle
        .write(
            &source,
            &[
                (order.clone(), value("4711")),
                (counter, value("7")),
                (NodeId::string("urn:x", "y"), value("1")),
            ],
        )
        .await
        .expect("the server answers");
    assert_eq!(statuses[0], StatusCode::GOOD);
    assert!(statuses[1].is_bad(), "{:?}", statuses[1]);
    assert_eq!(statuses[2], StatusCode::BAD_NODE_ID_UNKNOWN);
    floor.until_value(1, "4711").await;

    let namespace = cell.config().namespace_uri();
    let (object, method) = (
        NodeId::string(&namespace, "Production"),
        NodeId::string(&namespace, "Production.StartJob"),
    );
    let inputs = ["4712".into(), 12_u32.into()];
    let outcome =
        floor.handle.call(&source, &object, &method, &inputs).await.expect("the server answers");
    assert_eq!((outcome.status, outcome.outputs), (StatusCode::GOOD, vec![true.into()]));
    floor.until_value(1, "4712").await;

    let unknown = SourceId::new("nowhere").expect("valid");
    assert_eq!(floor.handle.read(&unknown, &[]).await, Err(ShopFloorError::UnknownSource(unknown)));
}
