//! One answer of every operation, as a snapshot that the description of the API allows, and live
//! events that it allows. A new operation or kind of event without one fails the test.

use std::collections::BTreeSet;

use platform::opaque_id::OpaqueId;
use serde_json::{Value, json};
use testkit::{Contract, SecurityKey, authenticator::code};

use crate::{
    audit,
    harness::{Answer, Api, Live, PAGES, PASSWORD, World, event_form, eventually},
    leases::{ask, with_leases},
    story::{self, NETWORK},
    witness,
};

/// Members whose values differ from run to run, or depend on the machine.
const VOLATILE: [&str; 24] = [
    "agentId",
    "brokerDisk",
    "brokerUrl",
    "checkpoint",
    "connections",
    "csrfToken",
    "detail",
    "lastEventId",
    "link",
    "options",
    "passkeyId",
    "password",
    "profile",
    "qrCode",
    "queues",
    "recoveryCodes",
    "rootCertificatePem",
    "secret",
    "sessionId",
    "token",
    "uri",
    "verifierKey",
    "version",
    "witnessKey",
];

/// Operation that answers with live events.
const STREAM: &str = "streamLive";

/// Checks of the answers of one platform.
struct Answers {
    contract: Contract,
    /// Operations with a snapshot so far.
    seen: BTreeSet<String>,
    /// Kinds of live events that have not come so far.
    unheard: BTreeSet<String>,
    /// Answers and events that the description does not allow.
    faults: Vec<String>,
}

impl Answers {
    fn new() -> Self {
        let description = serde_json::to_value(platform::api::openapi()).expect("it serialises");
        let contract = Contract::new(&description);
        let unheard = contract.events(STREAM);
        Self { contract, seen: BTreeSet::new(), unheard, faults: Vec::new() }
    }

    /// Compares an answer with the description and the snapshot of its operation.
    fn check(&mut self, operation: &str, answer: &Answer) {
        self.faults.extend(self.contract.faults(operation, answer.status, &answer.body));
        let document = json!({ "status": answer.status, "body": redacted(&answer.body) });
        insta::assert_json_snapshot!(operation, document);
        assert!(self.seen.insert(operation.to_owned()), "{operation} has two answers");
    }

    /// Compares the next live event with the description.
    async fn hear(&mut self, live: &mut Live) {
        let event = live.event().await;
        let event = event.unwrap_or_else(|| panic!("events that did not come: {:?}", self.unheard));
        self.faults.extend(self.contract.event_faults(STREAM, &event));
        self.unheard.remove(&event.name);
    }

    async fn get(&mut self, api: &Api, operation: &str, path: &str) {
        self.check(operation, &api.get(path).await);
    }

    async fn post(&mut self, api: &Api, operation: &str, path: &str, body: Value) {
        self.check(operation, &api.post(path, body).await);
    }

    async fn put(&mut self, api: &Api, operation: &str, path: &str, body: Value) {
        self.check(operation, &api.put(path, body).await);
    }

    async fn delete(&mut self, api: &Api, operation: &str, path: &str) {
        self.check(operation, &api.delete(path).await);
    }
}

