//! Data directories written by version 0.1: today's programs open them, find all of it, and go on.

use std::{
    collections::BTreeSet,
    fs::Permissions,
    os::unix::fs::PermissionsExt as _,
    path::{Path, PathBuf},
    process::Command,
    time::Duration,
};

use anyhow::Context as _;
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};
use verbund_tests::{
    frame_order::{HAMBURG, MUNICH},
    harness::{Api, binary, eventually},
    scenario::story,
    world::{Places, World},
};

/// The pending field that is decided after the stores were opened.
const PENDING: &str = "/fields/weld-7/Weld1/ReqWeld1/pending1";
/// Time for a step on a busy machine.
const PATIENCE: Duration = Duration::from_secs(40);

fn fixture() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/store-0.1")
}

fn unpack(archive: &str, into: &Path) {
    let status = Command::new("tar")
        .arg("-xzf")
        .arg(fixture().join(format!("{archive}.tar.gz")))
        .arg("-C")
        .arg(into)
        .status()
        .unwrap();
    assert!(status.success(), "unpacking {archive} failed");
}

fn expected() -> Value {
    serde_json::from_slice(&std::fs::read(fixture().join("expected.json")).unwrap()).unwrap()
}

/// Runs a command of the connector that ends by itself and returns what it printed.
fn connector_command(places: &Places, factory_id: &str, arguments: &[&str]) -> String {
    let config = places.folder.join(format!("connector-{factory_id}.toml"));
    let output = Command::new(binary("factory-connector").unwrap())
        .args(arguments)
        .arg("--config")
        .arg(config)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?} of {factory_id} failed: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// Closes the data directory of a connector as its refusal says: version 0.1 left it open to every user
/// of the machine.
fn close_to_others(places: &Places, factory_id: &str) {
    let config = places.folder.join(format!("connector-{factory_id}.toml"));
    let mut command = Command::new(binary("factory-connector").unwrap());
    let refused = command.args(["users", "list", "--config"]).arg(config).output().unwrap();
    let (remedy, folder) = (String::from_utf8(refused.stderr).unwrap(), places.folder.clone());
    let folder = folder.join(format!("connector-{factory_id}"));
    assert!(!refused.status.success());
    assert!(remedy.contains(&format!("chmod 700 {}", folder.display())), "{remedy}");
    std::fs::set_permissions(&folder, Permissions::from_mode(0o700)).unwrap();
}

/// Expects that no file of a store is open to others.
fn files_are_closed(places: &Places, factory_id: &str) {
    for file in ["connector.sqlite", "connector.sqlite-wal", "generation", "ledger-key.pem"] {
        let path = places.folder.join(format!("connector-{factory_id}")).join(file);
        let mode = std::fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(mode & 0o077, 0, "{}", path.display());
    }
}

fn verify_ledger(places: &Places, factory_id: &str) -> Value {
    let found = connector_command(places, factory_id, &["ledger", "verify"]);
    let found: Value = serde_json::from_str(&found).unwrap();
    assert_eq!(found["faultCount"], 0, "{found:#}");
    found
}

/// Verifies the ledger and compares it with the one that was written, byte by byte.
fn ledger_is_as_written(places: &Places, factory_id: &str, expected: &Value) -> BTreeSet<String> {
    let found = verify_ledger(places, factory_id);
    for member in ["publicKey", "entries", "checkpoints", "revocations"] {
        assert_eq!(found[member], expected[member], "{member} of {factory_id}");
    }
    let export = connector_command(places, factory_id, &["ledger", "export"]);
    assert_eq!(export.lines().count(), expected["exportLines"].as_u64().unwrap() as usize);
    assert_eq!(hex::encode(Sha256::digest(&export)), expected["exportSha256"], "{factory_id}");
    entries(&export)
}

/// Empties values as retention of version 0.1 did, without a word about it in the ledger.
fn empty_old_values(places: &Places, factory_id: &str) {
    let store = places.folder.join(format!("connector-{factory_id}/connector.sqlite"));
    let store = rusqlite::Connection::open(store).unwrap();
    let sql = "UPDATE report SET body = NULL, salt = NULL WHERE state = 'DONE' AND id IN
                   (SELECT id FROM report WHERE state = 'DONE' ORDER BY id LIMIT 5)";
    assert!(store.execute(sql, ()).unwrap() > 0, "{factory_id} has finished reports");
}

