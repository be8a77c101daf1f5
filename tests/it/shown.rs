//! Reports of the real platform, compared with what left, by a recipient's own audit.

use std::{path::Path, process::Command, time::Duration};

use serde_json::Value;
use verbund_tests::{
    demo,
    frame_order::{BUYER, MUNICH},
    harness::{Steps, binary, eventually},
    world::{Places, World},
};

fn run(program: &str, arguments: &[&str]) -> (bool, String) {
    let output = Command::new(binary(program).unwrap()).args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let errors = text(&output.stderr);
    assert!(output.status.code() < Some(2), "{program} {arguments:?}: {errors}");
    (output.status.success(), text(&output.stdout))
}

fn write(folder: &Path, name: &str, content: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path.display().to_string()
}

#[tokio::test(flavor = "multi_thread")]
async fn what_the_platform_shows_is_what_left() {
    rustls::crypto::ring::default_provider().install_default().ok();
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut world = World::start(Places::anywhere(folder.to_owned()).unwrap()).unwrap();
    let cast = demo::play(&mut world, &mut Steps::default()).await.unwrap();
    let page = eventually("a page of reports", Duration::from_secs(60), || async {
        let path = "/api/v1/reports?limit=200";
        let page: Value = cast.platform.get(path).await.map_err(|error| format!("{error:#}"))?;
        let reports = page["items"].as_array().cloned().unwrap_or_default();
        let of_munich = reports.iter().filter(|report| report["factoryId"] == MUNICH).count();
        if of_munich > 20 { Ok(page) } else { Err(format!("{of_munich} reports")) }
    })
    .await
    .unwrap();

    let config = folder.join(format!("connector-{MUNICH}.toml")).display().to_string();
    let of_buyer = ["--recipient", BUYER, "--config", &config];
    let ledger = |command: &[&str]| run("factory-connector", &[command, &of_buyer[..]].concat()).1;
    let audit = write(folder, "audit.jsonl", &ledger(&["ledger", "audit"]));
    let checkpoint = write(folder, "kept.note", &ledger(&["ledger", "checkpoint"]));
    let key = ledger(&["ledger", "checkpoint", "--key"]);
    let compare = |page: &Value| {
        let export = write(folder, "shown.json", &page.to_string());
        let arguments = ["--checkpoint", &checkpoint, "--key", key.trim(), "--shown", &export];
        run("asi", &[&["ledger", "verify", &audit], &arguments[..]].concat())
    };
    let (is_intact, outcome) = compare(&page);
    assert!(is_intact, "{outcome}");
    let compared: Value = serde_json::from_str(&outcome).unwrap();
    assert!(compared["shown"]["reportsCompared"].as_u64() > Some(20), "{outcome}");

    // A report of others, as a platform would show it that disregards the list of recipients.
    let mut widened = page.clone();
    let reports = widened["items"].as_array_mut().unwrap();
    let mut other = reports.iter().find(|report| report["factoryId"] == MUNICH).unwrap().clone();
    other["dataSetWriterId"] = 999.into();
    reports.push(other);
    let (is_intact, outcome) = compare(&widened);
    assert!(!is_intact && outcome.contains("shown, but never left for you"), "{outcome}");
    world.stop().unwrap();
}