/// The answer with volatile members and times replaced.
fn redacted(value: &Value) -> Value {
    match value {
        Value::Object(members) => members
            .iter()
            .map(|(name, value)| {
                if name == "lastEventId" {
                    assert!(event_form(value).ends_with("-[36 bytes]"), "{value}");
                }
                // The detail of a problem is a text; that of an entry of the record has facts.
                let is_kept = value.is_null() || (name == "detail" && value.is_array());
                let is_volatile = VOLATILE.contains(&name.as_str()) && !is_kept;
                let shown = if is_volatile { json!(format!("[{name}]")) } else { redacted(value) };
                (name.clone(), shown)
            })
            .collect(),
        Value::Array(elements) => elements.iter().map(redacted).collect(),
        Value::String(text) if text.parse::<asi_model::DateTime>().is_ok() => json!("[time]"),
        Value::String(text) if text.parse::<OpaqueId>().is_ok() => json!("[opaque id]"),
        other => other.clone(),
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn every_operation_answers_as_in_its_snapshot() {
    let world = World::start_for_browsers().await;
    let beginning = world.handle().application.live.newest_id();
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("revocation", &crate::revocations::receipt("FOR_MUC", &["acme-aero"]));
    eventually("a receipt", || async {
        let path = format!("{}/revocations", story::network_path());
        let receipts = buyer.get(&path).await.expect_ok();
        if receipts["items"][0].is_object() { Ok(()) } else { Err(receipts.to_string()) }
    })
    .await;
    with_leases(&munich);
    ask(&munich, "a", "here").await;
    ask(&munich, "b", "there").await;
    witness::countersigned(&munich).await;
    munich.send_under(1, "ua-data", &story::report("m0", 0, 3));
    story::value_is(&buyer, "3").await;
    let mut unusable = story::report("m1", 1, 4);
    unusable["Messages"][0].as_object_mut().expect("a message").remove("SequenceNumber");
    munich.send_under(1, "ua-data", &unusable);
    eventually("a dead letter", || async {
        let letters = admin.get("/dead-letters").await.expect_ok();
        if letters["items"][0].is_object() { Ok(()) } else { Err(letters.to_string()) }
    })
    .await;

    let mut answers = Answers::new();
    let maker = story::planner(&world, "frames-munich").await;
    world.handle().application.accesses.settle().await.expect("recorded");
    accesses(&mut answers, &maker).await;
    reading(&mut answers, &admin, &buyer).await;
    structure(&mut answers, &admin).await;
    comments(&mut answers, &buyer).await;
    events(&mut answers, &buyer, &beginning).await;
    networks(&mut answers, &buyer).await;
    account(&mut answers, &world, &admin).await;
    answers.get(&buyer, "listAuditEntries", "/audit-entries?limit=4").await;
    audit::every_changing_operation_is_on_record(&admin).await;
    answers.get(&buyer, "exportAuditEntries", "/audit-entries/export").await;
    let body = json!({ "userName": "acme-aero-viewer", "password": PASSWORD });
    answers.post(&world.anonymous(), "signIn", "/session", body).await;
    answers.delete(&buyer, "signOut", "/session").await;

    assert!(answers.faults.is_empty(), "the description differs:\n{}", answers.faults.join("\n"));
    // A stream has no single answer: its events are compared one by one.
    let mut operations = answers.contract.operations();
    operations.remove(STREAM);
    assert_eq!(answers.seen, operations);
}

/// Everything about a person's own account.
async fn account(answers: &mut Answers, world: &World, admin: &Api) {
    let body = json!({ "password": PASSWORD, "role": "VIEWER" });
    admin.put("/users/ann", body).await.expect_ok();
    let (here, there) =
        (world.sign_in("ann", PASSWORD).await, world.sign_in("ann", PASSWORD).await);
    let present = async |api: &Api| {
        let sessions = api.get("/sessions").await.body["items"].clone();
        let present =
            sessions.as_array().into_iter().flatten().find(|one| one["isPresent"] == true);
        present.expect("a session")["sessionId"].as_str().expect("an id").to_owned()
    };
    answers.delete(&here, "endSession", &format!("/sessions/{}", present(&there).await)).await;
    answers.get(&here, "listSessions", "/sessions").await;
    answers.get(admin, "listUserSessions", "/users/ann/sessions").await;
    let new_password = "another correct horse";
    let body = json!({ "presentPassword": PASSWORD, "newPassword": new_password });
    answers.put(&here, "changePassword", "/session/password", body).await;

    let path = "/session/second-factor";
    answers.get(&here, "showSecondFactor", path).await;
    let begin = json!({ "password": new_password });
    let offer = here.post(path, begin.clone()).await;
    answers.check("beginSecondFactor", &offer);
    let code = code(offer.body["secret"].as_str().expect("a secret"), 0);
    let confirmed = here.put(path, json!({ "code": code })).await;
    answers.check("confirmSecondFactor", &confirmed);
    let body =
        json!({ "password": new_password, "code": confirmed.body["recoveryCodes"][0].clone() });
    answers.post(&here, "removeSecondFactor", "/session/second-factor/removal", body).await;
    here.post(path, begin.clone()).await.expect_ok();

    let path = "/session/passkeys";
    let offer = here.post(path, begin.clone()).await;
    answers.check("beginPasskey", &offer);
    let credential = SecurityKey::new("blue", PAGES).create(&offer.body["options"]);
    let added = here.put(path, json!({ "name": "Blue key", "credential": credential })).await;
    answers.check("addPasskey", &added);
    let list = here.get(path).await;
    answers.check("listPasskeys", &list);
    let id = list.body["items"][0]["passkeyId"].as_str().expect("an id").to_owned();
    answers.post(&here, "removePasskey", &format!("{path}/{id}/removal"), begin.clone()).await;
    here.post("/session/second-factor", begin).await.expect_ok();
    answers.delete(admin, "resetSecondFactor", "/users/ann/second-factor").await;
    let path = format!("/users/ann/sessions/{}", present(&here).await);
    answers.delete(admin, "endUserSession", &path).await;
}

async fn accesses(answers: &mut Answers, maker: &Api) {
    answers.get(maker, "listAccesses", "/factories/FOR_MUC/accesses").await;
    answers.get(maker, "showAccessCheckpoint", "/factories/FOR_MUC/accesses/checkpoint").await;
    answers.get(maker, "exportAccesses", "/factories/FOR_MUC/accesses/audit").await;
}

async fn reading(answers: &mut Answers, admin: &Api, buyer: &Api) {
    answers.get(buyer, "showSession", "/session").await;
    answers.get(admin, "showStatus", "/status").await;
    answers.get(buyer, "listOrganisations", "/organisations").await;
    answers.get(buyer, "listFactories", "/factories").await;
    answers.get(admin, "showLease", "/factories/FOR_MUC/lease").await;
    answers.get(admin, "listWriters", "/factories/FOR_MUC/writers").await;
    answers.get(buyer, "listLedgerLogs", "/factories/FOR_MUC/ledger-logs").await;
    answers.get(buyer, "listCollaborations", "/collaborations").await;
    answers.get(buyer, "listOperationNetworks", "/operation-networks").await;
    answers.get(buyer, "showOperationNetwork", &story::network_path()).await;
    answers.get(buyer, "listReports", "/reports").await;
    let path = format!("{}/revocations", story::network_path());
    answers.get(buyer, "listRevocations", &path).await;
    answers.get(admin, "listDeadLetters", "/dead-letters").await;
    let path = "/dead-letters/ingest-1/replay";
    answers.post(admin, "replayDeadLetter", path, json!({})).await;
}

async fn structure(answers: &mut Answers, admin: &Api) {
    let body = json!({ "organisationId": "new", "name": "A new one" });
    answers.post(admin, "addOrganisation", "/organisations", body).await;
    let body = json!({ "password": PASSWORD, "role": "VIEWER", "organisationId": "new" });
    answers.put(admin, "putUser", "/users/new-viewer", body).await;
    let body = json!({ "factoryId": "NEW", "organisationId": "new", "name": "A new factory" });
    answers.post(admin, "addFactory", "/factories", body).await;
    let made = admin.post("/factories/NEW/enrolment-tokens", json!({})).await;
    answers.check("makeEnrolmentToken", &made);
    let body = json!({ "token": made.body["token"] });
    answers.post(admin, "enrol", "/enrolments", body).await;
    answers.delete(admin, "revokeFactoryCredentials", "/factories/NEW/credentials").await;
    let body = json!({ "instanceId": "b" });
    answers.post(admin, "handLeaseOver", "/factories/FOR_MUC/lease/handovers", body).await;
    let body = json!({ "toolId": "Monitoring", "organisationId": "new", "name": "Monitoring" });
    answers.post(admin, "addTool", "/tools", body).await;
    answers.get(admin, "listTools", "/tools").await;
    let path = "/tools/Monitoring/credentials";
    answers.post(admin, "makeToolCredential", path, json!({})).await;
    answers.delete(admin, "revokeToolCredentials", path).await;
    let body = json!({ "collaborationId": "new", "name": "A new one", "members": ["new"] });
    answers.post(admin, "addCollaboration", "/collaborations", body).await;
    let path = "/collaborations/new/members/acme-aero";
    answers.put(admin, "addMember", path, json!({})).await;
    let path = "/collaborations/new/factories/NEW";
    answers.put(admin, "addCollaborationFactory", path, json!({})).await;
    answers.delete(admin, "removeCollaborationFactory", path).await;
    answers.delete(admin, "removeMember", "/collaborations/new/members/acme-aero").await;
    answers.delete(admin, "removeCollaboration", "/collaborations/new").await;
    answers.delete(admin, "removeTool", "/tools/Monitoring").await;
    answers.delete(admin, "removeFactory", "/factories/NEW").await;
    answers.get(admin, "listUsers", "/users").await;
    answers.delete(admin, "removeUser", "/users/new-viewer").await;
    answers.delete(admin, "removeOrganisation", "/organisations/new").await;
}

async fn comments(answers: &mut Answers, buyer: &Api) {
    let path = format!("/operation-networks/{NETWORK}/comments");
    let body = json!({ "factoryId": "FOR_MUC", "text": "On time?" });
    answers.post(buyer, "addComment", &path, body).await;
    answers.get(buyer, "listComments", &path).await;
}

/// Compares the events since the beginning with the description, until each kind has come.
async fn events(answers: &mut Answers, buyer: &Api, beginning: &str) {
    // The platform does not know the first id.
    answers.hear(&mut buyer.live(Some("unknown")).await).await;
    let mut live = buyer.live(Some(beginning)).await;
    while !answers.unheard.is_empty() {
        answers.hear(&mut live).await;
    }
}

async fn networks(answers: &mut Answers, buyer: &Api) {
    let path = format!("/operation-networks/{NETWORK}/operations/MakeFrame1/requests");
    let body = story::request("ReqResponse2", "acme-aero");
    answers.post(buyer, "addDynamicDataRequest", &path, body).await;
    let path = format!("{path}/ReqResponse2");
    answers.delete(buyer, "removeDynamicDataRequest", &path).await;
    let body = json!({ "collaborationId": "order", "operationNetwork": story::network() });
    answers.put(buyer, "putOperationNetwork", &story::network_path(), body).await;
    answers.delete(buyer, "withdrawOperationNetwork", &story::network_path()).await;
}
