//! Role matrix: each operation of the API's description against each role.
//!
//! [`ROLES`] is the reviewed table. An operation that is missing in it, a description that names
//! another role, and an answer that does not follow from the role fail the test.

use std::{collections::BTreeMap, time::Duration};

use reqwest::Method;
use serde_json::{Value, json};
use testkit::Event;
use tokio::sync::mpsc;

use crate::plant::{Plant, SignedIn, field};

/// Least role of an operation, weakest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Least {
    Anonymous,
    Viewer,
    Operator,
    Engineer,
}

use Least::{Anonymous, Engineer, Operator, Viewer};

/// The least role of each operation, by operation id.
const ROLES: &[(&str, Least)] = &[
    // The session.
    ("signIn", Anonymous),
    ("showSession", Viewer),
    ("signOut", Viewer),
    ("changePassword", Viewer),
    ("listSessions", Viewer),
    ("endSession", Viewer),
    ("showSecondFactor", Viewer),
    ("beginSecondFactor", Viewer),
    ("confirmSecondFactor", Viewer),
    ("removeSecondFactor", Viewer),
    ("listPasskeys", Viewer),
    ("beginPasskey", Viewer),
    ("addPasskey", Viewer),
    ("removePasskey", Viewer),
    // State of the connector.
    ("showStatus", Viewer),
    ("streamEvents", Viewer),
    ("showSpool", Viewer),
    ("listDeadLetters", Viewer),
    ("showConfiguration", Engineer),
    // People.
    ("listUsers", Engineer),
    ("putUser", Engineer),
    ("removeUser", Engineer),
    ("listUserSessions", Engineer),
    ("endUserSession", Engineer),
    ("resetSecondFactor", Engineer),
    // Networks and requests.
    ("listInbox", Viewer),
    ("showRequest", Viewer),
    ("listOperationNetworks", Viewer),
    ("showOperationNetwork", Viewer),
    ("showRevisionDifference", Viewer),
    ("listComments", Viewer),
    ("addComment", Operator),
    // Entered values.
    ("listOperatorOperations", Operator),
    ("listOperatorEntries", Operator),
    ("deliverOperatorEntries", Operator),
    ("enterValue", Operator),
    // Decisions.
    ("showField", Viewer),
    ("showConsentOffer", Engineer),
    ("decideField", Engineer),
    ("previewDecision", Engineer),
    ("listSuggestions", Engineer),
    // Mappings.
    ("listMappingVersions", Viewer),
    ("compareMappingVersions", Viewer),
    ("rollMappingBack", Engineer),
    ("showShadowMapping", Engineer),
    ("startShadowMapping", Engineer),
    ("publishShadowMapping", Engineer),
    ("endShadowMapping", Engineer),
    ("dryRunMapping", Engineer),
    ("surveyMappings", Engineer),
    ("showMappingStatus", Engineer),
    ("restartMapping", Engineer),
    ("exportMappings", Engineer),
    ("importMappings", Engineer),
    ("listMappingTemplates", Viewer),
    ("putMappingTemplate", Engineer),
    ("removeMappingTemplate", Engineer),
    ("makeMappingTemplate", Engineer),
    ("fillMappingTemplate", Engineer),
    // Local OPC UA servers.
    ("listSources", Viewer),
    ("addSource", Engineer),
    ("changeSource", Engineer),
    ("removeSource", Engineer),
    ("showSourceUse", Viewer),
    ("browseSource", Viewer),
    ("searchSource", Viewer),
    ("readSourceValues", Engineer),
    ("listSourceCertificates", Viewer),
    ("trustSourceCertificate", Engineer),
    ("discoverSource", Engineer),
    ("testSource", Engineer),
    ("listServerProfiles", Viewer),
    ("showSourceClientCertificate", Viewer),
    ("prepareSourceClientCertificate", Engineer),
    ("discardSourceClientCertificate", Engineer),
    ("useSourceClientCertificate", Engineer),
    // The OPC UA server.
    ("showApplicationCertificate", Viewer),
    ("requestApplicationCertificate", Engineer),
    ("installApplicationCertificate", Engineer),
    ("listClientCertificates", Viewer),
    ("addClientCertificate", Engineer),
    ("trustClientCertificate", Engineer),
    ("listClientAuthorities", Viewer),
    ("removeClientAuthority", Engineer),
    ("listClientRevocationLists", Viewer),
    ("removeClientRevocationList", Engineer),
    // The ledger.
    ("listLedgerEntries", Viewer),
    ("searchLedgerFields", Viewer),
    ("listCheckpoints", Viewer),
    ("verifyLedger", Engineer),
    ("exportLedger", Engineer),
    ("listRevocations", Viewer),
    ("showRevocation", Viewer),
    ("printRevocation", Viewer),
    ("revokeConsents", Engineer),
    ("listLedgerLogs", Viewer),
    ("beginLedgerLog", Engineer),
    // Policies and standing rules.
    ("listLeakBudgets", Viewer),
    ("summariseLeakBudgets", Viewer),
    ("listPolicies", Viewer),
    ("putPolicy", Engineer),
    ("listPolicyVersions", Viewer),
    ("previewPolicy", Engineer),
    ("listRecipients", Viewer),
    ("putRecipientPolicy", Engineer),
    ("listAlliances", Viewer),
    ("putAlliance", Engineer),
    ("listAllianceVersions", Viewer),
    ("listAllianceBudgets", Viewer),
    ("listCaps", Viewer),
    ("putCap", Engineer),
    ("listCapVersions", Viewer),
    ("previewCap", Engineer),
    ("listRules", Viewer),
    ("putRule", Engineer),
    ("listRuleVersions", Viewer),
    ("previewRule", Engineer),
    ("applyRules", Engineer),
    ("listRuleDecisions", Viewer),
    ("undoRuleDecision", Engineer),
    // The past of requests.
    ("listPastOffers", Viewer),
    ("decidePast", Engineer),
    ("listPastDecisions", Viewer),
];

