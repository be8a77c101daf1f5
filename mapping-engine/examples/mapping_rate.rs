//! Measures values per second from the shop floor's channel to the consumer's, and memory per
//! mapping. Prints one line of name, value and unit per figure; those of the script engines side by side.
//!
//! `cargo run --release -p mapping-engine --example mapping_rate` (build `script-quickjs` and `script-deno` with the
//! same profile before, and `make deno`).

use std::{
    collections::HashMap,
    fs,
    path::Path,
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use asi_model::{DataValue, DateTime};
use mapping_engine::{
    Candidate, Inputs, Mapping, MappingEngine, MappingEngineConfig, MappingEngineHandle,
    PublishRequest, ScriptRuntime, Step, TargetKey,
};
use serde_json::json;
use shop_floor::{InputChange, InputKey, MonitorRequest, ShopFloorError};
use tokio::sync::mpsc;
use tokio_util::sync::CancellationToken;

/// Nodes and their keys.
#[derive(Clone, Default)]
struct Keys(Arc<Mutex<HashMap<String, InputKey>>>);

impl Inputs for Keys {
    fn monitor(&self, requests: Vec<Arc<MonitorRequest>>) -> Result<(), ShopFloorError> {
        let mut keys = self.0.lock().expect("nobody panics");
        keys.extend(
            requests.into_iter().map(|request| (request.node_id.to_string(), request.input)),
        );
        Ok(())
    }
    fn unmonitor(&self, _: &[InputKey]) {}
}

struct Running {
    handle: MappingEngineHandle,
    keys: Keys,
    changes: mpsc::Sender<Vec<InputChange>>,
    candidates: mpsc::Receiver<Vec<Candidate>>,
    shutdown: CancellationToken,
}

impl Running {
    fn start(config: MappingEngineConfig) -> Self {
        let keys = Keys::default();
        let (changes, for_engine) = mpsc::channel(64);
        let (engine, handle, candidates) = MappingEngine::new(config, keys.clone(), for_engine);
        let shutdown = CancellationToken::new();
        tokio::spawn(engine.run(shutdown.clone()));
        Self { handle, keys, changes, candidates, shutdown }
    }

    async fn put(&self, count: usize, steps: &serde_json::Value) {
        let mappings = (0..)
            .map(|field| TargetKey { field, version: 1 })
            .zip(0..count)
            .map(|(target, index)| PublishRequest::new(mapping(index, steps), target));
        for result in self.handle.put_many(mappings.collect()).await.expect("the engine runs") {
            result.expect("the mapping is fine");
        }
    }

    /// Feeds so many rounds of so many values per mapping, and takes what comes out. The time it
    /// took.
    async fn feed(&mut self, mappings: usize, per_round: i64, rounds: i64) -> Duration {
        let keys: Vec<InputKey> = (0..mappings)
            .map(|index| self.keys.0.lock().expect("nobody panics")[&node(index)])
            .collect();
        let begun = Instant::now();
        for round in 0..rounds {
            let mut batch = Vec::with_capacity(1000);
            for value in 0..per_round {
                for key in &keys {
                    let number = round * per_round + value;
                    let time = DateTime::from_unix_micros(1_700_000_000_000_000 + number * 1000);
                    batch.push(InputChange { input: *key, value: DataValue::good(number, time) });
                    if batch.len() == 1000 {
                        self.changes
                            .send(std::mem::take(&mut batch))
                            .await
                            .expect("the engine runs");
                    }
                }
            }
            self.changes.send(batch).await.expect("the engine runs");
            let mut missing = keys.len() * usize::try_from(per_round).expect("positive");
            while missing > 0 {
                missing -= self.candidates.recv().await.expect("the engine runs").len();
            }
        }
        begun.elapsed()
    }
}

fn node(index: usize) -> String {
    format!("nsu=urn:bench;i={index}")
}

fn mapping(index: usize, steps: &serde_json::Value) -> Mapping {
    serde_json::from_value(json!({
        "mappingId": format!("mapping-{index}"),
        "target": { "operationNetworkId": "frame-4711", "operationId": format!("MakeFrame{index}"),
                    "dynamicDataRequestId": "ReqResponse1", "fieldName": "progressStatus" },
        "targetType": "Double",
        "inputs": [{ "name": "a", "sourceId": "press", "nodeId": node(index), "valueType": "Int64" }],
        "steps": serde_json::from_value::<Vec<Step>>(steps.clone()).expect("steps"),
    }))
    .expect("a mapping")
}

/// Resident memory of a process, in kB.
fn resident_kb(process: &str) -> u64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|rest| rest.split_whitespace().next()).and_then(|kb| kb.parse().ok()).unwrap_or(0)
}

