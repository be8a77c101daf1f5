//! Entitlement travels with the value: a report is read by those to whom it was released when it
//! left the plant, and by nobody else, whatever the network says later.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::{
    connector::Peer,
    harness::{Api, World, eventually},
    story::{self, NETWORK, network_path},
};

pub const BUYER: &str = "acme-aero";
pub const INSPECTOR: &str = "inspect-hamburg";

/// The network with the buyer's request open to these recipients.
pub fn network_to(recipients: &[&str]) -> Value {
    let mut network = story::network();
    network["operationList"][0]["dynamicDataRequestList"][0]["recipientList"] = json!(recipients);
    network
}

/// The sequence numbers of the reports that a viewer may read.
pub async fn sequences(api: &Api) -> Vec<u64> {
    let reports = api.get(&format!("/reports?network={NETWORK}")).await.expect_ok();
    let items = reports["items"].as_array().cloned().unwrap_or_default();
    items.iter().filter_map(|report| report["sequence"].as_u64()).collect()
}

/// Waits until the platform holds as many reports of FOR_MUC.
pub async fn held(admin: &Api, count: u64) {
    eventually("the reports", || async {
        let writers = admin.get("/factories/FOR_MUC/writers").await.expect_ok();
        let received = writers["items"][0]["received"].as_u64();
        if received == Some(count) { Ok(()) } else { Err(writers.to_string()) }
    })
    .await;
}

/// Returns what a viewer sees of `progressStatus`: its value, whether a report about the network is known,
/// and the quantity concluded from it.
pub async fn shown(api: &Api) -> (Value, bool, Value) {
    let view = api.get(&network_path()).await.expect_ok();
    let networks = api.get("/operation-networks").await.expect_ok();
    (
        view["fields"][0]["value"].clone(),
        networks["items"][0]["lastReportAt"].is_string(),
        view["operations"][0]["quantity"].clone(),
    )
}

pub fn nothing() -> (Value, bool, Value) {
    (Value::Null, false, Value::Null)
}

/// The factory takes the newest revision, and its engineer consents again.
pub async fn consent_again(buyer: &Api, munich: &Peer, revision: u64, time: &str) {
    let part = munich.receive("operation-network", |part| part["revision"] == revision).await;
    munich.send("decision", &story::decision_at(time, "PENDING", None));
    munich.accept(&part);
    munich.send("decision", &story::decision_at(time, "MAPPED", None));
    story::state_is(buyer, "MAPPED").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_recipient_added_later_sees_only_what_was_released_to_it() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    munich.send("ua-data", &story::report_to(&[BUYER], "m0", 0, 3));
    story::value_is(&buyer, "3").await;

    story::put_network(&buyer, network_to(&[BUYER, INSPECTOR])).await;
    assert_eq!((sequences(&inspector).await, shown(&inspector).await), (vec![], nothing()));
    // On its way when the revision came, and so released to the buyer alone.
    munich.send("ua-data", &story::report_to(&[BUYER], "m1", 1, 4));
    held(&admin, 2).await;
    assert_eq!((sequences(&inspector).await, shown(&inspector).await), (vec![], nothing()));

    consent_again(&buyer, &munich, 2, "2019-04-18T18:30:00Z").await;
    assert_eq!((sequences(&inspector).await, shown(&inspector).await), (vec![], nothing()));
    munich.send("ua-data", &story::report_to(&[BUYER, INSPECTOR], "m2", 2, 5));
    story::value_is(&inspector, "5").await;
    assert_eq!(sequences(&inspector).await, [2]);
    assert_eq!(sequences(&buyer).await, [0, 1, 2]);
}

/// Returns what a viewer sees of the decision about `progressStatus`: state, reason and precision.
async fn decision_shown(api: &Api) -> (Value, Value, Value) {
    let view = api.get(&network_path()).await.expect_ok();
    let field = &view["fields"][0];
    (field["mappingState"].clone(), field["reason"].clone(), field["disclosure"].clone())
}

