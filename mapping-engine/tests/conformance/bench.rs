//! A mapping engine with inputs that the test plays.

use std::{
    collections::{HashMap, VecDeque},
    hash::{DefaultHasher, Hash as _, Hasher as _},
    path::PathBuf,
    sync::{Arc, Mutex},
    time::Duration,
};

use asi_model::{DataValue, DateTime, Variant};
use mapping_engine::{
    Candidate, DryRunSample, Inputs, Mapping, MappingEngine, MappingEngineConfig,
    MappingEngineHandle, MappingHealth, MappingId, MappingStatus, MappingSurvey, PublishRequest,
    ScriptConfig, ScriptRuntime, SeesUnreleased, TargetKey, Trace, TransformState,
    VariableRecording,
};
use shop_floor::{InputChange, InputKey, MonitorRequest, ShopFloorError};
use tokio::{sync::mpsc, task::JoinHandle, time::timeout};
use tokio_util::sync::CancellationToken;

/// The worker under test.
#[derive(Debug, Clone)]
pub struct Worker {
    pub engine: ScriptRuntime,
    pub path: PathBuf,
    /// The Deno executable, for an engine that is one.
    pub deno: Option<PathBuf>,
}

/// Longest wait for anything.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// Remembers which key each node is monitored under.
#[derive(Debug, Clone, Default)]
struct PlayedInputs(Arc<Mutex<HashMap<String, InputKey>>>);

impl Inputs for PlayedInputs {
    fn monitor(&self, requests: Vec<Arc<MonitorRequest>>) -> Result<(), ShopFloorError> {
        let mut keys = self.0.lock().expect("no test panics while holding it");
        keys.extend(
            requests.into_iter().map(|request| (request.node_id.to_string(), request.input)),
        );
        Ok(())
    }

    fn unmonitor(&self, inputs: &[InputKey]) {
        self.0
            .lock()
            .expect("no test panics while holding it")
            .retain(|_, key| !inputs.contains(key));
    }
}

/// A test sees everything.
struct Tester;

impl SeesUnreleased for Tester {}

/// A running engine.
pub struct Bench {
    pub handle: MappingEngineHandle,
    inputs: PlayedInputs,
    changes: mpsc::Sender<Vec<InputChange>>,
    candidates: mpsc::Receiver<Vec<Candidate>>,
    arrived: VecDeque<Candidate>,
    shutdown: CancellationToken,
    running: JoinHandle<()>,
    time: i64,
}

impl Bench {
    pub fn start(worker: &Worker, adjust: impl FnOnce(&mut ScriptConfig)) -> Self {
        let mut config = MappingEngineConfig::default();
        config.script.engine = worker.engine;
        config.script.worker_path = Some(worker.path.clone());
        config.script.deno_path.clone_from(&worker.deno);
        adjust(&mut config.script);
        Self::start_with(config)
    }

    pub fn start_with(config: MappingEngineConfig) -> Self {
        Self::start_after(config, Vec::new())
    }

    /// Starts with what was recorded before.
    pub fn start_after(config: MappingEngineConfig, former: Vec<VariableRecording>) -> Self {
        let inputs = PlayedInputs::default();
        let (changes, for_engine) = mpsc::channel(64);
        let (mut engine, handle, candidates) =
            MappingEngine::new(config, inputs.clone(), for_engine);
        engine.resume(former);
        let shutdown = CancellationToken::new();
        let running = tokio::spawn(engine.run(shutdown.clone()));
        let arrived = VecDeque::new();
        Self {
            handle,
            inputs,
            changes,
            candidates,
            arrived,
            shutdown,
            running,
            time: 1_600_000_000_000_000,
        }
    }

    /// Publishes a mapping that has no faults.
    pub async fn put(&self, mapping: Mapping) {
        self.publish(published(mapping)).await;
    }

    pub async fn publish(&self, published: PublishRequest) {
        let put = self.handle.put_many(vec![published]).await.expect("the engine runs");
        put.into_iter().next().expect("one result").expect("the mapping is fine");
    }

    pub async fn remove(&self, id: &str) {
        assert!(
            self.handle.remove(&mapping_id(id)).await.expect("the engine runs"),
            "{id} was there"
        );
    }

    /// Gives an input of a mapping a value.
    pub async fn feed(&mut self, id: &str, input: &str, value: impl Into<Variant>) {
        self.feed_all(id, input, [value.into()]).await;
    }

