//! A connector's data directory is replaced by an older copy, as after a restored backup: the
//! platform, which has countersigned the ledger, knows more than the store.

use std::{path::PathBuf, process::Command, time::Duration};

use anyhow::Context as _;
use serde_json::{Value, json};

use super::{
    Fault, Stage, drain,
    flow::flows,
    judge,
    stores::{self, given_up},
};
use crate::{
    frame_order::MUNICH,
    harness::{Api, Daemon, Steps, eventually, say},
    scenario::load,
    world::BrokerKind,
};

/// Time for an answer of the platform. A restored store is another place to the lease, which passes
/// once the former one is silent.
const PATIENCE: Duration = Duration::from_secs(120);

/// Replaces a connector's store by an older copy: it discloses nothing until an engineer begins new
/// logs, and then goes on. In the end the stores are compared as after chaos: the older store gives no number again.
///
/// # Errors
/// The promise that does not hold.
pub async fn rolled_back() -> anyhow::Result<()> {
    let folder = tempfile::Builder::new().prefix("verbund-rolled-back-").tempdir()?;
    let mut steps = Steps::default();
    let (mut stage, cast) =
        Stage::set(folder.path().to_owned(), BrokerKind::Embedded, &mut steps).await?;
    let outcome = async {
        steps.run("every writer is kept busy", load::put_on(&cast, &stage.world.places)).await?;
        stage.strike(Fault::KillAll).await?;
        flows(&mut stage).await?;
        replaced(&mut stage, &mut steps).await
    }
    .await;
    if outcome.is_err() {
        for daemon in stage.world.daemons() {
            say(&format!("\n--- the end of {}:\n{}", daemon.log().display(), daemon.log_tail(15)));
        }
        say(&format!("Kept for a look: {}", folder.keep().display()));
    }
    outcome
}

fn connector(stage: &mut Stage) -> anyhow::Result<&mut Daemon> {
    stage.world.factory(MUNICH)?.connector.as_mut().context("it was started")
}

async fn replaced(stage: &mut Stage, steps: &mut Steps) -> anyhow::Result<()> {
    steps
        .run("the platform countersigns the ledger, and a copy is put aside", async {
            let size = witnessed(stage, 0).await?;
            connector(stage)?.kill()?;
            stage.world.copy_connector(MUNICH)?;
            connector(stage)?.restart()?;
            // What this start submits is in the copy, too; what the next one submits is not.
            let size = witnessed(stage, size).await?;
            flows(stage).await?;
            connector(stage)?.restart()?;
            let later = witnessed(stage, size).await?;
            Ok(format!("{size} leaves, then {later}"))
        })
        .await?;
    steps
        .run("the older store is found, and nothing is disclosed", async {
            connector(stage)?.kill()?;
            let folder = &stage.world.places.folder;
            stage.former = stores::left(folder, MUNICH).await?;
            stage.former_given_up = given_up::given_up(folder, MUNICH).await?;
            restore(stage)?;
            connector(stage)?.restart()?;
            let munich = stage.world.connector_api(MUNICH).await?;
            let conflicts = eventually("the conflict is shown", PATIENCE, || async {
                let status: Value = get(&munich, "/api/v1/status").await?;
                let conflicts = status["ledgerConflicts"].as_array().cloned().unwrap_or_default();
                if !conflicts.is_empty() {
                    return Ok(conflicts);
                }
                let logs: Value = get(&munich, "/api/v1/ledger/logs").await?;
                Err(format!("lease {}, logs {logs}", status["lease"]))
            })
            .await?;
            eventually("values wait", PATIENCE, || async {
                let spool: Value = get(&munich, "/api/v1/spool").await?;
                if spool["waiting"].as_u64() > Some(0) { Ok(()) } else { Err(spool.to_string()) }
            })
            .await?;
            let kinds: Vec<&str> =
                conflicts.iter().filter_map(|conflict| conflict["kind"].as_str()).collect();
            Ok(kinds.join(", "))
        })
        .await?;
    steps
        .run("an engineer begins new logs, and values leave again", async {
            let munich = stage.world.connector_api(MUNICH).await?;
            let count = begin_logs(&munich).await?;
            flows(stage).await?;
            Ok(format!("{count} logs"))
        })
        .await?;
    steps.run("the machines stop, and what waits arrives", drain(stage)).await?;
    steps.run("everything stops when asked", async { stage.stop().map(|()| "") }).await?;
    steps
        .run("every report is held once, in order, and in the ledger", judge(stage, &[], None))
        .await
}

async fn get(api: &Api, path: &str) -> Result<Value, String> {
    api.get(path).await.map_err(|error| format!("{error:#}"))
}

/// Waits until all logs are countersigned with more leaves than this; the fewest leaves of one.
async fn witnessed(stage: &mut Stage, more_than: u64) -> anyhow::Result<u64> {
    let munich = stage.world.connector_api(MUNICH).await?;
    eventually("the logs are countersigned", PATIENCE, || async {
        let logs: Value = get(&munich, "/api/v1/ledger/logs").await?;
        let sizes = logs["items"].as_array().into_iter().flatten();
        let least = sizes.map(|log| log["witnessed"]["size"].as_u64().unwrap_or_default()).min();
        least.filter(|least| *least > more_than).ok_or_else(|| logs.to_string())
    })
    .await
}

/// Puts the copy in the place of the connector's data directory, which may be a mount point.
fn restore(stage: &Stage) -> anyhow::Result<()> {
    let folder = &stage.world.places.folder;
    let original: PathBuf = folder.join(format!("connector-{MUNICH}"));
    let copy = folder.join(format!("connector-{MUNICH}-copy"));
    for entry in std::fs::read_dir(&original)? {
        let path = entry?.path();
        if path.is_dir() { std::fs::remove_dir_all(path)? } else { std::fs::remove_file(path)? }
    }
    let restored = Command::new("cp").arg("-a").arg(copy.join(".")).arg(&original).status()?;
    anyhow::ensure!(restored.success(), "restoring {} failed", original.display());
    Ok(())
}

/// Begins a new log for each conflict until there is none; the number of them.
async fn begin_logs(munich: &Api) -> anyhow::Result<usize> {
    eventually("no conflict is left", PATIENCE, || async {
        let logs: Value = get(munich, "/api/v1/ledger/logs").await?;
        let logs = logs["items"].as_array().cloned().unwrap_or_default();
        for log in logs.iter().filter(|log| !log["conflict"].is_null()) {
            let recipient = log["recipientId"].as_str().unwrap_or_default();
            let path = format!("/api/v1/ledger/logs/{recipient}/successor");
            let body = json!({ "reason": "An older backup was restored." });
            let begun: anyhow::Result<Value> = munich.post(&path, &body).await;
            begun.map_err(|error| format!("{error:#}"))?;
        }
        let is_whole = !logs.is_empty()
            && logs.iter().all(|log| log["conflict"].is_null())
            && logs.iter().all(|log| !log["witnessed"].is_null())
            && logs.iter().any(|log| log["epoch"] == 2);
        if is_whole { Ok(logs.len()) } else { Err(json!(logs).to_string()) }
    })
    .await
}
