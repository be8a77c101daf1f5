//! Throughput and memory of one connector with the changes of a machine: built-in functions and scripts into
//! report fields with reports each second, beside the bare subscription in the same run and the
//! same job done with node-opcua.

mod bank;
mod connector;

use std::time::{Duration, Instant};

use anyhow::Context as _;
use serde_json::{Value, json};
use shop_floor::{Config, InputKey, MonitorOptions, MonitorRequest, ShopFloor};
use tokio::process::Command;
use tokio_util::sync::CancellationToken;

use self::{
    bank::{Bank, node},
    connector::{Connector, Filled},
};
use super::{figures::result, usage::Usage};
use crate::harness::repository;

/// Time for which each rate is measured.
const SPAN: Duration = Duration::from_secs(10);
/// Mappings and offered changes per second: built in, scripts.
const BUILT_IN: u32 = 10_000;
const BUILT_IN_OFFERED: u32 = 150_000;
const SCRIPTS: u32 = 2_000;
const SCRIPTS_OFFERED: u32 = 80_000;
/// Mappings that are to be live soon after the start.
const MANY: u32 = 50_000;
const PATIENCE: Duration = Duration::from_secs(120);

/// Measures all of it, one thing after the other.
pub(super) async fn measure() -> anyhow::Result<Vec<Value>> {
    let mut results = Vec::new();
    let scale = json!([{ "function": "scale", "factor": 0.1, "offset": 1 }]);
    let script = json!([{ "function": "script", "source": "(value) => Number(value) * 0.1 + 1" }]);

    let bank = Bank::start(BUILT_IN, BUILT_IN_OFFERED).await?;
    let bare = bare(&bank).await?;
    results.push(result("bare subscription", bare.rate(), "changes per second"));
    results.push(result("bare subscription", bare.per_cpu_second(), "changes per CPU second"));
    let (built_in, _) = rate(&bank, &scale).await?;
    results.extend(rates("built-in mappings into report fields", &built_in));
    results.push(result(
        "built-in mappings, share of the bare subscription",
        100.0 * built_in.rate() / bare.rate(),
        "%",
    ));
    drop(bank);

    let bank = Bank::start(SCRIPTS, SCRIPTS_OFFERED).await?;
    let empty = empty_bytes(&bank).await?;
    let (scripts, resident) = rate(&bank, &script).await?;
    results.extend(rates("JavaScript mappings into report fields", &scripts));
    let each = (resident as f64 - empty as f64) / f64::from(SCRIPTS);
    results.push(result("memory per JavaScript mapping, its worker's included", each, "bytes"));
    let (beside, _) = rate(&bank, &scale).await?;
    results.extend(rates("as many built-in mappings of the same machine", &beside));
    let node_opcua = node_opcua(&bank).await?;
    results.extend(rates("the same with node-opcua", &node_opcua));
    for (name, measured) in [("built-in", &beside), ("JavaScript", &scripts)] {
        let ratio = measured.per_cpu_second() / node_opcua.per_cpu_second();
        results.push(result(
            &format!("{name} mappings against node-opcua"),
            ratio,
            "times the values per CPU second",
        ));
    }
    drop(bank);

    let bank = Bank::start(MANY, 1_000).await?;
    let empty = empty_bytes(&bank).await?;
    let filled = Filled::with(&bank, &scale).await?;
    let begun = Instant::now();
    let mut connector = Connector::start(filled).await?;
    connector.until_live(MANY, PATIENCE).await?;
    results.push(result(
        "50 000 built-in mappings live after the start",
        begun.elapsed().as_secs_f64(),
        "s",
    ));
    let each = (connector.settled_bytes().await? as f64 - empty as f64) / f64::from(MANY);
    results.push(result(
        "memory per built-in mapping, subscription and field values included",
        each,
        "bytes",
    ));
    connector.stop()?;
    Ok(results)
}

/// Values through something in a while, and the CPU time of the processes that did it.
#[derive(Debug, Clone, Copy)]
struct Measured {
    values: f64,
    seconds: f64,
    cpu_seconds: f64,
}

impl Measured {
    fn between(before: (f64, Usage), after: (f64, Usage), took: Duration) -> Self {
        Self {
            values: after.0 - before.0,
            seconds: took.as_secs_f64(),
            cpu_seconds: after.1.cpu_seconds - before.1.cpu_seconds,
        }
    }

    fn rate(&self) -> f64 {
        self.values / self.seconds
    }

    fn per_cpu_second(&self) -> f64 {
        self.values / self.cpu_seconds
    }
}

