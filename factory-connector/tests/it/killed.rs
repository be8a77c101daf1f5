//! A connector that is killed without warning, started again, and compared with itself: what each reading operation of
//! its API answered before, it answers again.

use std::{
    collections::BTreeMap,
    os::unix::fs::PermissionsExt as _,
    path::Path,
    process::{Child, Command, Stdio},
    time::Duration,
};

use reqwest::{Method, StatusCode};
use serde_json::{Value, json};
use simulator::{MachineConfig, MachineKind, Simulator, SimulatorHandle};
use tempfile::TempDir;
use tokio_util::sync::{CancellationToken, DropGuard};

use crate::plant::{PASSWORD, SignedIn, enrol, field};

/// Time for a start, with all that it reads.
const START: Duration = Duration::from_secs(60);

/// Operations that read no state of the connector: streams, and what a machine answers at the moment.
const OF_THE_MOMENT: [&str; 4] = [
    "/events",
    "/sources/{sourceId}/nodes",
    "/sources/{sourceId}/search",
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/suggestions",
];

/// Members that belong to a run of the program: its times, its connections and sessions, and what it counted. No
/// other one may differ.
const OF_A_RUN: [&str; 26] = [
    // Of the program and of its clock.
    "now",
    "startedAt",
    // Of a person's session, and of what it was shown.
    "csrfToken",
    "sessionId",
    "lastUsedAt",
    "shownTag",
    // Of the link, which finds nobody here; keep-alives join what waits for it.
    "link",
    "bytes",
    "waiting",
    // Of the connections to machines.
    "since",
    "changes",
    "clockAheadMs",
    "lastChangeAt",
    "lastSignOfLifeAt",
    "serverTimestamp",
    // Of the mappings at work.
    "received",
    "receivedAt",
    "repeated",
    "superseded",
    "yielded",
    "lastYieldedAt",
    "spentUs",
    // Of the scripts' workers.
    "scriptWorkers",
    // Measured over the hours that the program has run.
    "everyChangeAddsPerHour",
    "measured",
    "valuesPerHourMeasured",
];

/// A connector in a process of its own, over a machine that goes on.
struct Killable {
    directory: TempDir,
    port: u16,
    child: Child,
    machines: SimulatorHandle,
    _machines_stop: DropGuard,
}

impl Drop for Killable {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn spawn(config: &Path) -> Child {
    Command::new(env!("CARGO_BIN_EXE_factory-connector"))
        .arg("run")
        .arg("--config")
        .arg(config)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the connector starts")
}

impl Killable {
    async fn start(fields: Value) -> Self {
        rustls::crypto::ring::default_provider().install_default().ok();
        let directory = tempfile::tempdir().expect("a folder");
        enrol(&directory, fields).await;
        let mut config =
            simulator::Config::of(vec![MachineConfig::new("Mill1", MachineKind::MillingCell)]);
        config.pki_directory = directory.path().join("machines");
        let (simulator, machines) = Simulator::new(config).await.expect("the machine starts");
        let machines_stop = CancellationToken::new();
        tokio::spawn(simulator.run(machines_stop.clone()));

        let (web, twin) = (free_port(), free_port());
        let text = format!(
            "data_directory = {:?}\n[web]\nlisten = \"127.0.0.1:{web}\"\n\
             [twin]\nlisten = \"127.0.0.1:{twin}\"\n[admin]\npassword = {PASSWORD:?}\n",
            directory.path().join("data"),
        );
        let path = directory.path().join("connector.toml");
        std::fs::write(&path, text).expect("written");
        // It has a password.
        let ours = std::fs::Permissions::from_mode(0o600);
        std::fs::set_permissions(&path, ours).expect("its mode is set");
        let child = spawn(&path);
        let machines_stop = machines_stop.drop_guard();
        Self { directory, port: web, child, machines, _machines_stop: machines_stop }
    }

    /// Ends it as a power cut does, and starts it again.
    fn kill_and_restart(&mut self) {
        self.child.kill().expect("it runs");
        self.child.wait().expect("reaped");
        self.child = spawn(&self.directory.path().join("connector.toml"));
    }

    /// Signs in, as soon as it listens.
    async fn engineer(&self) -> SignedIn {
        let origin = format!("http://127.0.0.1:{}", self.port);
        let listens = || async {
            let address = ("127.0.0.1", self.port);
            tokio::net::TcpStream::connect(address).await.map(drop).map_err(|e| e.to_string())
        };
        if let Err(missed) = testkit::wait::eventually("it listens", START, listens).await {
            panic!("{missed}");
        }
        SignedIn::new(origin, "engineer", PASSWORD).await.expect("the engineer comes in")
    }