/// An operation of the description.
pub struct Operation {
    pub id: String,
    pub method: Method,
    /// Its path below `/api/v1`, with the parameters in braces.
    pub template: String,
    /// Its path with `unknown` for each parameter.
    path: String,
    /// The least role that the description names.
    described: Least,
}

/// Returns every operation of the description.
pub fn operations() -> Vec<Operation> {
    let description =
        serde_json::to_value(factory_connector::api::openapi()).expect("it serialises");
    let paths = description["paths"].as_object().expect("paths");
    let mut operations = Vec::new();
    for (path, methods) in paths {
        let path = path.strip_prefix("/api/v1").expect("all operations are under /api/v1");
        for (method, operation) in methods.as_object().expect("methods") {
            operations.push(Operation {
                id: operation["operationId"].as_str().expect("an id").to_owned(),
                method: method.to_uppercase().parse().expect("a method"),
                path: filled(path),
                template: path.to_owned(),
                described: described(operation),
            });
        }
    }
    operations
}

/// Replaces each parameter of a path by `unknown`.
fn filled(path: &str) -> String {
    let segments = path.split('/').map(|part| if part.starts_with('{') { "unknown" } else { part });
    segments.collect::<Vec<_>>().join("/")
}

/// Returns the role beside the security scheme of an operation.
fn described(operation: &Value) -> Least {
    match operation["security"][0]["session"][0].as_str() {
        None => Anonymous,
        Some("VIEWER") => Viewer,
        Some("OPERATOR") => Operator,
        Some("ENGINEER") => Engineer,
        Some(other) => panic!("{other} is no role"),
    }
}

/// Adds a person with a role and returns the person's session.
pub async fn person(plant: &Plant, role: &str) -> SignedIn {
    let (name, password) = (role.to_lowercase(), format!("a password of the {role}"));
    let body = json!({ "role": role, "password": password });
    plant.put(&format!("/users/its-{name}"), body).await;
    plant.signed_in(&format!("its-{name}"), &password).await.expect("the person signs in")
}

