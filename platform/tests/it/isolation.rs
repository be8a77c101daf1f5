//! Access to *every* operation of the description: each demands a session, and shows a stranger
//! nothing of a collaboration of others. A new operation that no case covers fails the test.

use std::collections::BTreeSet;

use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use serde_json::{Value, json};

use crate::{
    harness::{Api, World, event_form},
    story::{self, NETWORK},
};

/// Operations without a session, reviewed.
pub const OPEN: [&str; 2] = ["POST /session", "POST /enrolments"];

/// Texts that must not appear in any answer to a stranger.
const SECRETS: [&str; 8] = [
    "frame-4711",
    "MakeFrame1",
    "ReqResponse1",
    "FOR_MUC",
    "INS_HAM",
    "acme-aero",
    "Frame order",
    "progressStatus",
];

/// Method and path of every operation of the description.
pub fn operations() -> Vec<(String, String)> {
    let description: Value = serde_json::to_value(platform::api::openapi()).expect("it serialises");
    let paths = description["paths"].as_object().expect("paths");
    let mut operations = Vec::new();
    for (path, methods) in paths {
        for method in ["get", "put", "post", "delete", "patch"] {
            if methods.get(method).is_some() {
                let path = path.strip_prefix("/api/v1").expect("all are under /api/v1");
                operations.push((method.to_uppercase(), path.to_owned()));
            }
        }
    }
    assert!(operations.len() > 25, "{operations:?}");
    operations
}

/// Returns true for a path below which are the caller's own session, password, second factor and passkeys.
pub fn is_own(path: &str) -> bool {
    path == "/session" || path.starts_with("/session/")
}

/// The path with the identifiers of the story, and the body that the operation would take.
fn filled(method: &str, path: &str) -> (String, Option<Value>) {
    let filled = path
        .replace("{operationNetworkId}", NETWORK)
        .replace("{operationId}", "MakeFrame1")
        .replace("{dynamicDataRequestId}", "ReqResponse1")
        .replace("{factoryId}", "FOR_MUC")
        .replace("{toolId}", "Monitoring")
        .replace("{collaborationId}", "order")
        .replace("{organisationId}", "stranger")
        .replace("{deadLetterId}", "ingest-1")
        .replace("{passkeyId}", "0123456789abcdef")
        .replace("{userName}", "stranger-viewer")
        .replace("{sessionId}", "0123456789abcdef");
    assert!(!filled.contains('{'), "a case for the parameters of {path} is missing");
    let body = match (method, path) {
        ("GET" | "DELETE", _) => None,
        ("PUT", "/operation-networks/{operationNetworkId}") => {
            Some(json!({ "collaborationId": "order", "operationNetwork": story::network() }))
        }
        ("POST", "/operation-networks/{operationNetworkId}/operations/{operationId}/requests") => {
            Some(story::request("Sneaky", "stranger"))
        }
        ("POST", "/operation-networks/{operationNetworkId}/comments") => {
            Some(json!({ "factoryId": "FOR_MUC", "text": "Hello" }))
        }
        ("POST", "/organisations") => Some(json!({ "organisationId": "new", "name": "new" })),
        ("POST", "/factories") => {
            Some(json!({ "factoryId": "NEW", "organisationId": "stranger", "name": "new" }))
        }
        ("POST", "/factories/{factoryId}/lease/handovers") => Some(json!({ "instanceId": "b" })),
        ("POST", "/tools") => {
            Some(json!({ "toolId": "NEW", "organisationId": "stranger", "name": "new" }))
        }
        ("POST", "/collaborations") => Some(json!({ "collaborationId": "new", "name": "new" })),
        ("PUT", "/users/{userName}") => Some(
            json!({ "password": "correct horse battery", "role": "ADMINISTRATOR", "organisationId": "stranger" }),
        ),
        _ => Some(json!({})),
    };
    (filled, body)
}

