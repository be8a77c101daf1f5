//! Passwords of a running connector: sealed in its store, and changed without a stop.

use std::{path::Path, process::Command, time::Duration};

use serde_json::{Value, json};
use verbund_tests::{
    frame_order::MUNICH,
    harness::{Api, binary, eventually},
    scenario::story,
    world::{Places, World},
};

/// Runs a command of the connector beside the running one.
fn connector(places: &Places, arguments: &[&str]) -> String {
    let config = places.folder.join(format!("connector-{MUNICH}.toml"));
    let output = Command::new(binary("factory-connector").unwrap())
        .args(arguments)
        .arg("--config")
        .arg(config)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?} failed: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// Enrols the running connector once more: the newest two passwords of a factory are alive.
async fn enrol_again(places: &Places, platform: &Api) {
    let path = format!("/api/v1/factories/{MUNICH}/enrolment-tokens");
    let token: Value = platform.post(&path, &json!({})).await.unwrap();
    let file = places.folder.join("token-again");
    std::fs::write(&file, token["token"].as_str().unwrap()).unwrap();
    connector(places, &["enrol", "--token-file", &file.display().to_string()]);
}

fn key_of(data: &Path) -> String {
    std::fs::read_to_string(data.join("sealing-key")).unwrap()
}

async fn connects(connector: &Api) -> u64 {
    let status: Value = connector.get("/api/v1/status").await.unwrap();
    status["link"]["connects"].as_u64().unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn the_brokers_password_and_the_sealing_key_change_beside_a_running_connector() {
    rustls::crypto::ring::default_provider().install_default().ok();
    let folder = tempfile::tempdir().unwrap();
    let places = Places::anywhere(folder.path().to_owned()).unwrap();
    let data = places.folder.join(format!("connector-{MUNICH}"));
    let mut world = World::start(places.clone()).unwrap();
    let platform = world.platform_api().await.unwrap();
    story::found_collaboration(&platform).await.unwrap();
    story::join_factory(&mut world, &platform, MUNICH).await.unwrap();
    let running = world.connector_api(MUNICH).await.unwrap();
    story::link_is_up(&running).await.unwrap();
    let before = connects(&running).await;

    // The password that the link was opened with is dead after two more.
    enrol_again(&places, &platform).await;
    enrol_again(&places, &platform).await;
    let former_key = key_of(&data);
    connector(&places, &["seal", "rotate"]);
    assert_ne!(key_of(&data), former_key);

    world.platform.restart().unwrap();
    let patience = Duration::from_secs(60);
    eventually("the link is up again with the new password", patience, || async {
        let status: Value = running.get("/api/v1/status").await.map_err(|e| e.to_string())?;
        let is_up = status["link"]["state"] == "up";
        let connects = status["link"]["connects"].as_u64().unwrap_or_default();
        if is_up && connects > before { Ok(()) } else { Err(status["link"].to_string()) }
    })
    .await
    .unwrap();

    // And what is stored opens at the next start, with the new key alone.
    let key = key_of(&data);
    let newest = key.lines().next().unwrap();
    world.factory(MUNICH).unwrap().connector.as_mut().unwrap().kill().unwrap();
    std::fs::write(data.join("sealing-key"), format!("{newest}\n")).unwrap();
    world.factory(MUNICH).unwrap().connector.as_mut().unwrap().restart().unwrap();
    let running = world.connector_api(MUNICH).await.unwrap();
    story::link_is_up(&running).await.unwrap();
}
