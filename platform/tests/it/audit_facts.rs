//! Facts of the record: what operation and path do not say, for whom it concerns, and what factories change.

use serde_json::{Value, json};

use crate::{
    connector::Peer,
    harness::{Api, PASSWORD, World, eventually},
    past_releases::release,
    revocations::receipt,
    story::{self, NETWORK},
};

const REQUEST: &str = "operation-networks/frame-4711/operations/MakeFrame1/requests/ReqResponse1";

async fn entries(api: &Api) -> Vec<Value> {
    let page = api.get("/audit-entries?limit=1000").await.expect_ok();
    page["items"].as_array().expect("entries").clone()
}

/// The newest entry of an operation, once there is one.
pub async fn newest(api: &Api, operation: &str) -> Value {
    eventually(operation, || async {
        let found = entries(api).await.into_iter().find(|entry| entry["operation"] == operation);
        found.ok_or_else(|| "no entry".to_owned())
    })
    .await
}

fn fact(kind: &str, former: Option<&str>, present: Option<&str>) -> Value {
    let mut fact = json!({ "kind": kind });
    for (name, value) in [("former", former), ("present", present)] {
        if let Some(value) = value {
            fact[name] = json!(value);
        }
    }
    fact
}

#[tokio::test(flavor = "multi_thread")]
async fn an_entry_says_former_and_new_role_and_organisation_to_those_whom_it_concerns() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let (buyer, stranger) =
        (story::planner(&world, "acme-aero").await, story::planner(&world, "stranger").await);
    let put =
        |role: &str, of: &str| json!({ "password": PASSWORD, "role": role, "organisationId": of });
    let set = fact("PASSWORD", None, Some("SET"));

    admin.put("/users/acme-aero-viewer", put("PLANNER", "acme-aero")).await.expect_ok();
    let role = fact("ROLE", Some("VIEWER"), Some("PLANNER"));
    let same = fact("ORGANISATION", Some("acme-aero"), Some("acme-aero"));
    assert_eq!(newest(&admin, "putUser").await["detail"], json!([role, same, set]));
    assert_eq!(newest(&buyer, "putUser").await["detail"], json!([role, set]));

    // From where a person came is not said to its next organisation.
    admin.put("/users/acme-aero-viewer", put("VIEWER", "stranger")).await.expect_ok();
    let moved = fact("ORGANISATION", Some("acme-aero"), Some("stranger"));
    let detail = newest(&admin, "putUser").await["detail"].clone();
    assert_eq!(detail[1], moved);
    let seen = newest(&stranger, "putUser").await;
    assert_eq!(seen["subject"], "users/acme-aero-viewer");
    assert_eq!(seen["detail"], json!([fact("ROLE", Some("PLANNER"), Some("VIEWER")), set]));

    // The organisation that it left sees so, and not where it went.
    let gone = newest(&buyer, "putUser").await;
    assert_eq!(gone["subject"], "users/acme-aero-viewer");
    assert_eq!(gone["detail"], json!([fact("ROLE", Some("PLANNER"), None)]));

    // What an administrator does to others says nothing of them to the administrator's organisation.
    admin.put("/users/second", put("ADMINISTRATOR", "stranger")).await.expect_ok();
    let second = world.sign_in("second", PASSWORD).await;
    let factory = json!({ "factoryId": "NEW", "organisationId": "acme-aero", "name": "New" });
    second.post("/factories", factory).await.expect_ok();
    let owner = fact("ORGANISATION", None, Some("acme-aero"));
    assert_eq!(newest(&admin, "addFactory").await["detail"], json!([owner]));
    assert_eq!(newest(&stranger, "addFactory").await["detail"], json!([]));

    let text = json!(entries(&admin).await).to_string();
    assert!(!text.contains(PASSWORD), "a password is in the record");
}

