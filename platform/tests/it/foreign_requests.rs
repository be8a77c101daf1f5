//! A factory writes only under requests that it has or had.

use serde_json::{Value, json};

use crate::{
    connector::Peer,
    harness::{Api, World, eventually},
    story::{self, NETWORK},
};

const LATER: &str = "ReqLater";

/// A report of INS_HAM under a request of the frame order.
fn report_of_hamburg(message_id: &str, request: &str) -> Value {
    let mut report = story::report(message_id, 0, 666);
    report["PublisherId"] = json!("INS_HAM");
    report["Messages"][0]["Payload"]["dynamicDataRequestId"]["Body"] = json!(request);
    report
}

/// The reasons of the dead letters of foreign requests, once there are as many.
async fn refused(admin: &Api, count: usize) -> Vec<Value> {
    eventually("dead letters", || async {
        let letters = admin.get("/dead-letters").await.expect_ok();
        let letters = letters["items"].as_array().cloned().unwrap_or_default();
        let foreign = letters.into_iter().filter(|letter| letter["code"] == "FOREIGN_REQUEST");
        let foreign: Vec<Value> = foreign.map(|letter| letter["subject"].clone()).collect();
        if foreign.len() == count { Ok(foreign) } else { Err(format!("{foreign:?}")) }
    })
    .await
}

async fn reports(api: &Api) -> Value {
    api.get("/reports").await.expect_ok()["items"].clone()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_foreign_factory_writes_no_history_not_even_in_advance() {
    let world = World::start().await;
    let (admin, buyer, _munich, hamburg) = story::accepted(&world).await;
    // Under an id that comes later, and under a request of Munich.
    hamburg.send("ua-data", &report_of_hamburg("early", LATER));
    refused(&admin, 1).await;
    let mut next = report_of_hamburg("foreign", "ReqResponse1");
    next["Messages"][0]["SequenceNumber"] = json!(1);
    hamburg.send("ua-data", &next);
    refused(&admin, 2).await;
    let path = format!("/operation-networks/{NETWORK}/operations/MakeFrame1/requests");
    buyer.post(&path, story::request(LATER, "acme-aero")).await.expect_ok();
    assert_eq!(reports(&buyer).await, json!([]));

    // The numbers count as taken: a connector that was wrong does not send them for ever.
    let receipt = hamburg
        .receive("receipt", |receipt| receipt["receiptList"][0]["throughSequence"] == 1)
        .await;
    assert_eq!(receipt["receiptList"][0]["missingList"], json!([]));
    // Sent again, they are repeats.
    hamburg.send("ua-data", &report_of_hamburg("again", LATER));
    eventually("a repeat", || async {
        let writers = admin.get("/factories/INS_HAM/writers").await.expect_ok();
        let repeats = writers["items"][0]["duplicates"].clone();
        if repeats == 1 { Ok(()) } else { Err(writers.to_string()) }
    })
    .await;
    refused(&admin, 2).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn decisions_and_comments_on_foreign_requests_are_dead_letters() {
    let world = World::start().await;
    let (admin, buyer, munich, hamburg) = story::accepted(&world).await;
    let mut decision = story::decision_at("2019-04-18T19:00:00Z", "REFUSED", Some("Not me."));
    decision["factoryId"] = json!("INS_HAM");
    hamburg.send("decision", &decision);
    let comment = json!({ "messageType": "comment", "messageId": "c1", "factoryId": "INS_HAM",
        "operationNetworkId": NETWORK, "dynamicDataRequestId": "ReqResponse1",
        "authorId": "engineer", "text": "Hello." });
    hamburg.send("comment", &comment);
    let mut subjects = refused(&admin, 2).await;
    subjects.sort_by_key(Value::to_string);
    assert_eq!(subjects, ["comment", "decision"]);
    story::state_is(&buyer, "MAPPED").await;
    munich.send("ua-data", &story::report("m0", 0, 3));
    story::value_is(&buyer, "3").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_under_way_when_a_request_moves_or_ends_is_history() {
    let world = World::start().await;
    let (admin, buyer, munich, hamburg) = story::accepted(&world).await;
    // An administrator gives the operation to Hamburg, with the request.
    let mut network = story::network();
    network["operationList"][0]["owningFactoryId"] = json!("INS_HAM");
    story::put_network(&admin, network).await;
    let view = story::state_is(&buyer, "PENDING").await;
    assert_eq!(view["fields"][0]["factoryId"], "INS_HAM");
    munich.send("ua-data", &story::report("m0", 0, 3));
    held_reports(&buyer, 1).await;
    let part = hamburg.receive("operation-network", |part| part["revision"] == 2).await;
    hamburg.accept(&part);
    let mut decision = story::decision_at("2019-04-18T19:00:00Z", "MAPPED", None);
    decision["factoryId"] = json!("INS_HAM");
    hamburg.send("decision", &decision);
    let view = story::state_is(&buyer, "MAPPED").await;
    assert_eq!(view["fields"][0]["value"], Value::Null, "Munich's value is not Hamburg's");

    buyer.delete(&story::network_path()).await.expect_ok();
    send_of_hamburg(&hamburg);
    held_reports(&buyer, 2).await;
    refused(&admin, 0).await;
}

fn send_of_hamburg(hamburg: &Peer) {
    hamburg.send("ua-data", &report_of_hamburg("h0", "ReqResponse1"));
}

async fn held_reports(api: &Api, count: usize) {
    eventually("the reports", || async {
        let found = reports(api).await;
        if found.as_array().map_or(0, Vec::len) == count { Ok(()) } else { Err(found.to_string()) }
    })
    .await;
}
