//! Other people's stacks as commands: Python and Node scripts under `tests/foreign`.

use std::{path::PathBuf, process::Stdio, time::Duration};

use anyhow::Context as _;
use serde_json::Value;
use tokio::process::Command;

/// Returns the root of the repository.
///
/// # Errors
/// When it is not where this program was built.
pub fn repository() -> anyhow::Result<PathBuf> {
    let root = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    root.canonicalize().context("finding the repository this program was built from")
}

/// Runs a Python script of `tests/foreign` with the packages of `tests/foreign/setup.sh`, and
/// returns the JSON lines it prints with whether it ended well.
///
/// # Errors
/// When it cannot be started or does not end in time.
pub async fn python(
    script: &str,
    arguments: &[&str],
    limit: Duration,
) -> anyhow::Result<(Vec<Value>, bool)> {
    let root = repository()?;
    let mut command = Command::new(root.join("target/foreign/python/bin/python"));
    command.arg(root.join("tests/foreign").join(script)).args(arguments);
    command.stdin(Stdio::null()).stderr(Stdio::piped()).kill_on_drop(true);
    let output = tokio::time::timeout(limit, command.output())
        .await
        .with_context(|| format!("{script} did not end within {limit:?}"))?
        .with_context(|| format!("starting {script}; run tests/foreign/setup.sh first"))?;
    let lines: Vec<Value> = String::from_utf8_lossy(&output.stdout)
        .lines()
        .filter_map(|line| serde_json::from_str(line).ok())
        .collect();
    if lines.is_empty() {
        anyhow::bail!("{script} printed nothing: {}", String::from_utf8_lossy(&output.stderr));
    }
    Ok((lines, output.status.success()))
}