/// Expects that each chain states what was found emptied, in words that claim no more.
fn former_retention_is_stated(export: &str) {
    let entries = export.lines().map(|line| {
        let line: Value = serde_json::from_str(line).unwrap();
        serde_json::from_str::<Value>(line["entry"].as_str().unwrap()).unwrap()
    });
    let stated: Vec<Value> = entries.filter(|entry| entry["event"] == "RETENTION").collect();
    assert!(!stated.is_empty());
    for entry in stated {
        assert_eq!((&entry["rule"], &entry["days"]), (&json!("FORMER_VERSION"), &Value::Null));
    }
}

/// Proves each chain by a file of it and the last checkpoint, without the store.
fn logs_are_proven(places: &Places, factory_id: &str, export: &str) {
    let recipient = |line: &str| -> String {
        let line: Value = serde_json::from_str(line).unwrap();
        let entry: Value = serde_json::from_str(line["entry"].as_str().unwrap()).unwrap();
        entry["recipient"].as_str().unwrap().to_owned()
    };
    let recipients: BTreeSet<String> = export.lines().map(recipient).collect();
    assert!(!recipients.is_empty());
    for recipient in recipients {
        let of = ["--recipient", &recipient];
        let command = |name, more: &[&str]| {
            connector_command(places, factory_id, &[&["ledger", name], &of[..], more].concat())
        };
        let file = |name: &str, content: &str| {
            let path = places.folder.join(name);
            std::fs::write(&path, content).unwrap();
            path
        };
        let audit = file("audit.jsonl", &command("audit", &[]));
        let checkpoint = file("checkpoint", &command("checkpoint", &[]));
        let key = command("checkpoint", &["--key"]);
        let output = Command::new(binary("asi").unwrap())
            .args(["ledger", "verify"])
            .arg(&audit)
            .arg("--checkpoint")
            .arg(&checkpoint)
            .args(["--key", key.trim()])
            .output()
            .unwrap();
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("foreign/ledger/verify.py");
        let foreign =
            Command::new("python3").arg(script).args([&audit, &checkpoint]).arg(&key).output();
        let foreign = foreign.expect("Python runs");
        assert!(foreign.status.success(), "{}", String::from_utf8_lossy(&foreign.stderr));
        let audit = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{factory_id} to {recipient}: {audit}");
        let audit: Value = serde_json::from_str(&audit).unwrap();
        assert!(audit["entriesProven"].as_u64() > Some(1), "{audit:#}");
    }
}

/// Returns the hashed texts of an export with their hashes. Beside them an export says what became
/// of each report, which goes on.
fn entries(export: &str) -> BTreeSet<String> {
    let entry = |line: &str| {
        let line: Value = serde_json::from_str(line).unwrap();
        format!("{} {}", line["hash"], line["entry"])
    };
    export.lines().map(entry).collect()
}

/// Appends what of `expected` is missing or different in `found`, by JSON pointer. Members that
/// `found` has besides are those of later versions.
fn differences(expected: &Value, found: &Value, pointer: &str, into: &mut Vec<String>) {
    match (expected, found) {
        (Value::Object(expected), Value::Object(found)) => {
            for (name, value) in expected {
                let pointer = format!("{pointer}/{name}");
                if is_withheld_since(&pointer) {
                    continue;
                }
                differences(value, found.get(name).unwrap_or(&Value::Null), &pointer, into);
            }
        }
        (Value::Array(expected), Value::Array(found))
            if expected.len() == found.len() || is_growing(pointer, expected, found) =>
        {
            let new = found.len() - expected.len();
            for (index, (expected, found)) in expected.iter().zip(&found[new..]).enumerate() {
                differences(expected, found, &format!("{pointer}/{index}"), into);
            }
        }
        _ if expected == found => {}
        _ => into.push(format!("{pointer}\n    was {expected}\n    is  {found}")),
    }
}

