//! Latency of a change from the machine to the buyer's page.

use std::time::{Duration, Instant};

use anyhow::Context as _;
use futures::StreamExt as _;
use serde_json::{Value, json};

use crate::{frame_order::MUNICH, harness::Api, world::World};

/// Sets a counter on the machine so many times and says how long each took to the buyer's live
/// stream.
pub(super) async fn of_values(world: &World, platform: &Api, times: u32) -> anyhow::Result<String> {
    let mut latencies = measure(world, platform, times).await?;
    latencies.sort_unstable();
    let at = |share: usize| latencies[(latencies.len() - 1) * share / 100].as_millis();
    Ok(format!("median {} ms, 90 % within {} ms, {} changes", at(50), at(90), latencies.len()))
}

/// Measures the latency of each change, from the machine to the buyer's live stream.
///
/// # Errors
/// When a change stays away for ten seconds.
pub async fn measure(world: &World, platform: &Api, times: u32) -> anyhow::Result<Vec<Duration>> {
    let machines = world.machines_api(MUNICH)?;
    let path = "/machines/MillingCell1/variables/Production.PartCounter";
    let first: Value = machines.get("/machines/MillingCell1/variables").await?;
    let counter = first
        .as_array()
        .and_then(|all| all.iter().find(|v| v["key"] == "Production.PartCounter"))
        .and_then(|v| v["value"].as_u64())
        .context("the machine has no part counter")?;
    let mut events = platform.events("/api/v1/live").await?.bytes_stream();
    let mut text = String::new();
    let mut latencies = Vec::new();
    for step in 1..=u64::from(times) {
        text.clear();
        let start = Instant::now();
        machines.post::<Value>(path, &json!({ "value": counter + step })).await?;
        let seen = async {
            while !text.contains("progressStatus") {
                let chunk = events.next().await.context("the live stream ended")??;
                text.push_str(&String::from_utf8_lossy(&chunk));
            }
            anyhow::Ok(start.elapsed())
        };
        latencies.push(
            tokio::time::timeout(Duration::from_secs(10), seen)
                .await
                .context("a change stayed away")??,
        );
    }
    machines.delete::<Value>(path).await?;
    Ok(latencies)
}
