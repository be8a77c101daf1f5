//! A simulation and a shop floor that reads from it.

use std::{collections::HashMap, sync::Arc, time::Duration};

use asi_model::{DataValue, NodeId, StatusCode, Variant};
use parking_lot::Mutex;
use shop_floor::{
    Config, InputKey, MonitorOptions, SecurityChoice, ShopFloor, ShopFloorHandle, SourceConfig,
    SourceId, SourceStatus,
};
use simulator::{MachineConfig, MachineHandle, MachineKind, Simulator, SimulatorHandle};
use tempfile::TempDir;
use tokio_util::sync::{CancellationToken, DropGuard};

/// A simulation that runs until it is dropped.
pub struct Simulation {
    pub handle: SimulatorHandle,
    _directory: TempDir,
    _stop: DropGuard,
}

impl Simulation {
    pub async fn of(machines: Vec<MachineConfig>) -> Self {
        let directory = tempfile::tempdir().expect("a folder for certificates");
        let mut config = simulator::Config::of(machines);
        config.pki_directory = directory.path().to_owned();
        config.update_interval_ms = 20;
        let (simulator, handle) = Simulator::new(config).await.expect("the machines start");
        let stop = CancellationToken::new();
        tokio::spawn(simulator.run(stop.clone()));
        Self { handle, _directory: directory, _stop: stop.drop_guard() }
    }

    pub async fn milling_cell() -> Self {
        Self::of(vec![MachineConfig::new("Cell", MachineKind::MillingCell)]).await
    }

    pub fn machine(&self, name: &str) -> MachineHandle {
        self.handle.machine(name).expect("a configured machine").clone()
    }
}

type Heard = Arc<Mutex<HashMap<InputKey, Vec<DataValue>>>>;

/// A shop floor that runs until it is dropped, and all that it delivered.
pub struct TestShopFloor {
    pub handle: ShopFloorHandle,
    heard: Heard,
    _directory: TempDir,
    _stop: DropGuard,
}

impl TestShopFloor {
    pub fn start() -> Self {
        Self::start_with(|_| {})
    }

    pub fn start_with(change: impl FnOnce(&mut Config)) -> Self {
        let directory = tempfile::tempdir().expect("a folder for certificates");
        let mut config =
            Config::new(directory.path(), "Shop floor test", "urn:verbund:test:shop-floor");
        change(&mut config);
        let (floor, handle, mut changes) = ShopFloor::new(config);
        let stop = CancellationToken::new();
        tokio::spawn(floor.run(stop.clone()));
        let heard = Heard::default();
        tokio::spawn({
            let heard = Arc::clone(&heard);
            async move {
                while let Some(batch) = changes.recv().await {
                    let mut heard = heard.lock();
                    for change in batch {
                        heard.entry(change.input).or_default().push(change.value);
                    }
                }
            }
        });
        Self { handle, heard, _directory: directory, _stop: stop.drop_guard() }
    }

    /// Connects to a machine without protection.
    pub async fn connect(&self, machine: &MachineHandle) -> SourceId {
        self.connect_to(unprotected(machine)).await
    }

    /// Connects to a machine without protection whose silence is soon noticed.
    /// So many milliseconds without a sign of life are taken for a stall.
    pub async fn connect_with_silence(
        &self,
        machine: &MachineHandle,
        silence_ms_max: u32,
    ) -> SourceId {
        let mut source = unprotected(machine);
        source.silence_ms_max = silence_ms_max;
        self.connect_to(source).await
    }

    pub async fn connect_to(&self, source: SourceConfig) -> SourceId {
        let id = source.source_id.clone();
        self.handle.put_source(source).expect("a valid source");
        self.until_connected(&id).await;
        id
    }

    pub async fn until_connected(&self, id: &SourceId) {
        until("the source is connected", || {
            self.handle.states().iter().any(|s| s.source_id == *id && is_ready(s))
        })
        .await;
    }

    pub fn monitor(&self, input: u64, source: &SourceId, node: NodeId) {
        self.handle
            .monitor(InputKey(input), source.clone(), node, MonitorOptions::default())
            .expect("a valid request");
    }

    /// All that was heard of an input.
    pub fn heard(&self, input: u64) -> Vec<DataValue> {
        self.heard.lock().get(&InputKey(input)).cloned().unwrap_or_default()
    }

    pub fn newest(&self, input: u64) -> Option<DataValue> {
        self.heard.lock().get(&InputKey(input))?.last().cloned()
    }

    pub async fn until_value(&self, input: u64, value: impl Into<Variant>) -> DataValue {
        let value = value.into();
        until(&format!("input {input} is {value:?}"), || {
            self.newest(input).is_some_and(|newest| newest.value == value)
        })
        .await;
        self.newest(input).expect("it was just there")
    }

    pub async fn until_status(&self, input: u64, status: StatusCode) {
        until(&format!("input {input} is {status}"), || {
            self.newest(input).is_some_and(|newest| newest.status == status)
        })
        .await;
    }

    pub fn status(&self, id: &SourceId) -> SourceStatus {
        self.handle
            .states()
            .into_iter()
            .find(|status| status.source_id == *id)
            .expect("a configured source")
    }
}

pub fn unprotected(machine: &MachineHandle) -> SourceConfig {
    let id = SourceId::new(machine.name()).expect("machines have source ids as names");
    let mut source = SourceConfig::new(id, machine.endpoint_url());
    source.security = SecurityChoice::None;
    source
}

fn is_ready(status: &SourceStatus) -> bool {
    status.state == shop_floor::SourceState::Connected
}

/// Waits for a condition, no longer than a minute: the machine may be busy with other tests.
pub async fn until(what: &str, condition: impl FnMut() -> bool) -> Duration {
    testkit::wait::until(what, Duration::from_secs(60), condition).await
}

/// Waits for a condition no longer than so; returns how long it took.
pub async fn within(limit: Duration, what: &str, condition: impl FnMut() -> bool) -> Duration {
    testkit::wait::until(what, limit, condition).await
}

/// A variable's present identity.
pub fn node(machine: &MachineHandle, key: &str) -> NodeId {
    machine.node_id(key).unwrap_or_else(|| panic!("{} has no {key}", machine.name()))
}
