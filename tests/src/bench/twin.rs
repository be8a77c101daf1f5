//! The twin's own figures, and the same scenario on a server written with node-opcua beside it.

mod beside;
mod client;
pub(super) mod own;
pub(super) mod restore;
pub(super) mod server;

use std::time::Duration;

use serde_json::Value;

use super::{
    distribution,
    part::{Part, figure},
    result,
};

/// Measures everything about the twin.
///
/// # Errors
/// When a part fails or takes too long.
pub(super) async fn measure() -> anyhow::Result<Vec<Value>> {
    let mut results = Vec::new();
    for part in [Part::Fields, Part::Restore, Part::Readers, Part::Latency, Part::Burst] {
        results.extend(part.measure().await?);
    }
    results.extend(beside::measure().await?);
    Ok(results)
}

/// A sorted distribution at these shares in percent.
fn figures(name: &str, mut latencies: Vec<Duration>) -> Vec<Value> {
    latencies.sort_unstable();
    let at = |share: usize| latencies[(latencies.len() - 1) * share / 100].as_secs_f64() * 1000.0;
    [("median", 50), ("99 %", 99), ("slowest", 100)]
        .into_iter()
        .map(|(what, share)| {
            figure(&format!("{name}, {what} of {}", latencies.len()), at(share), "ms")
        })
        .collect()
}
