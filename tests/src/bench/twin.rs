//! The twin's own figures, each in a process of its own so that memory and computing time are not mixed, and the same
//! scenario on a server written with node-opcua beside it.

mod beside;
mod client;
mod own;
mod restore;
mod server;

use std::{process::Stdio, time::Duration};

use anyhow::Context as _;
use serde_json::Value;
use tokio::process::Command;

use super::{distribution, result};

/// How long one part may take.
const PART_TIMEOUT: Duration = Duration::from_secs(170);

/// What runs in a process of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// Memory of a field, and the time to show everything again.
    Fields,
    /// A connector that starts again.
    Restore,
    /// Adding and browsing while somebody reads.
    Readers,
    /// From a change to its notification.
    Latency,
    /// Many items that change in one tick.
    Burst,
    /// Serves until its standard input ends.
    Serve,
}

impl Part {
    const fn name(self) -> &'static str {
        match self {
            Self::Fields => "fields",
            Self::Restore => "restore",
            Self::Readers => "readers",
            Self::Latency => "latency",
            Self::Burst => "burst",
            Self::Serve => "serve",
        }
    }
}

/// Measures everything about the twin.
///
/// # Errors
/// When a part fails or takes too long.
pub async fn measure() -> anyhow::Result<Vec<Value>> {
    let mut results = Vec::new();
    for part in [Part::Fields, Part::Restore, Part::Readers, Part::Latency, Part::Burst] {
        let run = command(part)?.stderr(Stdio::inherit()).output();
        let output = tokio::time::timeout(PART_TIMEOUT, run)
            .await
            .with_context(|| format!("the part {} takes too long", part.name()))??;
        anyhow::ensure!(output.status.success(), "the part {} failed", part.name());
        let found: Vec<Value> = serde_json::from_slice(&output.stdout).context("reading what a part found")?;
        for one in found {
            let (name, unit) = (one["name"].as_str().unwrap_or_default(), one["unit"].as_str().unwrap_or_default());
            results.push(result(name, one["value"].as_f64().unwrap_or(f64::NAN), unit));
        }
    }
    results.extend(beside::measure().await?);
    Ok(results)
}

/// Runs one part in this process and prints what it finds.
///
/// # Errors
/// When it fails.
pub async fn run_part(part: Part) -> anyhow::Result<Vec<Value>> {
    match part {
        Part::Fields => own::fields_and_restore(),
        Part::Restore => restore::measure().await,
        Part::Readers => own::readers().await,
        Part::Latency => own::latency().await,
        Part::Burst => own::burst().await,
        Part::Serve => server::serve().await.map(|()| Vec::new()),
    }
}

/// This program, to run a part.
fn command(part: Part) -> anyhow::Result<Command> {
    let mut command = Command::new(std::env::current_exe().context("finding this program")?);
    command.args(["part", part.name()]).stdin(Stdio::null()).stdout(Stdio::piped()).kill_on_drop(true);
    Ok(command)
}

/// One figure, for the program that asked.
fn figure(name: &str, value: f64, unit: &str) -> Value {
    serde_json::json!({ "name": name, "value": value, "unit": unit })
}

/// A sorted distribution at these shares in percent.
fn figures(name: &str, mut latencies: Vec<Duration>) -> Vec<Value> {
    latencies.sort_unstable();
    let at = |share: usize| latencies[(latencies.len() - 1) * share / 100].as_secs_f64() * 1000.0;
    [("median", 50), ("99 %", 99), ("slowest", 100)]
        .into_iter()
        .map(|(what, share)| figure(&format!("{name}, {what} of {}", latencies.len()), at(share), "ms"))
        .collect()
}