#[tokio::test(flavor = "multi_thread")]
async fn an_entry_says_members_factories_revisions_and_credentials() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let buyer = story::planner(&world, "acme-aero").await;
    story::put_network(&buyer, story::network()).await;
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    let members = ["acme-aero", "frames-munich", "inspect-hamburg"];
    let members = members.map(|id| fact("MEMBER", None, Some(id)));
    let factories = ["FOR_MUC", "INS_HAM"].map(|id| fact("FACTORY", None, Some(id)));
    let made = newest(&admin, "addCollaboration").await["detail"].clone();
    assert_eq!(made, json!([members.as_slice(), factories.as_slice()].concat()));
    let drawn = newest(&buyer, "putOperationNetwork").await["detail"].clone();
    assert_eq!(drawn, json!([fact("REVISION", None, Some("1"))]));

    admin.delete("/factories/FOR_MUC/credentials").await.expect_ok();
    let maker = story::planner(&world, "frames-munich").await;
    let revoked = newest(&maker, "revokeFactoryCredentials").await["detail"].clone();
    assert_eq!(revoked, json!([fact("CREDENTIALS", Some("1"), None)]));
    drop(munich);

    admin.delete("/users/frames-munich-viewer").await.expect_ok();
    let left = newest(&maker, "removeUser").await;
    assert_eq!(left["detail"], json!([fact("ROLE", Some("VIEWER"), None)]));
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_factory_changes_of_what_others_see_is_on_record() {
    let world = World::start().await;
    let (_admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    let maker = story::planner(&world, "frames-munich").await;
    let state = |state| fact("STATE", None, Some(state));

    let decided = newest(&maker, "decideField").await;
    let agent = (&decided["agentKind"], &decided["agentName"], &decided["organisationId"]);
    assert_eq!(agent, (&json!("FACTORY"), &json!("FOR_MUC"), &json!("frames-munich")));
    assert_eq!(decided["subject"], format!("{REQUEST}/fields/progressStatus"));
    assert_eq!(decided["detail"], json!([state("MAPPED")]));
    let answered = newest(&maker, "answerOperationNetwork").await;
    assert_eq!(answered["subject"], "operation-networks/frame-4711");
    let revision = fact("REVISION", None, Some("1"));
    assert_eq!(answered["detail"], json!([revision, state("ACCEPTED")]));

    let comment = json!({ "messageType": "comment", "messageId": "c1", "factoryId": "FOR_MUC",
        "operationNetworkId": NETWORK, "dynamicDataRequestId": "ReqResponse1",
        "authorId": "engineer", "text": "said among us" });
    munich.send("comment", &comment);
    let said = newest(&maker, "addComment").await;
    let person = fact("PERSON", None, Some("engineer@FOR_MUC"));
    assert_eq!(said["detail"], json!([person, fact("REQUEST", None, Some("ReqResponse1"))]));
    assert!(!said.to_string().contains("said among us"), "{said}");

    munich.send("revocation", &receipt("FOR_MUC", &["acme-aero"]));
    let revoked = newest(&maker, "revokeConsent").await;
    assert_eq!(revoked["subject"], REQUEST);
    assert_eq!(revoked["detail"], json!([fact("RECIPIENT", None, Some("acme-aero"))]));

    munich.send("ua-data", &story::report("m0", 0, 3));
    story::value_is(&buyer, "3").await;
    munich.send("past-release", &release("acme-aero", 0, 0));
    let released = newest(&maker, "releasePast").await;
    assert_eq!(released["subject"], format!("{REQUEST}/recipients/acme-aero"));
    let reports = released["detail"][0].clone();
    assert!(
        reports["kind"] == "REPORTS"
            && reports["present"]
                .as_str()
                .is_some_and(|range| { range.starts_with("1/") && range.ends_with("/0-0") }),
        "{reports}"
    );

    // No entry is of a report, nor of what comes once more and changes nothing.
    let before = entries(&maker).await;
    munich.send("decision", &story::decision("MAPPED", None));
    munich.send("past-release", &release("acme-aero", 0, 0));
    munich.send("ua-data", &story::report("m1", 1, 4));
    story::value_is(&buyer, "4").await;
    assert_eq!(entries(&maker).await, before);

    munich.send("decision", &story::decision_at("2019-04-18T19:00:00Z", "REFUSED", None));
    story::state_is(&buyer, "REFUSED").await;
    assert_eq!(newest(&maker, "decideField").await["detail"], json!([state("REFUSED")]));
    let seen = json!(entries(&buyer).await).to_string();
    assert!(!seen.contains("FOR_MUC"), "of another organisation: {seen}");
}
