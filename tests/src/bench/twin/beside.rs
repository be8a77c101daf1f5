//! The same scenario on the twin and on a server written with node-opcua: 5000 variables, all of
//! which change every 100 ms, to one client. Processor time and memory of the two servers, and
//! their ratios.

use std::{
    path::Path,
    process::Stdio,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use opcua_stack::opcua::types::{DateTime, NodeId};
use serde_json::Value;
use tokio::{
    io::{AsyncBufReadExt as _, BufReader},
    process::{Child, Command},
};

use super::{
    client::Client,
    server::{PERIOD, VARIABLES},
};
use crate::{
    bench::{
        figures::{distribution, result},
        part::Part,
    },
    harness::repository,
};

/// Time of the measurement, after a while of getting warm.
const SPAN: Duration = Duration::from_secs(10);
const WARM: Duration = Duration::from_secs(3);
/// Time that a server may take to start.
const START_TIMEOUT: Duration = Duration::from_secs(60);
/// Number of notifications of which one latency is recorded.
const LATENCY_EVERY: usize = 50;

/// Resources that one server took.
struct Taken {
    per_second: f64,
    processor_percent: f64,
    memory_mib: f64,
    latencies: Vec<Duration>,
}

/// Measures both, one after the other.
pub(super) async fn measure() -> anyhow::Result<Vec<Value>> {
    let mut ours = Part::Serve.command()?;
    let ours = scenario(ours.stdin(Stdio::piped()).spawn().context("starting the twin")?).await?;
    let port = free_ports::reserve::<1>()?[0];
    let theirs = Command::new("node")
        .arg(repository()?.join("tests/foreign/opcua/bench_server.js"))
        .args([port.to_string(), VARIABLES.to_string(), PERIOD.as_millis().to_string()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .kill_on_drop(true)
        .spawn()
        .context("starting node; run tests/foreign/setup.sh first")?;
    let theirs = scenario(theirs).await?;
    let mut results = Vec::new();
    for (who, taken) in [("twin", &ours), ("node-opcua", &theirs)] {
        let scenario =
            format!("{who}: {VARIABLES} variables changing every {} ms", PERIOD.as_millis());
        results.push(result(
            &format!("{scenario}, notifications received"),
            taken.per_second,
            "per second",
        ));
        results.push(result(
            &format!("{scenario}, processor"),
            taken.processor_percent,
            "% of a core",
        ));
        results.push(result(&format!("{scenario}, memory"), taken.memory_mib, "MiB"));
        results.extend(distribution(&format!("{scenario}, latency"), taken.latencies.clone()));
    }
    results.push(result(
        "node-opcua's processor time for one of the twin's",
        theirs.processor_percent / ours.processor_percent,
        "times",
    ));
    results.push(result(
        "node-opcua's memory for one of the twin's",
        theirs.memory_mib / ours.memory_mib,
        "times",
    ));
    Ok(results)
}

/// Runs the scenario against a server that has just been started, and ends it.
async fn scenario(mut server: Child) -> anyhow::Result<Taken> {
    let folder = tempfile::tempdir()?;
    let taken = observe(&mut server, folder.path()).await;
    // Its standard input ends, and so does it; else it is ended.
    drop(server.stdin.take());
    if tokio::time::timeout(Duration::from_secs(5), server.wait()).await.is_err() {
        server.kill().await?;
    }
    taken
}

async fn observe(server: &mut Child, folder: &Path) -> anyhow::Result<Taken> {
    let output = server.stdout.take().context("the server's output is read")?;
    let mut lines = BufReader::new(output).lines();
    let first = async {
        while let Some(line) = lines.next_line().await? {
            if let Ok(said) = serde_json::from_str::<Value>(&line) {
                return anyhow::Ok(said);
            }
        }
        anyhow::bail!("the server ended")
    };
    let said =
        tokio::time::timeout(START_TIMEOUT, first).await.context("waiting for the server")??;
    let nodes: Vec<NodeId> = said["nodes"]
        .as_array()
        .context("the server names its nodes")?
        .iter()
        .filter_map(|node| node.as_str()?.parse().ok())
        .collect();
    anyhow::ensure!(nodes.len() == VARIABLES, "the server names {} nodes", nodes.len());
    let client =
        Client::connect(said["url"].as_str().context("the server names its endpoint")?, folder)
            .await?;
    let mut changes = client.subscribe(&nodes, PERIOD).await?;
    let pid = server.id().context("the server runs")?;

    let warm = Instant::now() + WARM;
    while Instant::now() < warm {
        tokio::time::timeout(START_TIMEOUT, changes.recv()).await.context("waiting for changes")?;
    }
    while changes.try_recv().is_ok() {}
    let (start, processor) = (Instant::now(), processor_time(pid)?);
    let (mut received, mut latencies) = (0_usize, Vec::new());
    while start.elapsed() < SPAN {
        let change =
            tokio::time::timeout(SPAN, changes.recv()).await.context("waiting for changes")?;
        let (_, value) = change.context("the subscription goes on")?;
        received += 1;
        if received.is_multiple_of(LATENCY_EVERY)
            && let Some(at) = value.source_timestamp
        {
            let age =
                (DateTime::now().as_chrono() - at.as_chrono()).num_microseconds().unwrap_or(0);
            latencies.push(Duration::from_micros(u64::try_from(age).unwrap_or(0)));
        }
    }
    let took = start.elapsed().as_secs_f64();
    let taken = Taken {
        per_second: received as f64 / took,
        processor_percent: (processor_time(pid)? - processor) / took * 100.0,
        memory_mib: memory_mib(pid)?,
        latencies,
    };
    client.close().await?;
    Ok(taken)
}

/// Processor time of a process in seconds.
fn processor_time(pid: u32) -> anyhow::Result<f64> {
    /// Ticks of the kernel's clock as processes see them.
    const TICKS_PER_SECOND: f64 = 100.0;
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat"))?;
    let after_name = stat.rsplit_once(')').context("reading a process's times")?.1;
    let fields: Vec<&str> = after_name.split_ascii_whitespace().collect();
    let ticks = |at: usize| fields.get(at).and_then(|field| field.parse::<f64>().ok());
    let (user, system) = ticks(11).zip(ticks(12)).context("reading a process's times")?;
    Ok((user + system) / TICKS_PER_SECOND)
}

/// Resident memory of a process.
fn memory_mib(pid: u32) -> anyhow::Result<f64> {
    let statm = std::fs::read_to_string(format!("/proc/{pid}/statm"))?;
    let pages: f64 = statm.split(' ').nth(1).context("reading a process's memory")?.parse()?;
    Ok(pages * 4096.0 / f64::from(1 << 20))
}