/// Returns true for the list of checkpoints, newest first: one of the day may come while it is read.
fn is_growing(pointer: &str, expected: &[Value], found: &[Value]) -> bool {
    pointer.ends_with("/ledger/checkpoints/items") && found.len() > expected.len()
}

/// Members that version 0.1 showed to all, and that are since for a factory's own organisation: times
/// of arrivals, by which others learned when a factory reported to others.
const WITHHELD_SINCE: [&str; 2] = ["lastSeenAt", "lastReportAt"];

fn is_withheld_since(pointer: &str) -> bool {
    let member = pointer.rsplit('/').next().unwrap_or_default();
    let is_of_factory = pointer.starts_with("/factories/") || pointer.contains("/parts/");
    // Numbers counted the comments of all members; what stands in their place is random.
    let is_renamed = member == "commentId" && pointer.starts_with("/operation-networks/");
    is_renamed || is_of_factory && WITHHELD_SINCE.contains(&member)
}

/// Compares the documents of an API with those of version 0.1.
async fn documents_are_as_written(program: &str, api: &Api, expected: &Value) {
    let mut different = Vec::new();
    for (path, document) in expected["documents"].as_object().unwrap() {
        let found: Value = api.get(&format!("/api/v1{path}")).await.unwrap();
        differences(document, &found, path, &mut different);
    }
    assert!(different.is_empty(), "{program} differs:\n{}", different.join("\n"));
}

/// Tells a connector the addresses of the machines, which listen elsewhere than in the former run.
async fn move_sources(world: &World, connector: &Api, factory_id: &str) {
    let ports = world.places.factory(factory_id).unwrap().machines;
    for (machine, port) in story::machines(factory_id).into_iter().zip(ports) {
        let source = json!({ "sourceId": machine, "name": machine, "security": { "choice": "none" },
                             "endpointUrl": format!("opc.tcp://127.0.0.1:{port}") });
        connector.put::<Value>(&format!("/api/v1/sources/{machine}"), &source).await.unwrap();
    }
}

/// Enrols a connector at the platform's new address; its store stays.
async fn move_platform(world: &mut World, platform: &Api, factory_id: &str) -> Api {
    let connector = world.factory(factory_id).unwrap().connector.as_mut().unwrap();
    connector.stop(Duration::from_secs(20)).unwrap();
    let path = format!("/api/v1/factories/{factory_id}/enrolment-tokens");
    let token: Value = platform.post(&path, &json!({})).await.unwrap();
    world.start_connector(factory_id, token["token"].as_str()).await.unwrap();
    let connector = world.connector_api(factory_id).await.unwrap();
    story::link_is_up(&connector).await.unwrap();
    connector
}

async fn spool_size(connector: &Api) -> anyhow::Result<u64> {
    let spool: Value = connector.get("/api/v1/spool").await?;
    let count = |member: &str| spool[member].as_u64().with_context(|| spool.to_string());
    Ok(count("waiting")? + count("sent")?)
}

/// Waits until the platform has every report of a factory exactly once.
async fn all_reports_arrived(platform: &Api, connector: &Api, factory_id: &str) {
    let path = format!("/api/v1/factories/{factory_id}/writers");
    eventually("every report is on the platform", PATIENCE, || async {
        let items = platform.list(&path).await.map_err(|e| format!("{e:#}"))?;
        let is_whole = |writer: &Value| {
            let through = writer["throughSequence"].as_u64();
            writer["missingCount"] == 0 && writer["received"].as_u64() == through.map(|s| s + 1)
        };
        match spool_size(connector).await {
            Ok(_) if items.is_empty() || !items.iter().all(is_whole) => {
                Err(Value::from(items).to_string())
            }
            Ok(size) if size >= 60 => Err(format!("{size} reports in the spool")),
            Ok(_) => Ok(()),
            Err(error) => Err(format!("{error:#}")),
        }
    })
    .await
    .unwrap();
}

