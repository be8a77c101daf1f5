//! States of mappings, with a mapping engine that runs beside the coordinator.

use std::sync::Mutex;

use mapping_engine::{Inputs, Mapping, MappingEngine, MappingEngineConfig, MappingEngineHandle};
use shop_floor::{InputChange, InputKey, MonitorRequest, ShopFloorError};

use super::{
    failures::{break_table, mend_table},
    *,
};

/// Machine with one variable; notes the key under which it is monitored.
#[derive(Clone, Default)]
struct Machine(Arc<Mutex<Option<InputKey>>>);

impl Inputs for Machine {
    fn monitor(&self, requests: Vec<Arc<MonitorRequest>>) -> Result<(), ShopFloorError> {
        let last = requests.last().map(|request| request.input);
        *self.0.lock().expect("no panic") = last;
        Ok(())
    }

    fn unmonitor(&self, _: &[InputKey]) {}
}

/// Engine that runs what the coordinator publishes, on values of a machine.
struct Engine {
    machine: Machine,
    changes: mpsc::Sender<Vec<InputChange>>,
    given: u64,
}

impl Engine {
    /// Starts it for a connector, in place of the test's own ends of the channels.
    fn start(running: &mut Running) -> Self {
        let machine = Machine::default();
        let (changes, arriving) = mpsc::channel(64);
        let config = MappingEngineConfig::default();
        let (engine, handle, mut yielded) = MappingEngine::new(config, machine.clone(), arriving);
        tokio::spawn(engine.run(running.shutdown.clone()));
        let (_, none) = mpsc::channel(1);
        tokio::spawn(publish(std::mem::replace(&mut running.work, none), handle));
        let candidates = running.candidates.clone();
        tokio::spawn(async move {
            while let Some(batch) = yielded.recv().await {
                if candidates.send(batch).await.is_err() {
                    return;
                }
            }
        });
        Self { machine, changes, given: 0 }
    }

    /// Gives the variable another value.
    async fn give(&mut self) {
        let begun = std::time::Instant::now();
        let input = loop {
            if let Some(key) = *self.machine.0.lock().expect("no panic") {
                break key;
            }
            assert!(begun.elapsed() < DEADLINE, "the variable is not monitored");
            tokio::time::sleep(PAUSE).await;
        };
        self.given += 1;
        let value = DataValue::good(self.given, now());
        self.changes.send(vec![InputChange { input, value }]).await.expect("the engine runs");
    }
}

async fn publish(mut work: mpsc::Receiver<Vec<EngineCommand>>, engine: MappingEngineHandle) {
    while let Some(batch) = work.recv().await {
        let put = batch.into_iter().filter_map(|command| match command {
            EngineCommand::Put(request) => Some(request),
            EngineCommand::Remove(_) => None,
        });
        drop(engine.put_many(put.collect()).await);
    }
}

/// Mapping that counts the values of the machine.
fn counting() -> Box<Mapping> {
    let json = json!({ "mappingId": "m", "target": field("made"), "targetType": "UInt64",
        "inputs": [ { "name": "a", "sourceId": "machine", "nodeId": "nsu=urn:test;s=a" } ],
        "steps": [ { "function": "counter", "counts": "values" } ] });
    serde_json::from_value(json).expect("a mapping")
}

/// Counts in the reports, in their order.
async fn counts(running: &Running) -> Vec<u64> {
    let rows = running.fetch(Lane::Reports).await;
    let messages = rows.iter().map(|row| serde_json::from_slice::<Value>(&row.envelope.body));
    let count = |report: &Value| report["Payload"]["made"]["Body"].as_str()?.parse().ok();
    let of_message = |message: Value| -> Vec<u64> {
        message["Messages"].as_array().expect("reports").iter().filter_map(count).collect()
    };
    messages.flat_map(|message| of_message(message.expect("JSON"))).collect()
}

/// Waits until a report has this count.
async fn reported(running: &Running, count: u64) -> Vec<u64> {
    let begun = std::time::Instant::now();
    loop {
        let all = counts(running).await;
        if all.last() == Some(&count) {
            return all;
        }
        assert!(begun.elapsed() < DEADLINE, "{count} is not reported, after {all:?}");
        tokio::time::sleep(PAUSE).await;
    }
}

