//! Unusable messages become dead letters with a reason; all others are processed.

use reqwest::Method;
use serde_json::{Value, json};

use crate::{
    harness::{Api, World, eventually},
    story,
};

async fn dead_letter(admin: &Api, code: &str) -> Value {
    eventually(code, || async {
        let letters = admin.get("/dead-letters").await.expect_ok();
        let letters = letters["items"].as_array().cloned().unwrap_or_default();
        letters
            .iter()
            .find(|letter| letter["code"] == code)
            .cloned()
            .ok_or_else(|| format!("{letters:?}"))
    })
    .await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_forged_publisher_is_rejected_and_counted() {
    let world = World::start().await;
    let (admin, buyer, munich, hamburg) = story::accepted(&world).await;
    hamburg.send("ua-data", &story::report("forged", 0, 99));
    let letter = dead_letter(&admin, "FORGED_PUBLISHER").await;
    assert_eq!(letter["address"], "factory.INS_HAM.ingress");
    let metrics = world.handle().application.metrics.render();
    assert!(metrics.contains("verbund_forged_messages_total{factory=\"INS_HAM\"}"), "{metrics}");

    // Its own name, but another factory's request.
    let mut foreign = story::report("foreign", 0, 98);
    foreign["PublisherId"] = json!("INS_HAM");
    hamburg.send("ua-data", &foreign);
    dead_letter(&admin, "FOREIGN_REQUEST").await;

    munich.send("ua-data", &story::report("true", 0, 3));
    story::value_is(&buyer, "3").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn invalid_messages_delay_no_others() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send_bytes("ua-data", None, b"not JSON");
    munich.send_bytes("ua-data", None, "[".repeat(200_000).as_bytes());
    munich.send_bytes("decision", None, br#"{"messageType":"decision"}"#);
    munich.send("ua-data", &story::report("m1", 0, 3));
    story::value_is(&buyer, "3").await;
    let letter = dead_letter(&admin, "INVALID_MESSAGE").await;
    assert!(letter["reason"].as_str().is_some_and(|reason| reason.len() > 20), "{letter}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_dead_letter_can_be_tried_again() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    // A comment on a network that does not exist yet is of no use - until it does.
    munich.send(
        "comment",
        &json!({ "messageType": "comment", "messageId": "early", "factoryId": "FOR_MUC",
        "operationNetworkId": "later", "authorId": "engineer", "text": "Too early." }),
    );
    let letter = dead_letter(&admin, "UNKNOWN_NETWORK").await;
    let mut network = story::network();
    network["operationNetworkId"] = json!("later");
    let body = json!({ "collaborationId": "order", "operationNetwork": network });
    buyer.put("/operation-networks/later", body).await.expect_ok();

    let replay = format!("/dead-letters/{}/replay", letter["id"].as_str().expect("an id"));
    assert_eq!(admin.post(&replay, json!({})).await.expect_ok()["isTaken"], true);
    let comments = buyer.get("/operation-networks/later/comments").await.expect_ok();
    assert_eq!(comments["items"][0]["text"], "Too early.");
    buyer.post(&replay, json!({})).await.expect_problem(403, "FORBIDDEN");
    admin.post("/dead-letters/ingest-999/replay", json!({})).await.expect_problem(404, "NOT_FOUND");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_network_with_faults_is_refused_with_all_of_them() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let buyer = story::planner(&world, "acme-aero").await;
    let mut network = story::network();
    network["operationList"][0]["owningFactoryId"] = json!("NOBODY");
    network["operationList"][0]["dynamicDataRequestList"][0]["recipientList"] = json!(["stranger"]);
    network["operationRelationList"][0]["successorOperationId"] = json!("Missing");
    let body = json!({ "collaborationId": "order", "operationNetwork": network });
    let problem =
        buyer.put(&story::network_path(), body).await.expect_problem(422, "INVALID_DOCUMENT");
    let pointers: Vec<&str> = problem["faults"]
        .as_array()
        .expect("faults")
        .iter()
        .filter_map(|fault| fault["pointer"].as_str())
        .collect();
    assert!(
        pointers.iter().all(|pointer| pointer.starts_with("/operationNetwork/operation")),
        "{pointers:?}"
    );
    buyer.get(&story::network_path()).await.expect_problem(404, "NOT_FOUND");

    // Requests are made in the own name, and viewers change nothing.
    let maker = story::planner(&world, "frames-munich").await;
    let body = json!({ "collaborationId": "order", "operationNetwork": story::network() });
    let problem = maker
        .put(&story::network_path(), body.clone())
        .await
        .expect_problem(422, "INVALID_DOCUMENT");
    assert_eq!(problem["faults"][0]["code"], "FOREIGN_REQUESTER");
    let viewer = world.sign_in("acme-aero-viewer", crate::harness::PASSWORD).await;
    viewer.put(&story::network_path(), body.clone()).await.expect_problem(403, "FORBIDDEN");

    // Two planners at once: the second gets a conflict.
    story::put_network(&admin, story::network()).await;
    let answer = admin
        .client
        .request(Method::PUT, &format!("/api/v1{}", story::network_path()))
        .header("if-match", "\"7\"")
        .json(&body)
        .send()
        .await
        .expect("an answer");
    assert_eq!(answer.status(), 409);
}
