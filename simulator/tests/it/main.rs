//! The simulation through its library handle and its control interface.

#![allow(clippy::disallowed_methods, reason = "tests run by the machine's clock")]

use std::time::{Duration, Instant};

use asi_model::{DataValue, Scalar, StatusCode, Variant, values::BuiltInType};
use simulator::{
    Config, FailureConfig, MachineConfig, MachineFault, MachineKind, OrdersConfig, Simulator,
    SimulatorError, SimulatorHandle, blueprint, signals::Moment,
};
use tempfile::TempDir;
use testkit::wait::eventually;
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::TcpStream,
};
use tokio_util::sync::{CancellationToken, DropGuard};

/// Longest time that a state may take.
const PATIENCE: Duration = Duration::from_secs(10);

async fn start(mut config: Config) -> (SimulatorHandle, TempDir, DropGuard) {
    let directory = tempfile::tempdir().expect("a folder for certificates");
    config.pki_directory = directory.path().to_owned();
    config.update_interval_ms = 10;
    let (simulator, handle) = Simulator::new(config).await.expect("the machines start");
    let stop = CancellationToken::new();
    tokio::spawn(simulator.run(stop.clone()));
    (handle, directory, stop.drop_guard())
}

fn all_kinds() -> Vec<MachineConfig> {
    use MachineKind::{Conveyor, MillingCell, Press, Robot};
    [("Cell", MillingCell), ("Press", Press), ("Belt", Conveyor), ("Robot", Robot)]
        .map(|(name, kind)| MachineConfig::new(name, kind))
        .to_vec()
}

#[test]
fn values_follow_from_seed_machine_and_time() {
    for machine in all_kinds() {
        let (first, second) =
            (simulator::machines::blueprint(&machine), simulator::machines::blueprint(&machine));
        let mut differing = 0;
        for (a, b) in first.nodes.iter().zip(&second.nodes) {
            let (blueprint::Class::Variable(a), blueprint::Class::Variable(b)) =
                (&a.class, &b.class)
            else {
                continue;
            };
            let (blueprint::Source::Signal(a), blueprint::Source::Signal(b)) =
                (&a.source, &b.source)
            else {
                continue;
            };
            for seconds in [0.0, 0.5, 61.0, 86_400.0] {
                assert_eq!(a(Moment { seed: 1, seconds }), b(Moment { seed: 1, seconds }));
                differing +=
                    usize::from(a(Moment { seed: 1, seconds }) != a(Moment { seed: 2, seconds }));
            }
        }
        assert!(differing > 5, "{}: another seed must show", machine.name);
    }
}

#[tokio::test]
async fn every_variable_has_a_value_of_its_type() {
    let (handle, _directory, _stop) = start(Config::of(all_kinds())).await;
    for machine in handle.machines() {
        let values = machine.values().await.expect("running");
        assert!(values.len() >= 8, "{} has {} variables", machine.name(), values.len());
        for (key, built_in, value) in values {
            assert_eq!(value.status, StatusCode::GOOD, "{key}");
            assert_eq!(value.value.built_in_type(), Some(built_in), "{key}");
        }
    }
    let kinds: Vec<_> =
        handle.machine("Cell").expect("configured").values().await.expect("running");
    for wanted in [
        BuiltInType::UInt64,
        BuiltInType::ExtensionObject,
        BuiltInType::LocalizedText,
        BuiltInType::UInt16,
    ] {
        assert!(kinds.iter().any(|(_, built_in, _)| *built_in == wanted), "{wanted}");
    }
}