fn rates(name: &str, measured: &Measured) -> [Value; 2] {
    [
        result(name, measured.rate(), "changes per second"),
        result(name, measured.per_cpu_second(), "changes per CPU second"),
    ]
}

/// Measures the subscription alone, in this process.
async fn bare(bank: &Bank) -> anyhow::Result<Measured> {
    let folder = tempfile::tempdir()?;
    let config =
        Config::new(folder.path().join("pki"), "Verbund benchmark", "urn:verbund:bench:shop-floor");
    let (floor, handle, mut changes) = ShopFloor::new(config);
    let stop = CancellationToken::new();
    let running = tokio::spawn(floor.run(stop.clone()));
    let source = bank.source()?;
    let requests = (0..bank.variables).map(|index| {
        Ok(MonitorRequest {
            input: InputKey(u64::from(index)),
            source: source.source_id.clone(),
            node_id: node(index).parse()?,
            options: MonitorOptions {
                sampling_interval_ms: Some(0.0),
                ..MonitorOptions::default()
            },
        })
    });
    handle.monitor_many(requests.collect::<anyhow::Result<_>>()?)?;
    handle.put_source(source)?;
    let begun = Instant::now();
    let is_settled = |state: &shop_floor::SourceStatus| {
        state.live.min(state.findable) == bank.variables as usize
    };
    while !handle.states().first().is_some_and(is_settled) {
        anyhow::ensure!(begun.elapsed() < PATIENCE, "the bank's variables did not become live");
        tokio::time::timeout(Duration::from_millis(20), changes.recv()).await.ok();
    }
    let usage = || Usage::of_one(std::process::id());
    let (before, begun, mut values) = (usage()?, Instant::now(), 0.0);
    while begun.elapsed() < SPAN {
        let batch = changes.recv().await.context("the shop floor runs")?;
        values += batch.len() as f64;
    }
    let took = begun.elapsed();
    let after = usage()?;
    stop.cancel();
    running.await?;
    Ok(Measured::between((0.0, before), (values, after), took))
}

/// Memory of a connector that was asked for a field per variable of the bank and maps none.
async fn empty_bytes(bank: &Bank) -> anyhow::Result<u64> {
    let mut connector = Connector::start(Filled::with(bank, &json!(null)).await?).await?;
    let resident = connector.settled_bytes().await?;
    connector.stop()?;
    Ok(resident)
}

/// Measures a connector with one such mapping per variable of the bank: the rate of values, and the
/// memory in bytes.
async fn rate(bank: &Bank, steps: &Value) -> anyhow::Result<(Measured, u64)> {
    let mut connector = Connector::start(Filled::with(bank, steps).await?).await?;
    connector.until_live(bank.variables, PATIENCE).await?;
    // What follows a start once is not counted: values that waited for it, and learning where nodes
    // hang.
    connector.until_paths_are_learned(bank.variables, PATIENCE).await?;
    tokio::time::sleep(Duration::from_secs(3)).await;
    let (before, begun) = ((connector.candidates().await?, connector.usage()?), Instant::now());
    tokio::time::sleep(SPAN).await;
    let after = (connector.candidates().await?, connector.usage()?);
    let took = begun.elapsed();
    connector.stop()?;
    Ok((Measured::between(before, after, took), after.1.resident_bytes))
}

/// Client, function and server with node-opcua.
async fn node_opcua(bank: &Bank) -> anyhow::Result<Measured> {
    let root = repository()?;
    let folder = tempfile::tempdir()?;
    let output = Command::new("node")
        .env("NODE_PATH", root.join("tests/foreign/node_modules"))
        .arg(root.join("tests/foreign/opcua/mapping_job.js"))
        .args([
            bank.endpoint.as_str(),
            bank::NAMESPACE,
            &bank.variables.to_string(),
            &SPAN.as_secs().to_string(),
        ])
        .arg(folder.path())
        .kill_on_drop(true)
        .output();
    let output =
        tokio::time::timeout(PATIENCE, output).await.context("node-opcua did not end")??;
    let line = String::from_utf8_lossy(&output.stdout);
    let line = line.lines().last().unwrap_or_default();
    let json: Value = serde_json::from_str(line).with_context(|| {
        format!("mapping_job.js printed {line:?}: {}", String::from_utf8_lossy(&output.stderr))
    })?;
    let number = |name: &str| json[name].as_f64().with_context(|| format!("{name} is missing"));
    Ok(Measured {
        values: number("values")?,
        seconds: number("seconds")?,
        cpu_seconds: number("cpuSeconds")?,
    })
}