/// The reason of a decision, and the precision, were meant for those whom the factory knew of.
#[tokio::test(flavor = "multi_thread")]
async fn a_decision_to_a_former_revision_shows_a_new_recipient_the_state_alone() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    let view = inspector.get(&network_path()).await.expect_ok();
    let mut live = inspector.live(view["lastEventId"].as_str()).await;
    let precision = json!({ "description": "Rounded to whole dozens." });
    let whole = (json!("MAPPED"), json!("as agreed"), precision.clone());
    let consent_at = |time: &str| {
        let mut decision = story::decision_at(time, "MAPPED", Some("as agreed"));
        decision["disclosure"] = precision.clone();
        decision
    };

    story::put_network(&buyer, network_to(&[BUYER, INSPECTOR])).await;
    munich.send("decision", &consent_at("2019-04-18T18:25:00Z"));
    story::state_is(&buyer, "MAPPED").await;
    assert_eq!(decision_shown(&buyer).await, whole, "it was made for the buyer");
    let bare = (json!("MAPPED"), Value::Null, Value::Null);
    assert_eq!(decision_shown(&inspector).await, bare);
    let (_, event) = live.next("decision").await;
    assert_eq!((&event["mappingState"], &event["reason"]), (&json!("MAPPED"), &Value::Null));

    let part = munich.receive("operation-network", |part| part["revision"] == 2).await;
    munich.send("decision", &story::decision_at("2019-04-18T18:30:00Z", "PENDING", None));
    munich.accept(&part);
    munich.send("decision", &consent_at("2019-04-18T18:35:00Z"));
    eventually("the decision", || async {
        let shown = decision_shown(&inspector).await;
        if shown == whole { Ok(()) } else { Err(format!("{shown:?}")) }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_removed_recipient_keeps_the_past_and_gets_nothing_new() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) =
        story::accepted_network(&world, network_to(&[BUYER, INSPECTOR])).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    munich.send("ua-data", &story::report_to(&[BUYER, INSPECTOR], "m0", 0, 3));
    story::value_is(&inspector, "3").await;

    story::put_network(&buyer, network_to(&[BUYER])).await;
    // The factory has not taken the revision yet; the platform's list narrows what it says.
    munich.send("ua-data", &story::report_to(&[BUYER, INSPECTOR], "m1", 1, 4));
    held(&admin, 2).await;
    assert_eq!(sequences(&inspector).await, [0]);
    assert_eq!(shown(&inspector).await, nothing());
    assert_eq!(sequences(&buyer).await, [0, 1]);
}

/// The cursor names a report by what its readers know of it; the place in the order of arrival counts
/// over the reports of all.
#[tokio::test(flavor = "multi_thread")]
async fn the_history_says_nothing_of_reports_to_others() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) =
        story::accepted_network(&world, network_to(&[BUYER, INSPECTOR])).await;
    for (sequence, recipient) in [(0, BUYER), (1, INSPECTOR), (2, BUYER)] {
        let id = format!("m{sequence}");
        munich.send("ua-data", &story::report_to(&[recipient], &id, sequence, 3));
    }
    held(&admin, 3).await;
    let page = async |after: &str| {
        let page = buyer.get(&format!("/reports?limit=1{after}")).await.expect_ok();
        let cursor = page["nextCursor"].as_str().map(str::to_owned);
        let report = &page["items"][0];
        assert_eq!(report["reportId"], Value::Null);
        (report["sequence"].clone(), cursor)
    };
    let cursor_of = |sequence: u32| format!("1-608926829-{sequence}-FOR_MUC");
    let (first, second) = (page("").await, page(&format!("&after={}", cursor_of(0))).await);
    assert_eq!(first, (json!(0), Some(cursor_of(0))));
    assert_eq!(second, (json!(2), Some(cursor_of(2))));
    assert_eq!(page(&format!("&after={}", cursor_of(2))).await, (Value::Null, None));
    // A report to another is no place to begin at, as one that never came.
    for unknown in [cursor_of(1), cursor_of(77)] {
        assert_eq!(page(&format!("&after={unknown}")).await, first, "{unknown}");
    }
    assert_eq!(buyer.get("/reports?after=2").await.status, 400);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_pending_field_shows_no_value() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("ua-data", &story::report("m0", 0, 3));
    story::value_is(&buyer, "3").await;
    for (state, time) in [("PENDING", "18:21:00"), ("REFUSED", "18:22:00")] {
        let time = format!("2019-04-18T{time}Z");
        munich.send("decision", &story::decision_at(&time, state, None));
        story::state_is(&buyer, state).await;
        assert_eq!(shown(&buyer).await, nothing(), "{state}");
    }
    // A straggler of the ended consent is history, and no current value; not even once the field
    // is open again.
    munich.send("ua-data", &story::report("m1", 1, 4));
    held(&admin, 2).await;
    assert_eq!(shown(&buyer).await, nothing());
    munich.send("decision", &story::decision_at("2019-04-18T18:30:00Z", "MAPPED", None));
    story::state_is(&buyer, "MAPPED").await;
    assert_eq!(shown(&buyer).await, nothing());
    assert_eq!(sequences(&buyer).await, [0, 1]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_revision_that_reopens_a_field_hides_its_value_at_once() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("ua-data", &story::report("m0", 0, 3));
    story::value_is(&buyer, "3").await;
    let mut network = story::network();
    network["name"] = json!("Another name");
    story::put_network(&buyer, network.clone()).await;
    assert_eq!(shown(&buyer).await, (json!("3"), true, json!(3.0)), "nothing else is asked");

    network["operationList"][0]["dynamicDataRequestList"][0]["purpose"] = json!("Sell it");
    story::put_network(&buyer, network).await;
    let view = buyer.get(&network_path()).await.expect_ok();
    assert_eq!(view["fields"][0]["mappingState"], "PENDING");
    assert_eq!(shown(&buyer).await, nothing());
}

