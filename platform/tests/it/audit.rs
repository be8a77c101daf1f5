//! Record of who changed what: complete, in the transaction of the change, and for those whom it concerns.

use std::collections::BTreeSet;

use platform::{
    audit::{CommandLine, RecordingStore},
    clock::Clock,
    principal::Principal,
    store::{
        AuditAgent, AuditAgentKind, AuditEntry, AuditKept, AuditOutcome, AuditSubject, Leaver,
        Organisation, Role, Scope, Store, User,
    },
};
use reqwest::Method;
use serde_json::{Value, json};

use crate::{
    connector::Peer,
    harness::{ADMIN, Api, PASSWORD, World, eventually},
    story::{self, network_path},
};

async fn entries(api: &Api) -> Vec<Value> {
    let page = api.get("/audit-entries?limit=1000").await.expect_ok();
    let mut items = page["items"].as_array().expect("entries").clone();
    items.reverse();
    items
}

/// Operation, subject and outcome of each entry, oldest first.
async fn lines(api: &Api) -> Vec<String> {
    let text = |value: &Value| value.as_str().expect("a text").to_owned();
    let entries = entries(api).await;
    entries
        .iter()
        .map(|e| {
            format!("{} {} {}", text(&e["operation"]), text(&e["subject"]), text(&e["outcome"]))
        })
        .collect()
}