/// Decides the pending field and waits until its value is on the platform.
async fn decide_pending(connector: &Api) {
    let field: Value = connector.get(&format!("/api/v1{PENDING}")).await.unwrap();
    assert_eq!(field["mappingState"], "PENDING");
    let decision = json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "disclosure": {},
        "mapping": { "inputs": [{ "name": "input", "sourceId": "MillingCell1", "valueType": "Double",
                                  "nodeId": story::node("MillingCell1", "Spindle.Power") }],
                     "steps": [{ "function": "scale", "factor": 1 }] } });
    let path = format!("/api/v1{PENDING}/decision");
    connector.put::<Value>(&path, &decision).await.unwrap();
}

async fn value_is_on_the_platform(platform: &Api, network: &str, field: &str) {
    eventually("the value is on the platform", PATIENCE, || async {
        let path = format!("/api/v1/operation-networks/{network}");
        let view: Value = platform.get(&path).await.map_err(|e| format!("{e:#}"))?;
        let fields = view["fields"].as_array().cloned().unwrap_or_default();
        let shown = fields.into_iter().find(|shown| shown["key"]["fieldName"] == field);
        match shown {
            Some(shown) if shown["status"] == "Good" => Ok(()),
            other => Err(format!("{other:?}")),
        }
    })
    .await
    .unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn stores_of_version_0_1_open_verify_and_go_on() {
    rustls::crypto::ring::default_provider().install_default().ok();
    let folder = tempfile::tempdir().unwrap();
    for archive in ["platform", "connector-FOR_MUC", "connector-INS_HAM"] {
        unpack(archive, folder.path());
    }
    let places = Places::anywhere(folder.path().to_owned()).unwrap();
    let expected = expected();
    let expected_of = |factory_id: &str| &expected[format!("connector-{factory_id}")];

    // The platform shows what it showed.
    let mut world = World::start(places.clone()).unwrap();
    let platform = world.platform_api().await.unwrap();
    documents_are_as_written("platform", &platform, &expected["platform"]).await;

    // The ledgers verify before anything else is written; Munich's store still has the write-ahead
    // log of a killed program.
    let mut ledgers = Vec::new();
    for factory_id in [MUNICH, HAMBURG] {
        close_to_others(&places, factory_id);
        let expected = &expected_of(factory_id)["ledger"];
        ledgers.push(ledger_is_as_written(&places, factory_id, expected));
    }
    empty_old_values(&places, MUNICH);
    assert_ne!(verify_ledger(&places, MUNICH)["valuesEmptied"], 0);

    for factory_id in [MUNICH, HAMBURG] {
        world.start_connector(factory_id, None).await.unwrap();
        let connector = world.connector_api(factory_id).await.unwrap();
        files_are_closed(&places, factory_id);
        documents_are_as_written(factory_id, &connector, expected_of(factory_id)).await;
        move_sources(&world, &connector, factory_id).await;
    }

    // It goes on: a decision, values from the machines, reports of then and of now.
    let munich = world.connector_api(MUNICH).await.unwrap();
    assert!(spool_size(&munich).await.unwrap() >= 79, "the spool of the former run");
    decide_pending(&munich).await;
    let munich = move_platform(&mut world, &platform, MUNICH).await;
    let hamburg = move_platform(&mut world, &platform, HAMBURG).await;
    value_is_on_the_platform(&platform, "weld-7", "pending1").await;
    value_is_on_the_platform(&platform, "frame-4711", "goodFrames").await;
    all_reports_arrived(&platform, &munich, MUNICH).await;
    all_reports_arrived(&platform, &hamburg, HAMBURG).await;

    world.stop().unwrap();
    for (factory_id, former) in [MUNICH, HAMBURG].into_iter().zip(ledgers) {
        let verified = verify_ledger(&places, factory_id);
        assert_eq!(verified["valuesEmptied"] != 0, factory_id == MUNICH, "{verified:#}");
        let export = connector_command(&places, factory_id, &["ledger", "export"]);
        let entries = entries(&export);
        let lost: Vec<&String> = former.difference(&entries).collect();
        assert!(lost.is_empty(), "{} former entries of {factory_id} are gone", lost.len());
        assert!(entries.len() > former.len(), "{factory_id} has recorded nothing since");
        former_retention_is_stated(&export);
        logs_are_proven(&places, factory_id, &export);
    }
}
