//! The twin along OPC 10000-3, -4 and -5: the cases of `tests/foreign/opcua/conformance`, and a crawl of every node, by three
//! foreign clients.

use std::{path::PathBuf, process::Output, time::Duration};

use serde_json::{Value, json};
use tokio::{process::Command, time::timeout};

use crate::{
    foreign::{installed, repository},
    harness::{TestTwin, document, external, field, good, message},
};

/// Interfaces of the twin that is crawled.
const NETWORKS: usize = 100;
/// Least number of nodes that each of them has.
const NODES_PER_NETWORK_MIN: usize = 40;
/// Time limit of all cases, and of a crawl, on a busy machine.
const PLAY_TIMEOUT: Duration = Duration::from_secs(900);
/// Time limit to build open62541, which happens once.
const BUILD_TIMEOUT: Duration = Duration::from_secs(1800);

fn folder() -> PathBuf {
    repository().join("tests/foreign/opcua/conformance")
}

fn python() -> PathBuf {
    repository().join("target/foreign/python/bin/python")
}

async fn twin() -> TestTwin {
    let twin = TestTwin::start().await;
    for number in 0..NETWORKS {
        twin.handle.apply(document(message(&format!("net{number}"), 1)));
    }
    let written = field("net0", "progressStatus");
    twin.handle.publish_decision(&written, external());
    assert_eq!(twin.handle.publish_values(vec![(written, good(1))]), 1);
    twin
}

/// Runs a script of the folder with a player. Returns the last line of its output, which is its summary.
async fn run(script: &str, twin: &TestTwin, more: &[String], player: &[PathBuf]) -> Value {
    let mut command = Command::new(python());
    command
        .arg(folder().join(script))
        .args(["--url", &*twin.url, "--user", "anna", "--password", "anna-secret", "--pki"])
        .arg(twin.folder.path().join("player"))
        .args(more)
        .args(player)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .kill_on_drop(true);
    let Output { status, stdout, stderr } =
        timeout(PLAY_TIMEOUT, command.output()).await.expect("a client goes on").unwrap();
    let (said, complaints) = (String::from_utf8(stdout).unwrap(), String::from_utf8_lossy(&stderr));
    assert!(status.success(), "{script} with {player:?} found:\n{said}{complaints}");
    serde_json::from_str(said.lines().next_back().unwrap()).unwrap()
}

/// Plays all cases but those that the client does not send, and crawls everything.
async fn conforms(player: &[PathBuf], unsendable: &[&str]) {
    installed().await;
    let twin = twin().await;
    let request = "ns=3;s=net0/op/MakeFrame1/req/ReqResponse1";
    let nodes = json!({
        "applicationUri": "urn:verbund:twin:FOR_MUC",
        "field": format!("{request}/progressStatus"),
        "text": format!("{request}/state"),
        "property": "ns=3;s=net0#Revision",
        "object": request,
        "parentName": "3:MakeFrame1",
        "method": format!("{request}#Decide"),
        "unknown": "ns=3;s=unknown",
    });
    let played = run("play.py", &twin, &["--nodes".to_owned(), nodes.to_string()], player).await;
    let mut skipped: Vec<&str> =
        played["skipped"].as_object().unwrap().keys().map(String::as_str).collect();
    skipped.sort_unstable();
    assert_eq!(skipped, unsendable, "{played}");
    let crawled = run("crawl.py", &twin, &[], player).await;
    let count = |name: &str| usize::try_from(crawled[name].as_u64().unwrap()).unwrap();
    assert!(count("nodes") > NETWORKS * NODES_PER_NETWORK_MIN, "{crawled}");
    assert!(count("calls") > 2 * NETWORKS, "{crawled}");
    twin.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn asyncua_plays_all_cases_and_crawls_a_hundred_interfaces() {
    conforms(&[python(), folder().join("asyncua_player.py")], &[]).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn node_opcua_plays_all_cases_and_crawls_a_hundred_interfaces() {
    conforms(&["node".into(), folder().join("node_player.js")], &[]).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn open62541_plays_all_cases_and_crawls_a_hundred_interfaces() {
    let building = Command::new("bash").arg(folder().join("open62541.sh")).output();
    let Output { status, stdout, stderr } =
        timeout(BUILD_TIMEOUT, building).await.expect("building ends").unwrap();
    assert!(status.success(), "{}", String::from_utf8_lossy(&stderr));
    let player = PathBuf::from(String::from_utf8(stdout).unwrap().trim());
    // The library knows one authentication token, that of the session.
    let unsendable = [
        "ActivateSession of an unknown session",
        "CloseSession of an unknown session",
        "a request of a session that is not activated",
        "a request of an unknown session",
        "a request without a session",
    ];
    conforms(&[player], &unsendable).await;
}

#[test]
fn the_table_of_clauses_is_that_of_the_cases() {
    let page = std::fs::read_to_string(repository().join("docs/conformance.md")).unwrap();
    let listed: Vec<&str> = page
        .lines()
        .filter(|line| ["| 5.", "| 7.", "| OPC"].iter().any(|start| line.starts_with(start)))
        .collect();
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder().join("cases"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    let mut expected = Vec::new();
    for file in files {
        let cases: Vec<Value> =
            serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        expected.extend(cases.iter().map(|case| {
            let text = |name: &str| case[name].as_str().unwrap().to_owned();
            format!("| {} | {} | {} |", text("clause"), text("name"), text("says"))
        }));
    }
    assert_eq!(listed, expected, "`play.py --table` prints the table");
}
