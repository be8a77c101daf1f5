//! A connector's data directory is copied and the copy started beside it, with the same credential.

use std::time::{Duration, Instant};

use anyhow::Context as _;
use serde_json::Value;

use super::{
    CommentTraffic, ControlTraffic, Fault, Stage, disturbances, drain, flow::flows, judge,
};
use crate::{
    frame_order::MUNICH,
    harness::{Api, Daemon, Steps, eventually, say},
    scenario::load,
    world::{BrokerKind, World},
};

/// Time over which refusals are spread.
const REFUSALS: Duration = Duration::from_secs(60);
/// Time until all sides know of the copy: a renewal, and more on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Kills a connector, copies its data directory, starts it again and the copy beside it: the first
/// goes on at once, the copy is refused, both and the platform say so, and in the end the stores
/// are compared as after chaos.
///
/// # Errors
/// The promise that does not hold.
pub async fn copied(broker: BrokerKind) -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-copied-").tempdir()?;
    let mut steps = Steps::default();
    let (mut stage, cast) = Stage::set(folder.path().to_owned(), broker, &mut steps).await?;
    let mut copy = None;
    let outcome = async {
        steps.run("every writer is kept busy", load::put_on(&cast, &stage.world.places)).await?;
        // Shortened intervals are configured, and read at a start.
        stage.strike(Fault::KillAll).await?;
        flows(&mut stage).await?;
        beside(&mut stage, &mut steps, &mut copy).await
    }
    .await;
    if outcome.is_err() {
        for daemon in stage.world.daemons().chain(&mut copy) {
            say(&format!("\n--- the end of {}:\n{}", daemon.log().display(), daemon.log_tail(15)));
        }
    }
    outcome
}

fn original(stage: &mut Stage) -> anyhow::Result<&mut Daemon> {
    stage.world.factory(MUNICH)?.connector.as_mut().context("it was started")
}

/// Kills the connector and copies its store, and lets it go on.
async fn copied_and_killed(stage: &mut Stage) -> anyhow::Result<String> {
    let killed = disturbances::now();
    original(stage)?.kill()?;
    stage.world.copy_connector(MUNICH)?;
    original(stage)?.restart()?;
    stage.disturbed.struck(Fault::KillConnector(MUNICH), killed);
    let restarted = Instant::now();
    let munich = stage.world.connector_api(MUNICH).await?;
    lease(&munich, "HELD").await?;
    flows(stage).await?;
    Ok(format!("values flow after {:.1} s", restarted.elapsed().as_secs_f64()))
}

async fn beside(
    stage: &mut Stage,
    steps: &mut Steps,
    copy: &mut Option<Daemon>,
) -> anyhow::Result<()> {
    let comments = CommentTraffic::begin(&stage.world.places, &stage.comments_hurry.subscribe())?;
    let controls = ControlTraffic::begin(&stage.world.places, REFUSALS)?;
    steps.run("kill -9 of a connector, and it goes on at once", copied_and_killed(stage)).await?;
    steps
        .run("a copy of it is refused, and all three say so", async {
            let (daemon, mut second) = stage.world.start_copy(MUNICH)?;
            let daemon = copy.insert(daemon);
            World::copy_is_ready(&mut second, daemon).await?;
            let refused = lease(&second, "REFUSED").await?;
            let holder = refused["holder"]["host"].as_str().unwrap_or_default().to_owned();
            anyhow::ensure!(
                holder.ends_with(&format!("connector-{MUNICH}")),
                "the copy names {refused}"
            );
            eventually("the copy's link says why it is down", PATIENCE, || async {
                let status: Value =
                    second.get("/api/v1/status").await.map_err(|e| format!("{e:#}"))?;
                let reason = status["link"]["reason"].as_str().unwrap_or_default();
                if reason.contains("another connector speaks") {
                    Ok(())
                } else {
                    Err(status["link"].to_string())
                }
            })
            .await?;
            let munich = stage.world.connector_api(MUNICH).await?;
            eventually("the first names the copy", PATIENCE, || async {
                let held = lease(&munich, "HELD").await.map_err(|e| format!("{e:#}"))?;
                let host = held["contender"]["host"].as_str().unwrap_or_default();
                if host.ends_with("-copy") { Ok(()) } else { Err(held.to_string()) }
            })
            .await?;
            let platform = stage.world.platform_api().await?;
            eventually("the platform names both", PATIENCE, || async {
                let path = format!("/api/v1/factories/{MUNICH}/lease");
                let lease: Value = platform.get(&path).await.map_err(|e| format!("{e:#}"))?;
                let second = &lease["contenders"][0];
                let is_named = second["host"].as_str().is_some_and(|host| host.ends_with("-copy"));
                let is_whole = lease["holder"]["host"] == holder
                    && second["isSecond"] == true
                    && lease["leaseNumber"] == 1;
                if is_named && is_whole { Ok(()) } else { Err(lease.to_string()) }
            })
            .await?;
            flows(stage).await?;
            eventually("the copy keeps its values", PATIENCE, || async {
                let spool: Value =
                    second.get("/api/v1/spool").await.map_err(|e| format!("{e:#}"))?;
                if spool["waiting"].as_u64() > Some(0) { Ok(()) } else { Err(spool.to_string()) }
            })
            .await?;
            Ok(holder)
        })
        .await?;
    if let Some(copy) = copy {
        copy.kill()?;
    }
    let (said, taken) = (comments.end().await?, controls.end().await?);
    steps.run("the machines stop, and what waits arrives", drain(stage)).await?;
    steps.run("everything stops when asked", async { stage.stop().map(|()| "") }).await?;
    steps
        .run(
            "every report is held once, in order, and in the ledger",
            judge(stage, &said, Some(taken)),
        )
        .await
}

/// Waits until a connector says that its lease stands so.
async fn lease(connector: &Api, state: &str) -> anyhow::Result<Value> {
    eventually(&format!("the lease is {state}"), PATIENCE, || async {
        let status: Value = connector.get("/api/v1/status").await.map_err(|e| format!("{e:#}"))?;
        if status["lease"]["state"] == state {
            Ok(status["lease"].clone())
        } else {
            Err(status["lease"].to_string())
        }
    })
    .await
}