/// Calls an operation without parameters and with an empty document; status and problem code.
async fn call(user: &SignedIn, operation: &Operation) -> (u16, String) {
    let body = (operation.method != Method::GET).then(|| "{}".to_owned());
    let (status, problem) = user.status(operation.method.clone(), &operation.path, body).await;
    (status.as_u16(), problem["code"].as_str().unwrap_or_default().to_owned())
}

#[test]
fn the_description_names_the_role_of_each_operation() {
    let described: BTreeMap<String, Least> =
        operations().into_iter().map(|operation| (operation.id, operation.described)).collect();
    let reviewed: BTreeMap<String, Least> =
        ROLES.iter().map(|(id, least)| ((*id).to_owned(), *least)).collect();
    assert_eq!(reviewed.len(), ROLES.len(), "the table names each operation once");
    for (id, least) in &described {
        assert_eq!(reviewed.get(id), Some(least), "{id}: review it and add it to the table");
    }
    for id in reviewed.keys() {
        assert!(described.contains_key(id), "{id} is in the table but not in the description");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn each_operation_admits_its_least_role_and_none_below() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    let reviewed: BTreeMap<&str, Least> = ROLES.iter().copied().collect();
    let people = [
        (Anonymous, plant.signed_out()),
        (Viewer, person(&plant, "VIEWER").await),
        (Operator, person(&plant, "OPERATOR").await),
        (Engineer, person(&plant, "ENGINEER").await),
    ];
    let mut operations = operations();
    // Last, since each session ends with it.
    operations.sort_by_key(|operation| operation.id == "signOut");
    for operation in &operations {
        let least = reviewed[operation.id.as_str()];
        for (role, user) in &people {
            let (status, code) = call(user, operation).await;
            let is_rejected = matches!(code.as_str(), "NOT_SIGNED_IN" | "FORBIDDEN");
            let expected = match role {
                _ if *role >= least => (is_rejected, false),
                Anonymous => (status == 401 && code == "NOT_SIGNED_IN", true),
                _ => (status == 403 && code == "FORBIDDEN", true),
            };
            let Operation { id, method, path, .. } = operation;
            assert_eq!(
                expected.0, expected.1,
                "{id} for {role:?}: {method} {path} answers {status} {code}"
            );
            // Whatever is missing, the operation is there and says so itself.
            assert!(
                status < 500 && status != 405,
                "{id} for {role:?}: {method} {path} answers {status} {code}"
            );
        }
    }
}

/// A viewer sees what partners see: neither values before the gate, nor how many there were.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_viewer_sees_values_before_the_gate() {
    let plant =
        Plant::start(json!([{ "name": "count", "type": 9 }, { "name": "state", "type": 6 }])).await;
    let node = plant.node("Mill1", "Production.PartCounter");
    let mapping = json!({ "inputs": [{ "name": "a", "sourceId": "Mill1", "nodeId": node }],
        "steps": [] });
    plant.map("count", mapping.clone()).await;
    plant.put(&format!("{}/shadow", field("count")), mapping).await;
    let viewer = person(&plant, "VIEWER").await;
    let of_field = ["mapping-status", "shadow", "consent-offer"];
    let mut paths = of_field.map(|name| format!("{}/{name}", field("count"))).to_vec();
    paths.extend([
        "/mappings/survey".to_owned(),
        "/operator/operations".to_owned(),
        "/operator/entries?operationNetworkId=frame&operationId=MakeFrame".to_owned(),
    ]);
    for path in paths {
        let (status, problem) = viewer.status(Method::GET, &path, None).await;
        assert_eq!((status.as_u16(), &problem["code"]), (403, &json!("FORBIDDEN")), "{path}");
    }
    for path in ["/leak-budgets", "/leak-budgets/summary", "/leak-budgets/alliances"] {
        let budgets = viewer.get(path).await;
        assert!(budgets["items"].is_array(), "{path}: {budgets:#}");
        assert!(!budgets.to_string().contains("candidates"), "{path}: {budgets:#}");
    }
    let body = json!({ "nodes": [plant.node("Mill1", "Production.PartCounter")] });
    let (status, problem) =
        viewer.status(Method::POST, "/sources/Mill1/values", Some(body.to_string())).await;
    assert_eq!((status.as_u16(), &problem["code"]), (403, &json!("FORBIDDEN")));
    let budgets = viewer.get("/leak-budgets").await;
    assert!(budgets["items"][0]["fields"][0]["measured"]["released"].is_number(), "{budgets:#}");
    no_viewer_hears_of_withheld_states(&plant, &viewer).await;
}