#[tokio::test(flavor = "multi_thread")]
async fn live_values_go_to_those_to_whom_they_were_released() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    let view = inspector.get(&network_path()).await.expect_ok();
    let mut live = inspector.live(view["lastEventId"].as_str()).await;

    munich.send("ua-data", &story::report_to(&[BUYER, INSPECTOR], "m0", 0, 2));
    story::put_network(&buyer, network_to(&[BUYER, INSPECTOR])).await;
    munich.send("ua-data", &story::report_to(&[BUYER], "m1", 1, 3));
    held(&admin, 2).await;
    consent_again(&buyer, &munich, 2, "2019-04-18T18:30:00Z").await;
    munich.send("ua-data", &story::report_to(&[BUYER], "m2", 2, 4));
    munich.send("ua-data", &story::report_to(&[BUYER, INSPECTOR], "m3", 3, 5));
    let mut heard = BTreeSet::new();
    loop {
        let (_, name, event) = live.any().await;
        heard.insert(name.clone());
        if name == "value" {
            assert_eq!(event["fields"][0]["value"], "5", "the first value for the inspector");
            break;
        }
    }
    assert!(!heard.contains("progress"), "no progress of values that are not its own: {heard:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_tool_gets_only_what_its_organisation_may_see() {
    let world = World::start().await;
    let mut network = network_to(&[BUYER, INSPECTOR]);
    network["operationList"][0]["dynamicDataRequestList"][0]["dynamicDataRequestPublisherId"] =
        json!("Monitoring");
    let (admin, buyer, munich, _hamburg) = story::accepted_network(&world, network).await;
    let tool = json!({ "toolId": "Monitoring", "organisationId": BUYER, "name": "Monitoring" });
    admin.post("/tools", tool).await.expect_ok();
    let credential = admin.post("/tools/Monitoring/credentials", json!({})).await.expect_ok();
    let tool = Peer::tool(&credential, "Monitoring");
    munich.send("ua-data", &story::report_to(&[INSPECTOR], "m0", 0, 3));
    munich.send("ua-data", &story::report_to(&[BUYER], "m1", 1, 4));
    let forwarded = tool.receive("ua-data", |_| true).await;
    let payload = &forwarded["Messages"][0]["Payload"];
    assert_eq!(payload["progressStatus"]["Body"], "4", "{forwarded}");
    assert_eq!((tool.count("ua-data"), sequences(&buyer).await), (1, vec![1]));
}

/// Connectors of before did not say to whom they released a report.
#[tokio::test(flavor = "multi_thread")]
async fn a_report_without_recipients_is_for_those_of_the_consent() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    let reported_at = |sequence: u32, time: &str| {
        let mut report = story::former_report(&format!("m{sequence}"), sequence, 3);
        report["Messages"][0]["Timestamp"] = json!(time);
        report
    };
    munich.send("ua-data", &reported_at(0, "2019-04-18T18:20:30Z"));
    munich.send("ua-data", &reported_at(1, "2019-04-18T17:59:00Z"));
    held(&admin, 2).await;
    assert_eq!(sequences(&buyer).await, [0], "one is older than the consent");

    story::put_network(&buyer, network_to(&[BUYER, INSPECTOR])).await;
    let part = munich.receive("operation-network", |part| part["revision"] == 2).await;
    // A consent that was given to the former revision, and arrives after the new one.
    munich.send("decision", &story::decision_at("2019-04-18T18:25:00Z", "MAPPED", None));
    munich.send("ua-data", &reported_at(2, "2019-04-18T18:26:00Z"));
    munich.send("decision", &story::decision_at("2019-04-18T18:30:00Z", "PENDING", None));
    munich.accept(&part);
    munich.send("decision", &story::decision_at("2019-04-18T18:35:00Z", "MAPPED", None));
    munich.send("ua-data", &reported_at(3, "2019-04-18T18:34:00Z"));
    munich.send("ua-data", &reported_at(4, "2019-04-18T18:36:00Z"));
    held(&admin, 5).await;
    assert_eq!(sequences(&inspector).await, [4]);
    assert_eq!(sequences(&buyer).await, [0, 2, 3, 4]);
}

