//! Measurements in a process of their own, so that neither memory nor computing time is mixed with
//! what went before.

use std::{process::Stdio, time::Duration};

use anyhow::Context as _;
use serde_json::Value;
use tokio::process::Command;

use super::figures::result;

/// Time that one part may take.
const PART_TIMEOUT: Duration = Duration::from_secs(170);

/// Measurement in a process of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// The twin: memory of a field, and the time to show everything again.
    Fields,
    /// A connector that starts again.
    Restore,
    /// The twin: adding and browsing beside a reader.
    Readers,
    /// The twin: from a change to its notification.
    Latency,
    /// The twin: many items that change in one tick.
    Burst,
    /// The twin serves until its standard input ends.
    Serve,
    /// A million messages through link and broker.
    Traffic,
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
            Self::Traffic => "traffic",
        }
    }

    /// Makes the command that runs the part with this program.
    pub(super) fn command(self) -> anyhow::Result<Command> {
        let mut command = Command::new(std::env::current_exe().context("finding this program")?);
        command
            .args(["part", self.name()])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .kill_on_drop(true);
        Ok(command)
    }

    /// Runs the part and returns its figures.
    pub(super) async fn measure(self) -> anyhow::Result<Vec<Value>> {
        let run = self.command()?.stderr(Stdio::inherit()).output();
        let output = tokio::time::timeout(PART_TIMEOUT, run)
            .await
            .with_context(|| format!("the part {} takes too long", self.name()))??;
        anyhow::ensure!(output.status.success(), "the part {} failed", self.name());
        let found: Vec<Value> =
            serde_json::from_slice(&output.stdout).context("reading what a part found")?;
        let shown = found.iter().map(|one| {
            let (name, unit) = (
                one["name"].as_str().unwrap_or_default(),
                one["unit"].as_str().unwrap_or_default(),
            );
            result(name, one["value"].as_f64().unwrap_or(f64::NAN), unit)
        });
        Ok(shown.collect())
    }
}