async fn call(api: &Api, method: &str, path: &str) -> (u16, String) {
    let (path, body) = filled(method, path);
    let answer = api.call(method.parse().expect("a method"), &path, body).await;
    (answer.status, answer.body.to_string())
}

async fn world() -> World {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("ua-data", &story::report("m1", 0, 3));
    munich.send("decision", &story::decision("REFUSED", Some("secret reason")));
    story::state_is(&buyer, "REFUSED").await;
    crate::harness::eventually("a report", || async {
        let reports = buyer.get("/reports").await.expect_ok();
        if reports["items"][0].is_object() { Ok(()) } else { Err(reports.to_string()) }
    })
    .await;
    world
}

#[tokio::test(flavor = "multi_thread")]
async fn every_operation_demands_a_session() {
    let world = World::start().await;
    let anonymous = world.anonymous();
    for (method, path) in operations() {
        if !OPEN.contains(&format!("{method} {path}").as_str()) {
            let (status, body) = call(&anonymous, &method, &path).await;
            assert_eq!(status, 401, "{method} {path}: {body}");
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stranger_learns_nothing_and_changes_nothing() {
    let world = world().await;
    let stranger = story::planner(&world, "stranger").await;
    for (method, path) in operations() {
        let key = format!("{method} {path}");
        if OPEN.contains(&key.as_str()) || is_own(&path) || path == "/live" {
            continue;
        }
        let (status, body) = call(&stranger, &method, &path).await;
        if method == "GET" {
            assert!([200, 403, 404].contains(&status), "{key}: {status} {body}");
        } else {
            assert!([403, 404].contains(&status), "{key}: {status} {body}");
        }
        // A problem may repeat the id that was asked for; a success must not name anything.
        if status == 200 {
            for secret in SECRETS {
                assert!(!body.contains(secret), "{key} tells {secret}: {body}");
            }
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stranger_receives_no_live_events() {
    let world = world().await;
    let buyer = story::planner(&world, "acme-aero").await;
    let stranger = story::planner(&world, "stranger").await;
    let start = buyer.get(&story::network_path()).await.expect_ok();
    let mut live = stranger.live(start["lastEventId"].as_str()).await;
    story::put_network(&buyer, {
        let mut network = story::network();
        network["name"] = json!("Another name");
        network
    })
    .await;
    // The buyer hears of it; whatever the stranger hears first after that is a network of its own.
    buyer.live(start["lastEventId"].as_str()).await.next("network").await;
    let admin = world.admin().await;
    let own = json!({ "collaborationId": "own", "name": "own", "members": ["stranger"], "factories": ["INS_HAM"] });
    admin.post("/collaborations", own).await.expect_ok();
    let network = json!({ "operationNetworkId": "own", "operationList": [
        { "operationId": "x", "operationType": "PRODUCTION", "owningFactoryId": "INS_HAM" } ] });
    let body = json!({ "collaborationId": "own", "operationNetwork": network });
    stranger.put("/operation-networks/own", body).await.expect_ok();
    let (_, name, event) = live.any().await;
    assert_eq!((name.as_str(), &event["operationNetworkId"]), ("network", &json!("own")));
}

#[tokio::test(flavor = "multi_thread")]
async fn members_see_the_network_but_only_recipients_the_values() {
    let world = world().await;
    let field_of = async |organisation: &str| {
        let api = story::planner(&world, organisation).await;
        let view = api.get(&story::network_path()).await.expect_ok();
        let reports = api.get("/reports").await.expect_ok()["items"].as_array().map_or(0, Vec::len);
        (view["fields"].clone(), reports, view["operations"][0]["lastReportAt"].clone())
    };
    let (fields, reports, last) = field_of("acme-aero").await;
    assert_eq!((&fields[0]["mappingState"], reports), (&json!("REFUSED"), 1));
    assert_eq!(fields[0]["value"], json!(null), "a refused field shows no value");
    assert!(
        !last.is_string() && fields.as_array().is_some_and(|fields| fields.len() == 2),
        "{fields}"
    );
    // The maker decided itself, but the values belong to the recipients.
    let (fields, reports, last) = field_of("frames-munich").await;
    assert_eq!(fields[0]["reason"], json!("secret reason"));
    assert_eq!(fields[0]["value"], json!(null));
    assert_eq!(reports, 0);
    assert_eq!(last, json!(null));
    let (fields, reports, last) = field_of("inspect-hamburg").await;
    assert_eq!(fields, json!([]));
    assert_eq!(reports, 0);
    assert_eq!(last, json!(null));
    // Who runs the platform sees that it runs, not what it carries.
    let admin = world.admin().await;
    let view = admin.get(&story::network_path()).await.expect_ok();
    assert_eq!((&view["fields"], view["parts"].as_array().map(Vec::len)), (&json!([]), Some(2)));
    assert_eq!(admin.get("/reports").await.expect_ok()["items"], json!([]));
}

/// Values that a factory sends to others, with an id asked for after each. By chance, the ids of this
/// many would have an order once in half a billion runs.
const POLLS: u32 = 12;

/// Asserts that these ids of live events of one platform differ in random bytes only, so that neither
/// their text nor a part of it counts what happened between them.
fn assert_no_number(ids: &[String]) {
    assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len(), "{ids:?}");
    let forms: BTreeSet<String> = ids.iter().map(|id| event_form(&json!(id))).collect();
    assert_eq!(forms.len(), 1, "{forms:?}");
    let is_order = |ids: &[Vec<u8>]| ids.is_sorted() || ids.iter().rev().is_sorted();
    let texts: Vec<Vec<u8>> = ids.iter().map(|id| id.as_bytes().to_vec()).collect();
    assert!(!is_order(&texts), "{ids:?}");
    let sealed: Vec<Vec<u8>> = ids
        .iter()
        .map(|id| {
            let (_, sealed) = id.split_once('-').expect("a mark");
            assert!(sealed.parse::<u64>().is_err() && u64::from_str_radix(sealed, 16).is_err());
            URL_SAFE_NO_PAD.decode(sealed).expect("base64")
        })
        .collect();
    for width in [1, 2, 4, 8] {
        for begin in 0..=sealed[0].len() - width {
            let part = |id: &Vec<u8>| id[begin..begin + width].to_vec();
            let big_endian: Vec<Vec<u8>> = sealed.iter().map(part).collect();
            let reversed = |part: &Vec<u8>| part.iter().rev().copied().collect::<Vec<u8>>();
            let little_endian: Vec<Vec<u8>> = big_endian.iter().map(reversed).collect();
            assert!(!is_order(&big_endian) && !is_order(&little_endian), "bytes from {begin}");
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn ids_of_live_events_count_nothing_for_a_member() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("decision", &story::decision("MAPPED", None));
    let inspector = story::planner(&world, "inspect-hamburg").await;
    let (mut live, mut of_buyer) = (inspector.live(None).await, buyer.live(None).await);
    let mut ids = Vec::new();
    for sequence in 0..POLLS {
        let id = format!("m{sequence}");
        munich.send("ua-data", &story::report(&id, sequence, sequence.into()));
        of_buyer.next("value").await;
        let view = inspector.get(&story::network_path()).await.expect_ok();
        ids.push(view["lastEventId"].as_str().expect("an id").to_owned());
    }

    // From any of them on, and from the open stream, the member hears what concerns it next.
    let mut network = story::network();
    network["name"] = json!("Another name");
    story::put_network(&buyer, network).await;
    let (heard, event) = live.next("network").await;
    for position in [0, ids.len() - 1] {
        let (id, again) = inspector.live(Some(&ids[position])).await.next("network").await;
        assert_eq!(again, event);
        ids.push(id);
    }
    ids.push(heard);
    assert_no_number(&ids);
}