/// The processes that this one started.
fn children() -> Vec<String> {
    let tasks = fs::read_dir("/proc/self/task").expect("a /proc");
    let of_task =
        tasks.flatten().filter_map(|task| fs::read_to_string(task.path().join("children")).ok());
    of_task
        .flat_map(|list| list.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
        .collect()
}

#[allow(clippy::print_stdout)]
fn say(name: &str, value: f64, unit: &str) {
    println!("{name}\t{value:.0}\t{unit}");
}

#[tokio::main(flavor = "multi_thread", worker_threads = 2)]
async fn main() {
    built_in().await;
    let quickjs = scripts(ScriptRuntime::QuickJs).await;
    let deno = scripts(ScriptRuntime::Deno).await;
    print_row("of each script engine", "quickjs", "deno", "");
    for ((name, first, unit), (_, second, _)) in quickjs.into_iter().zip(deno) {
        print_row(&name, &format!("{first:.0}"), &format!("{second:.0}"), unit);
    }
}

#[allow(clippy::print_stdout)]
fn print_row(name: &str, first: &str, second: &str, unit: &str) {
    println!("{name:<55}{first:>12}{second:>12}  {unit}");
}

#[allow(clippy::cast_precision_loss)]
async fn built_in() {
    const MAPPINGS: usize = 50_000;
    let steps = json!([
        { "function": "scale", "factor": 3, "divisor": 2 },
        { "function": "deadband", "absolute": 0.1 },
    ]);
    let mut running = Running::start(MappingEngineConfig::default());
    let before = resident_kb("self");
    let begun = Instant::now();
    running.put(MAPPINGS, &steps).await;
    say("50 000 built-in mappings put", begun.elapsed().as_secs_f64() * 1000.0, "ms");
    let rounds = 40;
    let took = running.feed(MAPPINGS, 1, rounds).await;
    let values = MAPPINGS as f64 * rounds as f64;
    say("values per second, built-in", values / took.as_secs_f64(), "1/s");
    say(
        "memory per built-in mapping",
        (resident_kb("self") - before) as f64 * 1024.0 / MAPPINGS as f64,
        "B",
    );
    running.shutdown.cancel();
}

/// Name, value and unit.
type Figure = (String, f64, &'static str);

/// Names of scripts by what they do, with their text.
const SCRIPTS: [(&str, &str); 3] = [
    ("a factor", "(value) => Number(value) * 0.1 + 1"),
    (
        "a state",
        "(value, ctx) => { ctx.state = (ctx.state ?? 0) + 1; return Number(value) * 0.1 + ctx.state }",
    ),
    (
        "a loop of 1 000 roots",
        "(value) => { let sum = 0; for (let i = 0; i < 1000; i++) sum += Math.sqrt(Number(value) + i); return sum }",
    ),
];

/// Measures the scripts with one engine, each in many mappings.
#[allow(clippy::cast_precision_loss)]
async fn scripts(engine: ScriptRuntime) -> Vec<Figure> {
    const MAPPINGS: usize = 1000;
    const ROUNDS: i64 = 4;
    let mut figures = Vec::new();
    for (name, source) in SCRIPTS {
        let mut config = MappingEngineConfig::default();
        config.script.engine = engine;
        let packages = concat!(env!("CARGO_MANIFEST_DIR"), "/script-deno/node_modules/@deno");
        let platform =
            if cfg!(target_arch = "aarch64") { "linux-arm64-glibc" } else { "linux-x64-glibc" };
        config.script.deno_path = Some(Path::new(packages).join(platform).join("deno"));
        let mut running = Running::start(config);
        let before = resident_kb("self");
        let begun = Instant::now();
        running.put(MAPPINGS, &json!([{ "function": "script", "source": source }])).await;
        running.feed(MAPPINGS, 1, 1).await;
        let ready = begun.elapsed().as_secs_f64() * 1000.0;
        figures.push((format!("{name}: 1000 mappings put and first values"), ready, "ms"));
        let took = running.feed(MAPPINGS, 32, ROUNDS).await;
        let values = MAPPINGS as f64 * 32.0 * ROUNDS as f64;
        figures.push((format!("{name}: values per second"), values / took.as_secs_f64(), "1/s"));
        let worker: u64 = children().iter().map(|process| resident_kb(process)).sum();
        let grown = resident_kb("self").saturating_sub(before);
        let each = (worker + grown) as f64 * 1024.0 / MAPPINGS as f64;
        figures.push((format!("{name}: memory per mapping"), each, "B"));
        running.shutdown.cancel();
        // The next one is measured without the workers of this one.
        while !children().is_empty() {
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    }
    figures
}