/// The newest value of a field stays what it was while a state withholds it. That it does would tell
/// the state, and the event of an entry its time.
async fn no_viewer_hears_of_withheld_states(plant: &Plant, viewer: &SignedIn) {
    let path = field("state");
    let decision = json!({ "mappingState": "MAPPED", "valueSource": "MANUAL",
        "disclosure": { "withholdWhile": [{ "states": [7] }] } });
    plant.put(&format!("{path}/decision"), decision).await;
    let enter = async |value: i32| {
        plant.put(&format!("{path}/value"), json!({ "value": value })).await["outcome"].clone()
    };
    assert_eq!(enter(1).await, "DISCLOSED");
    let network = "/operation-networks/frame";
    let request = "/requests/frame/MakeFrame/Req";
    let mut before = Vec::new();
    for page in [&path, network, request] {
        before.push(without_counter(viewer.get(page).await));
    }
    let (mut heard, mut of_engineer) = (viewer.events(None).await, plant.events(None).await);
    assert_eq!(enter(7).await, "SUPPRESSED");
    assert_eq!(plant.get(&path).await["isWithheld"], true, "the engineer sees it");
    for (page, before) in [&path, network, request].into_iter().zip(before) {
        assert!(!before.to_string().contains("isWithheld"), "{page}: {before:#}");
        assert_eq!(without_counter(viewer.get(page).await), before, "{page}");
    }
    assert_eq!(enter(2).await, "DISCLOSED");
    let engineers = until_field(&mut of_engineer).await;
    assert!(engineers.iter().any(|event| event.name == "operator"), "{engineers:?}");
    assert_eq!(engineers.last().expect("it is sent").data["isWithheld"], false, "{engineers:?}");
    let viewers = until_field(&mut heard).await;
    assert!(viewers.iter().all(|event| event.name != "operator"), "{viewers:?}");
    let ids: Vec<&str> = viewers.iter().filter_map(|event| event.id.as_deref()).collect();
    let counts = |id: &&str| id.split_once('-').is_none_or(|(_, part)| part.parse::<u64>().is_ok());
    let is_longer = |id: &&str| id.len() != ids[0].len();
    assert!(
        !ids.iter().any(counts) && !ids.iter().any(is_longer),
        "a number tells of entries: {ids:?}"
    );
    assert_eq!(viewers.last().expect("it is sent").data["isWithheld"], Value::Null, "{viewers:?}");
}

/// Returns the events up to the first about the field `state`.
async fn until_field(events: &mut mpsc::UnboundedReceiver<Event>) -> Vec<Event> {
    let mut heard = Vec::new();
    loop {
        let next = tokio::time::timeout(Duration::from_secs(60), events.recv()).await;
        heard.push(next.expect("it is sent").expect("the stream goes on"));
        let event = &heard[heard.len() - 1];
        if event.name == "field" && event.data["fieldName"] == "state" {
            return heard;
        }
    }
}

/// Returns a page without the field whose machine goes on counting.
fn without_counter(mut page: Value) -> Value {
    for pointer in ["/fields", "/requests/0/fields"] {
        if let Some(fields) = page.pointer_mut(pointer).and_then(Value::as_array_mut) {
            fields.retain(|field| field["name"] != "count");
        }
    }
    page
}