/// Asserts that each operation of the description that changes something is on record. It is called where
/// all of them were used.
pub async fn every_changing_operation_is_on_record(admin: &Api) {
    let description: Value = serde_json::to_value(platform::api::openapi()).expect("it serialises");
    let mut expected = BTreeSet::new();
    for methods in description["paths"].as_object().expect("paths").values() {
        for (method, operation) in methods.as_object().expect("methods") {
            if method != "get" {
                expected.insert(operation["operationId"].as_str().expect("an id").to_owned());
            }
        }
    }
    // It ends the session with which it is called.
    expected.remove("signOut");
    // Its challenge is in memory alone.
    expected.remove("beginPasskey");
    let entries = entries(admin).await;
    let found: BTreeSet<String> = entries
        .iter()
        .map(|entry| entry["operation"].as_str().expect("an id").to_owned())
        .collect();
    let missing: Vec<_> = expected.difference(&found).collect();
    assert!(missing.is_empty(), "not on record: {missing:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn who_did_what_to_what_is_on_record_for_its_organisation() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let buyer = story::planner(&world, "acme-aero").await;
    story::put_network(&buyer, story::network()).await;
    story::put_network(&buyer, story::network()).await;
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    munich.receive("operation-network", |_| true).await;

    assert_eq!(
        lines(&buyer).await,
        [
            "addOrganisation organisations/acme-aero DONE",
            "putUser users/acme-aero-planner DONE",
            "putUser users/acme-aero-viewer DONE",
            "signIn users/acme-aero-planner/session DONE",
            "putOperationNetwork operation-networks/frame-4711 DONE",
            "putOperationNetwork operation-networks/frame-4711 UNCHANGED",
        ]
    );
    let own = entries(&buyer).await.pop().expect("an entry");
    assert_eq!(
        (&own["agentKind"], &own["agentName"]),
        (&json!("USER"), &json!("acme-aero-planner"))
    );
    assert_eq!(own["organisationId"], "acme-aero");
    assert_eq!(own["detail"], json!([{ "kind": "REVISION", "present": "1" }]));
    // What others did to what is its own: not who they are.
    let by_others = entries(&buyer).await[0].clone();
    assert_eq!((&by_others["agentKind"], &by_others["agentName"]), (&json!("USER"), &Value::Null));
    let maker = story::planner(&world, "frames-munich").await;
    let of_factory = [
        "addFactory factories/FOR_MUC DONE",
        "makeEnrolmentToken factories/FOR_MUC DONE",
        "enrol factories/FOR_MUC DONE",
    ];
    let of_maker = lines(&maker).await;
    let found: Vec<&str> =
        of_maker.iter().map(String::as_str).filter(|line| line.contains("FOR_MUC")).collect();
    assert_eq!(found, of_factory);
    assert!(!of_maker.iter().any(|line| line.contains("frame-4711")), "{of_maker:?}");

    // The export is the same, oldest first.
    let request = buyer.client.request(Method::GET, "/api/v1/audit-entries/export");
    let text = request.send().await.expect("an answer").text().await.expect("a text");
    let exported: Vec<Value> =
        text.lines().map(|line| serde_json::from_str(line).expect("a line of JSON")).collect();
    assert_eq!(exported, entries(&buyer).await);

    // Administrators see all of it; viewers nothing.
    let all = lines(&admin).await;
    assert!(
        all.len() > 20
            && all.contains(&"putOperationNetwork operation-networks/frame-4711 DONE".into())
    );
    let viewer = world.sign_in("acme-aero-viewer", PASSWORD).await;
    viewer.get("/audit-entries").await.expect_problem(403, "FORBIDDEN");
    viewer.get("/audit-entries/export").await.expect_problem(403, "FORBIDDEN");
    buyer.delete("/session").await.expect_ok();
    let last = lines(&admin).await.pop().expect("an entry");
    assert_eq!(last, "signOut users/acme-aero-planner/session DONE");
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_refused_changes_nothing_and_is_not_on_record() {
    let world = World::start().await;
    story::set_up(&world).await;
    let buyer = story::planner(&world, "acme-aero").await;
    story::put_network(&buyer, story::network()).await;
    let maker = story::planner(&world, "frames-munich").await;
    let before = entries(&maker).await;
    maker.delete(&network_path()).await.expect_problem(403, "FORBIDDEN");
    let mut network = story::network();
    network["name"] = json!("Taken");
    let body = json!({ "collaborationId": "order", "operationNetwork": network });
    maker.put(&network_path(), body).await.expect_problem(422, "INVALID_DOCUMENT");
    assert_eq!(entries(&maker).await, before);
}

#[tokio::test(flavor = "multi_thread")]
async fn changes_of_accounts_are_on_record_with_the_person_who_did_them() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let name = "acme-aero-planner";
    let (here, there) =
        (story::planner(&world, "acme-aero").await, story::planner(&world, "acme-aero").await);
    let present = async |api: &Api| {
        let sessions = api.get("/sessions").await.expect_ok()["items"].clone();
        let present =
            sessions.as_array().into_iter().flatten().find(|one| one["isPresent"] == true);
        present.expect("a session")["sessionId"].as_str().expect("an id").to_owned()
    };
    let new_password = "another correct horse";
    here.delete(&format!("/sessions/{}", present(&there).await)).await.expect_ok();
    let body = json!({ "presentPassword": PASSWORD, "newPassword": new_password });
    here.put("/session/password", body).await.expect_ok();
    here.post("/session/second-factor", json!({ "password": new_password })).await.expect_ok();
    admin.delete(&format!("/users/{name}/second-factor")).await.expect_ok();
    let path = format!("/users/{name}/sessions/{}", present(&here).await);
    admin.delete(&path).await.expect_ok();

    let text = |value: &Value| value.as_str().expect("a text").to_owned();
    let all = entries(&admin).await;
    let found: Vec<String> = all[all.len() - 5..]
        .iter()
        .map(|e| {
            format!("{}: {} {}", text(&e["agentName"]), text(&e["operation"]), text(&e["subject"]))
        })
        .collect();
    assert_eq!(
        found,
        [
            format!("{name}: endSession users/{name}/session"),
            format!("{name}: changePassword users/{name}/password"),
            format!("{name}: beginSecondFactor users/{name}/second-factor"),
            format!("{ADMIN}: resetSecondFactor users/{name}/second-factor"),
            format!("{ADMIN}: endUserSession users/{name}/session"),
        ]
    );
    // The organisation of the person sees what others did to the account.
    let again = world.sign_in(name, new_password).await;
    let seen = lines(&again).await;
    assert!(
        seen.contains(&format!("resetSecondFactor users/{name}/second-factor DONE")),
        "{seen:?}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_tool_asks_is_on_record() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let buyer = story::planner(&world, "acme-aero").await;
    story::put_network(&buyer, story::network()).await;
    let tool =
        json!({ "toolId": "Scheduling", "organisationId": "acme-aero", "name": "Scheduling" });
    admin.post("/tools", tool).await.expect_ok();
    let credential = admin.post("/tools/Scheduling/credentials", json!({})).await.expect_ok();
    let peer = Peer::tool(&credential, "Scheduling");
    peer.send(
        "data-request",
        &json!({ "messageType": "data-request", "messageId": "dr1", "toolId": "Scheduling",
            "operationNetworkId": story::NETWORK, "operationId": "MakeFrame1",
            "dynamicDataRequest": story::request("OfTool", "acme-aero") }),
    );
    let entry = eventually("the entry", || async {
        let last = entries(&buyer).await.pop().expect("an entry");
        if last["agentKind"] == "TOOL" { Ok(last) } else { Err(last.to_string()) }
    })
    .await;
    assert_eq!(
        (&entry["agentName"], &entry["operation"]),
        (&json!("Scheduling"), &json!("addDynamicDataRequest"))
    );
    assert_eq!(
        entry["subject"],
        "operation-networks/frame-4711/operations/MakeFrame1/requests/OfTool"
    );
}

async fn store() -> (tempfile::TempDir, Store) {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Store::open(&folder.path().join("platform.sqlite")).await.expect("a store");
    (folder, store)
}

fn organisation(id: &str) -> Organisation {
    let organisation_id = id.parse().expect("an id");
    Organisation { organisation_id, name: id.to_owned(), created_at: Clock::system().now() }
}

async fn all(store: &Store) -> Vec<AuditEntry> {
    let mut work = store.read().await.expect("begun");
    work.audit().list_after(&Scope::Platform, 0, 1_000).await.expect("listed")
}

#[tokio::test]
async fn a_change_and_its_entry_happen_together_or_not_at_all() {
    let (_folder, store) = store().await;
    let recording = RecordingStore::new(store.clone(), Clock::system());
    let mut work = recording.begin(CommandLine, "addOrganisation").await.expect("begun");
    work.organisations().add(&organisation("a")).await.expect("added");
    drop(work);
    let id = "a".parse().expect("an id");
    assert!(!store.read().await.expect("begun").organisations().exists(&id).await.expect("read"));
    assert_eq!(all(&store).await, []);

    let mut work = recording.begin(CommandLine, "addOrganisation").await.expect("begun");
    work.organisations().add(&organisation("a")).await.expect("added");
    let subject = AuditSubject::of(&id, "organisations/a");
    work.commit(subject, AuditOutcome::Done).await.expect("committed");
    assert!(store.read().await.expect("begun").organisations().exists(&id).await.expect("read"));
    let subjects: Vec<String> = all(&store).await.into_iter().map(|entry| entry.subject).collect();
    assert_eq!(subjects, ["organisations/a"]);
}

#[tokio::test]
async fn entries_are_never_changed_and_only_the_oldest_removed() {
    let (folder, store) = store().await;
    let recording = RecordingStore::new(store.clone(), Clock::system());
    for number in 1..=5 {
        let work = recording.begin(person("a"), "addOrganisation").await.expect("begun");
        let subject = AuditSubject::shared(format!("organisations/{number}"));
        work.commit(subject, AuditOutcome::Done).await.expect("committed");
    }
    let path = folder.path().join("platform.sqlite");
    let pool =
        sqlx::SqlitePool::connect(&format!("sqlite://{}", path.display())).await.expect("open");
    for statement in [
        "UPDATE audit_entry SET subject = 'another' WHERE audit_entry_id = 2",
        "DELETE FROM audit_entry WHERE audit_entry_id = 2",
    ] {
        assert!(sqlx::query(statement).execute(&pool).await.is_err(), "{statement}");
    }
    pool.close().await;
    let mut work = store.begin().await.expect("begun");
    let now = Clock::system().now();
    let none = work.audit().forget(newest(100), 100).await;
    assert_eq!(none.expect("nothing is old"), (0, Vec::new()));
    let beyond = work.audit().forget(newest(3), 1).await;
    assert_eq!(beyond.expect("one at a time"), (1, vec!["a".parse().expect("an id")]));
    work.audit().forget(newest(3), 100).await.expect("the other");
    work.commit().await.expect("committed");
    let numbers: Vec<u64> = all(&store).await.into_iter().map(|entry| entry.number).collect();
    assert_eq!(numbers, [3, 4, 5]);
    let later = now.after(std::time::Duration::from_secs(60));
    let mut work = store.begin().await.expect("begun");
    let kept = AuditKept { since: later, count: 100 };
    let forgotten = work.audit().forget(kept, 100).await;
    assert_eq!(forgotten.expect("all are old"), (3, Vec::new()));
}

fn person(organisation: &str) -> AuditAgent {
    let organisation_id = Some(organisation.parse().expect("an id"));
    let (kind, name) = (AuditAgentKind::User, "p".to_owned());
    AuditAgent { kind, name, organisation_id, is_administrator: false }
}

/// The newest entries of each share, however old.
fn newest(count: u64) -> AuditKept {
    AuditKept { since: asi_model::DateTime::from_ticks(0), count }
}

#[tokio::test]
async fn what_administrators_and_commands_did_is_kept_its_whole_time() {
    let (_folder, store) = store().await;
    let mut work = store.begin().await.expect("begun");
    work.organisations().add(&organisation("a")).await.expect("added");
    let (user_name, role) = ("root".to_owned(), Role::Administrator);
    let root = User { user_name, role, organisation_id: Some("a".parse().expect("an id")) };
    let hash = daemon::web::session::PasswordHash::from_stored("x".to_owned());
    work.users().put(&root, &hash, Clock::system().now()).await.expect("stored");
    work.commit().await.expect("committed");
    let recording = RecordingStore::new(store.clone(), Clock::system());
    let root = Principal { user: root };
    for (agent, count) in [(AuditAgent::from(&root), 5), (CommandLine.into(), 5), (person("a"), 20)]
    {
        for number in 0..count {
            let work = recording.begin(agent.clone(), "putNetwork").await.expect("begun");
            let subject = AuditSubject::shared(format!("{}/{number}", agent.name));
            work.commit(subject, AuditOutcome::Done).await.expect("committed");
        }
    }
    // The last thing that it does: there is no account of it any more when that is put on record.
    let mut work = recording.begin(&root, "removeUser").await.expect("begun");
    let leaver = Leaver::User("root".to_owned());
    work.removals().leave(&leaver, Clock::system().now()).await.expect("left");
    let end = AuditSubject::shared(leaver.path());
    work.commit(end, AuditOutcome::Done).await.expect("committed");
    let mut work = store.begin().await.expect("begun");
    let (forgotten, beyond) = work.audit().forget(newest(3), 1_000).await.expect("forgotten");
    work.commit().await.expect("committed");
    assert_eq!((forgotten, beyond), (17, vec!["a".parse().expect("an id")]));
    let of = |name: &'static str| move |entry: &&AuditEntry| entry.subject.starts_with(name);
    let left = all(&store).await;
    let names = ["root/", "users/root", "platform/", "p/"];
    let counts = names.map(|name| left.iter().filter(of(name)).count());
    assert_eq!(counts, [5, 1, 5, 3]);
}

#[tokio::test]
async fn what_one_organisation_does_pushes_out_no_entry_of_another() {
    let (_folder, store) = store().await;
    let recording = RecordingStore::new(store.clone(), Clock::system());
    for number in 1..=7 {
        let organisation = if number == 1 { "quiet" } else { "busy" };
        let work = recording.begin(person(organisation), "addOrganisation").await.expect("begun");
        let subject = AuditSubject::shared(format!("{organisation}/{number}"));
        work.commit(subject, AuditOutcome::Done).await.expect("committed");
    }
    let mut work = store.begin().await.expect("begun");
    let (forgotten, beyond) = work.audit().forget(newest(3), 100).await.expect("forgotten");
    assert_eq!((forgotten, beyond), (3, vec!["busy".parse().expect("an id")]), "of the busy one");
    work.commit().await.expect("committed");
    let subjects: Vec<String> = all(&store).await.into_iter().map(|entry| entry.subject).collect();
    assert_eq!(subjects, ["quiet/1", "busy/5", "busy/6", "busy/7"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_change_that_changes_nothing_is_recorded_once() {
    let world = World::start().await;
    let (admin, buyer, _munich, _hamburg) = story::accepted(&world).await;
    let before = lines(&admin).await.len();
    for _ in 0..20 {
        story::put_network(&buyer, story::network()).await;
    }
    let after = lines(&admin).await;
    assert_eq!(after.len(), before + 1, "{after:?}");
    assert!(after[before].ends_with("UNCHANGED"), "{after:?}");
}
