//! The broker in a process of its own, as by default: the pages outlive it, and it does what they say.

use std::process::Command;

use serde_json::json;

use crate::{
    connector::Peer,
    enrolment::{is_down, is_up},
    harness::{World, eventually},
    story,
};

/// Held by each test: they tell processes by their parent, which is the same for all.
static ONE_AT_A_TIME: tokio::sync::Mutex<()> = tokio::sync::Mutex::const_new(());

/// Returns the ids of the running broker processes that this process has started.
fn brokers_of(parent: u32) -> Vec<u32> {
    let tasks = std::fs::read_dir(format!("/proc/{parent}/task")).expect("threads");
    let children = tasks
        .flatten()
        .filter_map(|task| std::fs::read_to_string(task.path().join("children")).ok());
    let children: Vec<u32> = children
        .flat_map(|ids| ids.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
        .map(|id| id.parse().expect("a process id"))
        .collect();
    let is_broker = |id: &u32| {
        let line = std::fs::read_to_string(format!("/proc/{id}/cmdline")).unwrap_or_default();
        line.contains("--supervised")
    };
    children.into_iter().filter(is_broker).collect()
}

fn kill(id: u32) {
    let status = Command::new("kill").args(["-KILL", &id.to_string()]).status().expect("kill runs");
    assert!(status.success(), "{id} is killed");
}

/// Waits until a broker process other than `former` runs.
async fn another(former: u32) -> u32 {
    eventually("another broker process", || async {
        let all = brokers_of(std::process::id());
        all.iter().copied().find(|id| *id != former).ok_or_else(|| format!("{all:?}"))
    })
    .await
}

async fn readiness(world: &World) -> (u16, String) {
    let answer = reqwest::get(format!("{}/readyz", world.url())).await.expect("an answer");
    (answer.status().as_u16(), answer.text().await.expect("a text"))
}

async fn is_ready(world: &World) {
    eventually("the platform is ready", || async {
        let (status, text) = readiness(world).await;
        if status == 200 { Ok(()) } else { Err(text) }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn pages_outlive_the_broker_and_it_comes_back_with_all_it_had() {
    let _turn = ONE_AT_A_TIME.lock().await;
    let world = World::start_with_broker_process().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    is_ready(&world).await;
    let first = another(0).await;
    kill(first);
    eventually("the platform says what is away", || async {
        let (status, text) = readiness(&world).await;
        let is_shown = status == 503 && text.contains("the broker has died");
        if is_shown { Ok(()) } else { Err(text) }
    })
    .await;
    // Pages and API answer meanwhile, and what is said now reaches the next process.
    admin.get("/factories").await.expect_ok();
    admin.get("/status").await.expect_ok();
    let token = admin.post("/factories/FOR_MUC/enrolment-tokens", json!({})).await.expect_ok();
    let enrolment =
        world.anonymous().post("/enrolments", json!({ "token": token["token"] })).await.expect_ok();
    let second = another(first).await;
    is_ready(&world).await;
    is_up(&Peer::connector(&enrolment, "FOR_MUC")).await;
    is_up(&munich).await;
    munich.send("ua-data", &story::report("after", 0, 3));
    story::value_is(&buyer, "3").await;
    let status = admin.get("/status").await.expect_ok();
    assert!(status["queues"].as_array().is_some_and(|queues| !queues.is_empty()), "{status}");
    let disk = status["brokerDisk"].as_str().unwrap_or_default();
    assert!(["ENOUGH", "SHORT", "FULL"].contains(&disk), "it looks at its disk: {status}");
    assert_ne!(first, second);
}

/// Returns the addition to the score of a process by which the kernel chooses whom it ends for memory.
fn oom_score_adj(id: u32) -> i32 {
    let score = std::fs::read_to_string(format!("/proc/{id}/oom_score_adj")).expect("a score");
    score.trim().parse().expect("a number")
}

#[tokio::test(flavor = "multi_thread")]
async fn the_kernel_takes_the_broker_before_the_pages() {
    let _turn = ONE_AT_A_TIME.lock().await;
    let _world = World::start_with_broker_process().await;
    let broker = another(0).await;
    let (of_broker, own) = (oom_score_adj(broker), oom_score_adj(std::process::id()));
    assert!(of_broker > own, "{of_broker} is not above {own}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_revocation_reaches_the_process_of_the_broker_at_once() {
    let _turn = ONE_AT_A_TIME.lock().await;
    let world = World::start_with_broker_process().await;
    let admin = story::set_up(&world).await;
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    is_up(&munich).await;
    let revoked = admin.delete("/factories/FOR_MUC/credentials").await.expect_ok();
    assert_eq!((&revoked["credentials"], &revoked["connections"]), (&json!(1), &json!(1)));
    is_down(&munich).await;
    let metrics = reqwest::get(format!("{}/metrics", world.url())).await.expect("an answer");
    assert_eq!(metrics.status().as_u16(), 200);
    eventually("the metrics of the process are shown, too", || async {
        let metrics = reqwest::get(format!("{}/metrics", world.url())).await.expect("an answer");
        let text = metrics.text().await.expect("a text");
        if text.contains("broker_handshakes_failed_total") { Ok(()) } else { Err(text) }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn the_process_of_the_broker_ends_with_its_platform() {
    let _turn = ONE_AT_A_TIME.lock().await;
    let mut world = World::start_with_broker_process().await;
    is_ready(&world).await;
    assert_eq!(brokers_of(std::process::id()).len(), 1);
    world.stop().await;
    assert!(brokers_of(std::process::id()).is_empty(), "an orderly end");

    // A platform that is killed cannot end anything.
    let folder = tempfile::tempdir().expect("a folder");
    let config = folder.path().join("platform.toml");
    let text = format!(
        "data_directory = {:?}\n[web]\nlisten = \"127.0.0.1:0\"\n[broker]\nlisten = \"127.0.0.1:0\"\n",
        folder.path().join("data")
    );
    std::fs::write(&config, text).expect("written");
    let mut platform = Command::new(env!("CARGO_BIN_EXE_platform"))
        .args(["serve", "--config"])
        .arg(&config)
        .spawn()
        .expect("a platform");
    let id = platform.id();
    let broker = eventually("its broker runs", || async {
        brokers_of(id).first().copied().ok_or_else(|| "no child".to_owned())
    })
    .await;
    platform.kill().expect("killed");
    platform.wait().expect("reaped");
    eventually("its broker ends", || async {
        let line = std::fs::read_to_string(format!("/proc/{broker}/cmdline")).unwrap_or_default();
        if line.is_empty() { Ok(()) } else { Err(line) }
    })
    .await;
}