/// A list that is taken out on the way does not make the platform's own list decide.
#[tokio::test(flavor = "multi_thread")]
async fn a_report_without_recipients_is_for_nobody_once_its_factory_named_some() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("ua-data", &story::former_report("m0", 0, 3));
    held(&admin, 1).await;
    munich.send("ua-data", &story::report_to(&[BUYER], "m1", 1, 4));
    munich.send("ua-data", &story::former_report("m2", 2, 5));
    held(&admin, 3).await;
    // Neither another writer nor another epoch is one of a connector of before again.
    for (sequence, member) in [(3, "DataSetWriterId"), (4, "MetaDataVersion")] {
        let mut report = story::former_report(&format!("m{sequence}"), sequence, 6);
        report["Messages"][0][member] = match member {
            "DataSetWriterId" => json!(2),
            _ => json!({ "MajorVersion": 608_926_830, "MinorVersion": 608_926_830 }),
        };
        munich.send("ua-data", &report);
    }
    munich.send("ua-data", &story::report_to(&[BUYER], "m5", 5, 7));
    held(&admin, 4).await;
    assert_eq!(sequences(&buyer).await, [0, 1, 5]);
}

/// A consent that comes while a revision is under way is known to be to its recipients once the
/// factory has answered the revision.
#[tokio::test(flavor = "multi_thread")]
async fn a_consent_that_crosses_a_revision_counts_with_its_answer() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    let mut network = story::network();
    let requests = &mut network["operationList"][0]["dynamicDataRequestList"];
    let second = story::request("ReqResponse2", BUYER);
    requests.as_array_mut().expect("a list").push(second);
    story::put_network(&buyer, network.clone()).await;
    let part = munich.receive("operation-network", |part| part["revision"] == 2).await;
    munich.accept(&part);
    story::parts_are(&buyer, "ACCEPTED").await;

    network["name"] = json!("Another name");
    story::put_network(&buyer, network).await;
    let mut decision = story::decision_at("2019-04-18T18:10:00Z", "MAPPED", None);
    decision["dynamicDataRequestId"] = json!("ReqResponse2");
    munich.send("decision", &decision);
    let report = |sequence: u32| {
        let mut report = story::former_report(&format!("m{sequence}"), sequence, 3);
        report["Messages"][0]["Payload"]["dynamicDataRequestId"]["Body"] = json!("ReqResponse2");
        report
    };
    munich.send("ua-data", &report(0));
    held(&admin, 1).await;
    assert_eq!(sequences(&buyer).await, Vec::<u64>::new());
    let part = munich.receive("operation-network", |part| part["revision"] == 3).await;
    munich.accept(&part);
    story::part_is(&buyer, "FOR_MUC", "ACCEPTED").await;
    munich.send("ua-data", &report(1));
    held(&admin, 2).await;
    assert_eq!(sequences(&buyer).await, [1]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_withdrawn_network_shows_no_value() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("ua-data", &story::report("m0", 0, 3));
    story::value_is(&buyer, "3").await;
    buyer.delete(&network_path()).await.expect_ok();
    assert_eq!(shown(&buyer).await, nothing());
    // A report that was under way is history, and no current value.
    munich.send("ua-data", &story::report("m1", 1, 4));
    held(&admin, 2).await;
    assert_eq!(shown(&buyer).await, nothing());
    // Neither is it one once the network is in force again: nobody has consented since.
    story::put_network(&buyer, story::network()).await;
    story::state_is(&buyer, "PENDING").await;
    assert_eq!(shown(&buyer).await, nothing());
    assert_eq!(sequences(&buyer).await, [0, 1]);
}