    pub async fn feed_all(
        &mut self,
        id: &str,
        input: &str,
        values: impl IntoIterator<Item = Variant>,
    ) {
        let values = values.into_iter().map(|value| {
            self.time += 1000;
            DataValue::good(value, DateTime::from_unix_micros(self.time))
        });
        let values = values.collect();
        self.send(id, input, values).await;
    }

    pub async fn send(&mut self, id: &str, input: &str, values: Vec<DataValue>) {
        let key = self.key(id, input);
        let changes = values.into_iter().map(|value| InputChange { input: key, value }).collect();
        self.changes().send(changes).await.expect("the engine runs");
    }

    /// The key that an input is monitored under.
    pub fn key(&self, id: &str, input: &str) -> InputKey {
        *self
            .inputs
            .0
            .lock()
            .expect("no panic")
            .get(&node(id, input))
            .expect("the input is monitored")
    }

    /// Sender of changes, in place of the shop floor.
    pub fn changes(&self) -> mpsc::Sender<Vec<InputChange>> {
        self.changes.clone()
    }

    /// The next candidate of a mapping; those of others stay for later.
    pub async fn next(&mut self, id: &str) -> Candidate {
        let target = target_of(&mapping_id(id));
        if let Some(at) = self.arrived.iter().position(|candidate| candidate.target == target) {
            return self.arrived.remove(at).expect("just found");
        }
        let waiting = async {
            loop {
                let batch = self.candidates.recv().await.expect("the engine runs");
                self.arrived.extend(batch);
                if let Some(at) =
                    self.arrived.iter().position(|candidate| candidate.target == target)
                {
                    return self.arrived.remove(at).expect("just found");
                }
            }
        };
        timeout(PATIENCE, waiting).await.unwrap_or_else(|_| panic!("no candidate of {id} came"))
    }

    /// Feeds one value and takes the candidate.
    pub async fn ask(&mut self, id: &str, value: impl Into<Variant>) -> DataValue {
        self.feed(id, "a", value).await;
        self.next(id).await.value
    }

    pub async fn status(&self, id: &str) -> MappingStatus {
        let status = self.handle.status(&mapping_id(id)).await.expect("the engine runs");
        status.expect("the mapping is there").seen_by(Tester)
    }

    pub async fn survey(&self, wanted: Option<MappingHealth>, most: usize) -> MappingSurvey {
        self.handle.survey(wanted, most).await.expect("the engine runs").seen_by(Tester)
    }

    pub async fn dry_run(
        &self,
        mapping: Mapping,
        samples: Vec<DryRunSample>,
        state: Option<TransformState>,
    ) -> Trace {
        let trace = self.handle.dry_run(mapping, samples, state).await;
        trace.expect("the engine runs").seen_by(Tester)
    }

    pub async fn health(&self, id: &str) -> MappingHealth {
        let items = self.survey(None, usize::MAX).await.items;
        let id = mapping_id(id);
        items.iter().find(|item| item.status.mapping_id == id).expect("the mapping is there").health
    }

    pub async fn stop(self) {
        self.shutdown.cancel();
        timeout(PATIENCE, self.running).await.expect("the engine ends").expect("without a panic");
    }
}

pub fn published(mapping: Mapping) -> PublishRequest {
    let target = target_of(&mapping.mapping_id);
    PublishRequest::new(mapping, target)
}

/// A test's fields are known by their mappings' ids.
pub fn target_of(id: &MappingId) -> TargetKey {
    let mut hasher = DefaultHasher::new();
    id.as_str().hash(&mut hasher);
    TargetKey { field: hasher.finish().cast_signed(), version: 1 }
}

pub fn mapping_id(id: &str) -> MappingId {
    MappingId::new(id).expect("a mapping id")
}

fn node(id: &str, input: &str) -> String {
    format!("nsu=urn:test;s={id}.{input}")
}

pub fn script_mapping(id: &str, inputs: &[&str], target: &str, source: &str) -> Mapping {
    let key = |name: &str| format!("{name}-{id}");
    let json = serde_json::json!({
        "mappingId": id,
        "target": { "operationNetworkId": key("n"), "operationId": "o", "dynamicDataRequestId": "r", "fieldName": "f" },
        "targetType": target,
        "inputs": inputs
            .iter()
            .map(|name| serde_json::json!({ "name": name, "sourceId": "test", "nodeId": node(id, name) }))
            .collect::<Vec<_>>(),
        "steps": [{ "function": "script", "source": source }],
    });
    serde_json::from_value(json).expect("a mapping")
}
