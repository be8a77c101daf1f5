//! Servers that are asked and tested before they are sources, and what the connector shows them.

use std::{
    fs,
    path::{Path, PathBuf},
};

use base64::{Engine as _, engine::general_purpose::STANDARD};
use reqwest::Method;
use serde_json::{Value, json};
use simulator::{MachineConfig, MachineKind, SecurityConfig, UserConfig};

use crate::plant::Plant;

/// Password of a test that stores nothing.
const TRIED: &str = "tried-and-not-kept";

/// A plant whose mill takes a user with a password, unprotected.
async fn plant() -> (Plant, String) {
    let mut mill = MachineConfig::new("Mill1", MachineKind::MillingCell);
    let user = UserConfig { name: "connector".into(), password: "s3cret-of-the-mill".into() };
    mill.security = SecurityConfig { users: vec![user], ..SecurityConfig::default() };
    let plant = Plant::start_with(json!([{ "name": "count", "type": 9 }]), mill).await;
    let address = plant.machines.machine("Mill1").expect("a machine").endpoint_url().to_owned();
    (plant, address)
}

/// The mill as a source with a user, whose password may be left out.
fn kept(address: &str, password: Option<&str>) -> Value {
    let mut identity = json!({ "kind": "userName", "userName": "connector" });
    if let Some(password) = password {
        identity["password"] = password.into();
    }
    json!({ "sourceId": "Kept", "endpointUrl": address, "security": { "choice": "none" },
        "identity": identity, "sendsPasswordUnprotected": true })
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_password_is_kept_for_its_user_at_its_address_alone() {
    let (plant, address) = plant().await;
    plant.post("/sources", kept(&address, Some("s3cret-of-the-mill"))).await;
    let is_connected = |sessions: u64| {
        move |page: &Value| {
            let sources = page["items"].as_array().expect("a page");
            let source = sources.iter().find(|source| source["sourceId"] == "Kept");
            source.is_some_and(|source| {
                source["state"] == "connected" && source["sessions"].as_u64() >= Some(sessions)
            })
        }
    };
    plant.until("the password is right", "/sources", is_connected(1)).await;

    let mut renamed = kept(&address, None);
    renamed["name"] = "The mill".into();
    plant.put("/sources/Kept", renamed).await;
    plant.until("the password is still known", "/sources", is_connected(2)).await;
    let tested = plant.post("/source-test", kept(&address, None)).await;
    assert_eq!(tested["problem"], Value::Null, "{tested:#}");

    // It was given for this machine, not for whatever an address names next.
    let elsewhere = kept("opc.tcp://127.0.0.1:1", None);
    for (method, path) in [(Method::PUT, "/sources/Kept"), (Method::POST, "/source-test")] {
        let (status, problem) = plant.status(method, path, Some(elsewhere.to_string())).await;
        let code = &problem["code"];
        assert_eq!((status.as_u16(), code), (422, &json!("PASSWORD_NEEDED")), "{path}");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_server_is_asked_and_tested_without_becoming_a_source() {
    let (plant, address) = plant().await;
    let offer = plant.post("/source-discovery", json!({ "endpointUrl": address })).await;
    let endpoint = &offer["offer"]["endpoints"][0];
    assert_eq!(endpoint["choice"], json!({ "choice": "none" }), "{offer:#}");
    assert_eq!(endpoint["allowsUserName"], true, "{offer:#}");
    assert_eq!(offer["offer"]["findings"][0]["code"], "nothingEncrypted", "{offer:#}");

    let mut wrong = kept(&address, Some(TRIED));
    wrong["sourceId"] = "New".into();
    let tested = plant.post("/source-test", wrong).await;
    assert_eq!(tested["problem"]["kind"], "credentialsRejected", "{tested:#}");
    let unprotected =
        json!({ "sourceId": "New", "endpointUrl": address, "security": { "choice": "none" } });
    let tested = plant.post("/source-test", unprotected).await;
    assert_eq!(tested["server"]["endpoint"]["serverName"], "Mill1 (simulated)", "{tested:#}");
    assert!(tested["server"]["clockAheadMs"].as_i64().is_some(), "{tested:#}");

    let nowhere = json!({ "endpointUrl": "opc.tcp://127.0.0.1:1" });
    let refused = plant.post("/source-discovery", nowhere).await;
    assert_eq!(refused["problem"]["kind"], "nothingListens", "{refused:#}");
    let web = json!({ "endpointUrl": "http://127.0.0.1" }).to_string();
    let (status, _) = plant.status(Method::POST, "/source-discovery", Some(web)).await;
    assert_eq!(status.as_u16(), 422, "OPC UA alone");
    let sources = plant.get("/sources").await;
    assert_eq!(sources["items"].as_array().map(Vec::len), Some(2), "none is stored: {sources:#}");
    for file in files_below(&plant.data_directory()) {
        let content = fs::read(&file).unwrap_or_default();
        let is_there = content.windows(TRIED.len()).any(|bytes| bytes == TRIED.as_bytes());
        assert!(!is_there, "{} keeps the password of a test", file.display());
    }
}

/// Returns all files in a folder and the folders in it.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() { found.extend(files_below(&path)) } else { found.push(path) }
    }
    found
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_next_client_certificate_is_handed_out_before_it_is_used() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    let own = "/source-client-certificate";
    let first = plant.get(own).await;
    assert_eq!(first["next"], Value::Null, "{first:#}");
    let content = first["current"]["content"].as_str().expect("PEM");
    let lines: Vec<&str> = content.lines().collect();
    assert_eq!(lines.first(), Some(&"-----BEGIN CERTIFICATE-----"));
    assert_eq!(lines.last(), Some(&"-----END CERTIFICATE-----"));
    let body = &lines[1..lines.len() - 1];
    assert!(body.iter().all(|line| line.len() <= 64), "{content}");
    assert!(STANDARD.decode(body.concat()).is_ok_and(|der| der.starts_with(&[0x30])), "{content}");

    let next = format!("{own}/next");
    let prepared = plant.post(&next, json!({})).await;
    assert_eq!(prepared["current"], first["current"]);
    let used = plant.post(&format!("{next}/use"), json!({})).await;
    assert_eq!((&used["current"], &used["next"]), (&prepared["next"], &Value::Null));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_node_id_is_found_as_other_clients_show_it() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    let node = plant.node("Mill1", "Identification.Model");
    let (uri, identifier) = node.split_once(';').expect("a namespace");
    assert!(uri.starts_with("nsu="), "{node}");
    let mut found = Vec::new();
    for namespace in [uri, "ns=1", "ns=2", "ns=3"] {
        let text = [("text", format!(" {namespace};{identifier}"))];
        let url = reqwest::Url::parse_with_params("http://connector", text).expect("an address");
        let query = url.query().expect("a query");
        let page = plant.get(&format!("/sources/Mill1/search?{query}")).await;
        assert_eq!(page["isComplete"], true, "{page:#}");
        found.extend(page["items"].as_array().expect("a page").iter().cloned());
    }
    // Under its URI and under the one index that the server has for it, whose URI is said.
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(found.iter().all(|item| item["nodeId"] == node.as_str()), "{found:#?}");
}