#[tokio::test]
async fn a_fixed_epoch_lets_counters_go_on_and_speed_hurries_them() {
    let mut config = Config::of(all_kinds());
    config.epoch = Some("2020-01-01T00:00:00Z".into());
    let (handle, _directory, _stop) = start(config).await;
    let parts = |values: Vec<(String, BuiltInType, DataValue)>| {
        let found = values
            .into_iter()
            .find(|(key, ..)| key == "Production.PartCounter")
            .expect("a counter");
        found.2.value.as_scalar().and_then(Scalar::as_i128).expect("a number")
    };
    let machine = handle.machine("Cell").expect("configured");
    assert!(parts(machine.values().await.expect("running")) > 10_000_000);

    let mut fast = Config::of(all_kinds());
    fast.speed = 1000.0;
    let (handle, _directory, _stop) = start(fast).await;
    let machine = handle.machine("Cell").expect("configured");
    let are_made = || async {
        let count = parts(machine.values().await.expect("running"));
        if count >= 50 { Ok(()) } else { Err(format!("{count} parts")) }
    };
    let made = eventually("50 parts, of a quarter of a simulated second each", PATIENCE, are_made);
    made.await.expect("they are made");
}

#[tokio::test]
async fn an_order_counts_to_its_quantity_and_says_when_it_ends() {
    let mut cell = MachineConfig::new("Cell", MachineKind::MillingCell);
    cell.cycle_seconds = Some(40.0);
    cell.orders = Some(OrdersConfig {
        name: "4711".to_owned(),
        first_number: 3,
        quantity: 12,
        begins_after_seconds: 20.0,
        every_seconds: 1e9,
        failure: Some(FailureConfig { after_seconds: 70.0, lasts_seconds: 45.0 }),
    });
    let mut config = Config::of(vec![cell]);
    config.speed = 1000.0;
    config.epoch = Some("2026-01-01T00:00:00Z".into());
    config.check().expect("the order can be worked off");
    // Long past the end of an order, and before the next one.
    let (handle, _directory, _stop) = start(config).await;
    let machine = handle.machine("Cell").expect("configured");
    let values = machine.values().await.expect("running");
    let value = |wanted: &str| {
        let found = values.iter().find(|(key, ..)| *key == format!("Production.{wanted}"));
        found.unwrap_or_else(|| panic!("no {wanted}")).2.value.clone()
    };
    assert_eq!(value("PartCounter"), Variant::from(12_u32));
    assert_eq!(value("OrderedQuantity"), Variant::from(12_u32));
    assert_eq!(value("OrderState"), Variant::from(3_i32));
    assert_eq!(value("InterruptedBy"), Variant::from("none"));
    let seconds = |name: &str| match value(name).as_scalar() {
        Some(Scalar::DateTime(time)) => time.ticks() / 10_000_000,
        other => panic!("{name} is {other:?}"),
    };
    // 525 simulated seconds of work and failure, at a thousandth of the time.
    assert!((0..=1).contains(&(seconds("OrderEnd") - seconds("OrderStart"))));
    let refused = machine.set("Production.OrderId", 7_u32).await;
    assert_eq!(refused, Err(SimulatorError::WrongType { expected: BuiltInType::String }));
}

#[tokio::test]
async fn what_is_set_stays_until_it_is_released() {
    let (handle, _directory, _stop) = start(Config::of(all_kinds())).await;
    let cell = handle.machine("Cell").expect("configured");
    let before = asi_model::DateTime::from(std::time::SystemTime::now());
    let at = cell.set("Spindle.Temperature", 99.5).await.expect("set");
    assert!(at >= before);
    let value = || async {
        let values = cell.values().await.expect("running");
        values.into_iter().find(|(key, ..)| key == "Spindle.Temperature").expect("it is there").2
    };
    assert_eq!(value().await.source_timestamp, Some(at));
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_millis(100) {
        assert_eq!(value().await.value, Variant::from(99.5));
    }
    cell.release("Spindle.Temperature").await.expect("released");
    let runs = || async {
        let value = value().await.value;
        if value == Variant::from(99.5) { Err("it stays".to_owned()) } else { Ok(()) }
    };
    eventually("the value runs again", PATIENCE, runs).await.expect("it runs");
    let wrong = SimulatorError::WrongType { expected: BuiltInType::Double };
    assert_eq!(cell.set("Spindle.Temperature", 1_i32).await, Err(wrong));
    let unknown = SimulatorError::UnknownVariable("Spindle.Colour".into());
    assert_eq!(cell.set("Spindle.Colour", 1_i32).await, Err(unknown));
    cell.inject(MachineFault::Kill).await.expect("killed");
    assert_eq!(cell.set("Spindle.Temperature", 1.0).await, Err(SimulatorError::Down));
    cell.inject(MachineFault::None).await.expect("healed");
    cell.set("Spindle.Temperature", 1.0).await.expect("it runs again");
}