    fn model(&self) -> String {
        let machine = self.machines.machine("Mill1").expect("a machine");
        machine.node_id("Identification.Model").expect("a variable").to_string()
    }
}

fn free_port() -> u16 {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.local_addr().expect("bound").port()
}

/// Decides, enters, writes and configures something of each kind. What comes from the machine never changes.
async fn fill(connector: &Killable, engineer: &SignedIn) -> String {
    let endpoint =
        connector.machines.machine("Mill1").expect("a machine").endpoint_url().to_owned();
    let source =
        json!({ "sourceId": "Mill1", "endpointUrl": endpoint, "security": { "choice": "none" } });
    engineer.post("/sources", source).await;
    connected(engineer).await;
    let put = async |path: &str, body: Value| engineer.put(path, body).await;
    put("/policies/coarse", json!({ "name": "Coarse", "disclosure": { "roundingStep": 10.0 } }))
        .await;
    put("/recipients/acme/policy", json!({ "policyId": "coarse" })).await;
    put("/alliances/yard", json!({ "name": "The yard", "memberList": ["acme", "hull"] })).await;
    put(
        "/caps/yard",
        json!({ "name": "The yard", "subject": { "allianceId": "yard" },
            "variable": { "sourceId": "none", "nodeId": "nsu=urn:x;i=1" }, "bitsPerHourMax": 0.5 }),
    )
    .await;
    put(
        "/rules/power",
        json!({ "name": "Power of acme", "isEnabled": true, "action": "ACCEPT",
            "valueSource": "EXTERNAL", "when": { "partners": ["acme"], "units": ["WTT"] },
            "policyId": "coarse" }),
    )
    .await;
    put("/users/otto", json!({ "role": "OPERATOR", "password": "another long password" })).await;
    let manual = json!({ "mappingState": "MAPPED", "valueSource": "MANUAL",
        "disclosure": { "roundingStep": 5.0 }, "reason": "Agreed on Monday." });
    put(&format!("{}/decision", field("count")), manual.clone()).await;
    put(&format!("{}/value", field("count")), json!({ "value": 17 })).await;
    let mapping = |name: &str| {
        json!({ "inputs": [{ "name": "a", "sourceId": "Mill1", "nodeId": connector.model() }],
            "steps": [{ "function": "lookup", "entries": [{ "from": "FW-500 5X", "to": name }] }] })
    };
    engineer.map("model", mapping("Mill")).await;
    engineer.map("model", mapping("Milling cell")).await;
    put(&format!("{}/shadow", field("model")), mapping("Machine")).await;
    let refused = json!({ "mappingState": "REFUSED", "reason": "That is our secret." });
    put(&format!("{}/decision", field("recipe")), refused).await;
    let draft =
        json!({ "templateId": "model", "name": "Model", "parameters": { "field": "model" } });
    let template = engineer.post(&format!("{}/template", field("model")), draft).await;
    put("/mapping-templates/model", template).await;
    let comment =
        json!({ "dynamicDataRequestId": "Req", "fieldName": "count", "text": "Per shift?" });
    engineer.post("/operation-networks/frame/comments", comment).await;
    let entry = json!({ "entryId": "e1", "operationNetworkId": "frame", "operationId": "MakeFrame",
        "madeAt": "2026-01-05T06:00:00Z", "action": "ADD", "quantity": 3 });
    engineer.post("/operator/entries", json!({ "entries": [entry] })).await;
    let external = json!({ "mappingState": "MAPPED", "valueSource": "EXTERNAL", "disclosure": {} });
    put(&format!("{}/decision", field("power")), external).await;
    let power = json!({ "operationNetworkId": "frame", "operationId": "MakeFrame",
        "dynamicDataRequestId": "Req", "fieldName": "power" });
    let body = json!({ "fields": [power], "reason": "No longer needed." });
    let receipt = engineer.post("/revocations", body).await;
    receipt["revocationId"].as_str().expect("an id").to_owned()
}

async fn connected(engineer: &SignedIn) {
    engineer
        .until("the machine is connected", "/sources", |sources| {
            sources["items"][0]["state"] == "connected"
        })
        .await;
}

/// Waits until the machine is connected and the mapping has its value.
async fn at_work(engineer: &SignedIn) {
    connected(engineer).await;
    let status = format!("{}/mapping-status", field("model"));
    engineer.until("the mapping runs", &status, |status| !status["lastCandidate"].is_null()).await;
    let shown = |view: &Value| !view["value"].is_null();
    engineer.until("its value is shown", &field("model"), shown).await;
}

/// Answers of all operations that read, by their paths.
async fn read_all(engineer: &SignedIn, revocation: &str) -> BTreeMap<String, Value> {
    let description = serde_json::to_value(factory_connector::api::openapi()).expect("serialises");
    let paths = description["paths"].as_object().expect("paths");
    let mut answers = BTreeMap::new();
    for (path, operations) in paths {
        let path = path.trim_start_matches("/api/v1");
        if operations.get("get").is_none() || OF_THE_MOMENT.contains(&path) {
            continue;
        }
        let mut asked = path.to_owned();
        for (parameter, value) in [
            ("operationNetworkId", "frame"),
            ("operationId", "MakeFrame"),
            ("dynamicDataRequestId", "Req"),
            ("fieldName", "model"),
            ("allianceId", "yard"),
            ("capId", "yard"),
            ("policyId", "coarse"),
            ("ruleId", "power"),
            ("sourceId", "Mill1"),
            ("userName", "otto"),
            ("revocationId", revocation),
        ] {
            asked = asked.replace(&format!("{{{parameter}}}"), value);
        }
        assert!(!asked.contains('{'), "give {asked} its parameters");
        asked.push_str(match path {
            "/operator/entries" => "?operationNetworkId=frame&operationId=MakeFrame",
            "/ledger/export" => "?format=jsonl",
            "/mappings/export" => "?form=file",
            _ if path.ends_with("/version-difference") => "?from=1&to=2",
            _ if path.ends_with("/print") => "?language=en",
            _ => "",
        });
        let (status, text) = engineer.call(Method::GET, &asked, None).await;
        assert_eq!(status, StatusCode::OK, "{asked}: {text}");
        answers.insert(asked, serde_json::from_str(&text).unwrap_or(Value::String(text)));
    }
    answers
}

/// Answers once nothing is on its way any more, as a checkpoint that is made a second after the first entry.
async fn settled(engineer: &SignedIn, revocation: &str) -> BTreeMap<String, Value> {
    let mut answers = read_all(engineer, revocation).await;
    for _ in 0..10 {
        tokio::time::sleep(Duration::from_millis(1500)).await;
        let later = read_all(engineer, revocation).await;
        let is_settled = differences(&answers, &later).is_empty();
        answers = later;
        if is_settled {
            break;
        }
    }
    answers
}

fn differences(before: &BTreeMap<String, Value>, after: &BTreeMap<String, Value>) -> Vec<String> {
    let mut differences = Vec::new();
    for (path, answer) in before {
        compare(path, answer, &after[path], &mut differences);
    }
    differences
}

/// Adds a line for each place where two answers differ.
fn compare(place: &str, before: &Value, after: &Value, differences: &mut Vec<String>) {
    match (before, after) {
        // The machine is found again, which its partner reads: the ledger goes on, and has what it had.
        (Value::Array(old), Value::Array(new)) if place == "/ledger/items" => {
            let older = new.len().saturating_sub(old.len());
            let kept = Value::Array(new[older..].to_vec());
            compare("/ledger/items of before", before, &kept, differences);
        }
        (Value::String(old), Value::String(new)) if place.starts_with("/ledger/export") => {
            let entries = |text: &str| {
                let lines = text.lines().filter(|line| line.starts_with("{\"entry\""));
                lines.map(str::to_owned).collect::<Vec<_>>()
            };
            let is_kept = !entries(old).is_empty() && entries(new).starts_with(&entries(old));
            if !is_kept {
                differences.push(format!("{place}: {old} became {new}"));
            }
        }
        (Value::Number(old), Value::Number(new))
            if place.starts_with("/ledger/logs/items/") && place.ends_with("/size") =>
        {
            if new.as_u64() < old.as_u64() {
                differences.push(format!("{place}: {old} became {new}"));
            }
        }
        (Value::Object(old), Value::Object(new)) => {
            for name in old.keys().chain(new.keys().filter(|name| !old.contains_key(*name))) {
                if OF_A_RUN.contains(&name.as_str()) {
                    continue;
                }
                let of = |members: &serde_json::Map<String, Value>| {
                    members.get(name).cloned().unwrap_or_default()
                };
                compare(&format!("{place}/{name}"), &of(old), &of(new), differences);
            }
        }
        (Value::Array(old), Value::Array(new)) if old.len() == new.len() => {
            for (index, (old, new)) in old.iter().zip(new).enumerate() {
                compare(&format!("{place}/{index}"), old, new, differences);
            }
        }
        _ if before == after => {}
        _ => differences.push(format!("{place}: {before} became {after}")),
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_killed_connector_answers_everything_as_before() {
    let fields = json!([
        { "name": "count", "type": 9, "unit": "PIECE", "semantic": "PRODUCED_QUANTITY" },
        { "name": "model", "type": 12, "description": "Model of the machine" },
        { "name": "power", "type": 11, "unit": "WTT" },
        { "name": "recipe", "type": 12 },
    ]);
    let mut connector = Killable::start(fields).await;
    let engineer = connector.engineer().await;
    let revocation = fill(&connector, &engineer).await;
    at_work(&engineer).await;
    let before = settled(&engineer, &revocation).await;
    assert!(before.len() > 40, "{:?}", before.keys());

    connector.kill_and_restart();
    let engineer = connector.engineer().await;
    at_work(&engineer).await;
    let after = settled(&engineer, &revocation).await;
    let differences = differences(&before, &after);
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}