/// The engine's state goes on while nothing can be stored, and candidates with it are on their way by the time that the
/// connector reads its own state again: were the engine's set back to that, the next ones would say less than these.
#[tokio::test]
async fn a_count_goes_on_after_transactions_that_failed() {
    let mut running = Running::open().await;
    let mut engine = Engine::start(&mut running);
    running.receive("operation-network", network(1)).await;
    for (name, value_source) in [("made", ValueSource::Mapping), ("note", ValueSource::Manual)] {
        let mapping = (name == "made").then(counting);
        let policy = DisclosurePolicy::default();
        let command = DecisionCommand::Map { value_source, mapping, policy };
        decide_field(&running.coordinator, field(name), command).await;
    }
    engine.give().await;
    reported(&running, 1).await;

    let mut beside = connect(&running.folder).await;
    break_table(&mut beside, "report").await;
    for _ in 0..3 {
        engine.give().await;
    }
    let note = vec![entry("note", json!("n"))];
    assert_eq!(running.enter(note).await, Err(CoordinatorError::NotWritten));
    // The coordinator waits a while before it reads its state.
    for _ in 0..3 {
        engine.give().await;
    }
    mend_table(&mut beside).await;
    reported(&running, engine.given).await;
    for _ in 0..3 {
        engine.give().await;
        reported(&running, engine.given).await;
    }
    let all = counts(&running).await;
    assert!(all.is_sorted(), "{all:?}");
    running.close().await;
}

/// Yielding again: the engine's last candidate is lost with the transaction, and its source is silent.
#[tokio::test]
async fn the_last_value_comes_again_after_a_transaction_that_failed() {
    let mut running = Running::open().await;
    let mut engine = Engine::start(&mut running);
    running.receive("operation-network", network(1)).await;
    let policy = DisclosurePolicy::default();
    let (value_source, mapping) = (ValueSource::Mapping, Some(counting()));
    let command = DecisionCommand::Map { value_source, mapping, policy };
    decide_field(&running.coordinator, field("made"), command).await;
    engine.give().await;
    reported(&running, 1).await;
    let mut beside = connect(&running.folder).await;
    break_table(&mut beside, "report").await;
    engine.give().await;
    let failed = || async {
        let decided = running.coordinator.execute(|_, _| ((), ChangeSet::default())).await;
        decided.is_err()
    };
    let begun = std::time::Instant::now();
    while !failed().await {
        assert!(begun.elapsed() < DEADLINE, "no transaction fails");
    }
    mend_table(&mut beside).await;
    assert_eq!(reported(&running, 2).await, [1, 2]);
    running.close().await;
}

/// Window of the sum: longer than the transactions of its test take together.
const WINDOW: Duration = Duration::from_secs(8);

/// Waits until the connector has taken this count from the engine.
async fn taken(running: &Running, count: u64) {
    let begun = std::time::Instant::now();
    let newest = |state: &ConnectorState| {
        state.field(&field("made")).and_then(|made| made.newest().cloned())
    };
    loop {
        let last = running.coordinator.read(newest).await.expect("read");
        if last.is_some_and(|last| last.value == count.into()) {
            return;
        }
        assert!(begun.elapsed() < DEADLINE, "{count} does not come");
        tokio::time::sleep(PAUSE).await;
    }
}

/// A candidate that was committed is not taken again, one that was lost with its transaction is, and each of several.
#[tokio::test]
async fn a_sum_has_each_value_once_though_transactions_fail() {
    let mut running = Running::open().await;
    let mut engine = Engine::start(&mut running);
    running.receive("operation-network", network(1)).await;
    let sum = json!({ "aggregate": { "function": "SUM", "windowMs": 8000 } });
    let sum: DisclosurePolicy = serde_json::from_value(sum).expect("a policy");
    for (name, value_source) in [("made", ValueSource::Mapping), ("note", ValueSource::Manual)] {
        let is_made = name == "made";
        let mapping = is_made.then(counting);
        let policy = if is_made { sum.clone() } else { DisclosurePolicy::default() };
        let command = DecisionCommand::Map { value_source, mapping, policy };
        decide_field(&running.coordinator, field(name), command).await;
    }
    // A window that has begun before the decision has no sum.
    let begins = now().floor_to(WINDOW).after(WINDOW);
    tokio::time::sleep(begins.since(now()) + Duration::from_millis(50)).await;
    for _ in 0..2 {
        engine.give().await;
    }
    taken(&running, 2).await;
    running.enter(vec![entry("note", json!("committed"))]).await.expect("written");

    let mut beside = connect(&running.folder).await;
    break_table(&mut beside, "report").await;
    for given in [2, 4] {
        while engine.given < given {
            engine.give().await;
        }
        taken(&running, given).await;
        let lost = vec![entry("note", json!("lost"))];
        assert_eq!(running.enter(lost).await, Err(CoordinatorError::NotWritten));
    }
    mend_table(&mut beside).await;
    engine.give().await;
    taken(&running, 5).await;

    let begun = std::time::Instant::now();
    let expected: u64 = (1..=5).sum();
    while counts(&running).await.iter().sum::<u64>() < expected {
        assert!(begun.elapsed() < DEADLINE, "{:?}", counts(&running).await);
        tokio::time::sleep(PAUSE).await;
    }
    let sums = counts(&running).await;
    assert_eq!(sums.iter().sum::<u64>(), expected, "{sums:?}");
    running.close().await;
}