/// One request to the control interface; status and body.
async fn http(
    address: std::net::SocketAddr,
    request: &str,
    body: &str,
) -> (u16, serde_json::Value) {
    let mut stream = TcpStream::connect(address).await.expect("it listens");
    let text = format!(
        "{request} HTTP/1.1\r\nhost: test\r\nconnection: close\r\ncontent-type: application/json\r\ncontent-length: {}\r\n\r\n{body}",
        body.len()
    );
    stream.write_all(text.as_bytes()).await.expect("sent");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).await.expect("answered");
    let status = answer.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
    let body = answer.split_once("\r\n\r\n").map_or("", |(_, body)| body);
    (status, serde_json::from_str(body).unwrap_or_default())
}

#[tokio::test]
async fn the_control_interface_sets_reads_and_breaks() {
    let [port] = free_ports::reserve().expect("a free port");
    let address = ([127, 0, 0, 1], port).into();
    let mut config = Config::of(vec![MachineConfig::new("Belt", MachineKind::Conveyor)]);
    config.control = Some(address);
    let (_handle, _directory, _stop) = start(config).await;

    let (status, machines) = http(address, "GET /machines", "").await;
    assert_eq!(status, 200);
    assert_eq!(machines[0]["name"], "Belt");
    let (status, set) = http(
        address,
        "POST /machines/Belt/variables/Items.ItemCount",
        r#"{"value": "9007199254740993"}"#,
    )
    .await;
    assert_eq!(status, 200);
    let (_, variables) = http(address, "GET /machines/Belt/variables", "").await;
    let count = variables
        .as_array()
        .expect("a list")
        .iter()
        .find(|found| found["key"] == "Items.ItemCount");
    let count = count.expect("it is there");
    assert_eq!(count["value"], "9007199254740993");
    assert_eq!(count["type"], "UInt64");
    assert_eq!(count["nodeId"], "nsu=urn:verbund:simulator:Belt;s=Items.ItemCount");
    assert_eq!(count["sourceTimestamp"], set["sourceTimestamp"]);
    assert_eq!(http(address, "DELETE /machines/Belt/variables/Items.ItemCount", "").await.0, 204);
    assert_eq!(
        http(address, "POST /machines/Belt/faults", r#"{"fault": "wrongClock", "aheadMs": 5000}"#)
            .await
            .0,
        204
    );

    let (status, problem) =
        http(address, "POST /machines/Belt/variables/Belt.Speed", r#"{"value": "fast"}"#).await;
    assert_eq!(
        (status, problem["title"].as_str()),
        (422, Some("the value must be of the type Double"))
    );
    assert_eq!(http(address, "POST /machines/Lathe/faults", r#"{"fault": "kill"}"#).await.0, 404);

    let event = r#"{"message": "an item is stuck", "severity": 500}"#;
    let (status, raised) = http(address, "POST /machines/Belt/events", event).await;
    assert_eq!((status, raised["time"].is_string()), (200, true));
    let condition = r#"{"message": "the belt slips", "severity": 300, "isActive": true}"#;
    let (status, set) = http(address, "POST /machines/Belt/conditions/Belt", condition).await;
    assert_eq!((status, set["time"].is_string()), (200, true));
    assert_eq!(http(address, "POST /machines/Lathe/events", event).await.0, 404);
}
