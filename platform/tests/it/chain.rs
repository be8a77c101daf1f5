//! A longer frame order: a buyer that drew it, and three members that perform its operations in a
//! chain, so that the first and the last are no neighbours.

use serde_json::{Value, json};

use crate::{
    connector::Peer,
    harness::{Api, PASSWORD, World},
    story::{self, NETWORK},
};

/// The member at the end of the chain.
pub const CARRIER: &str = "freight-bremen";
pub const CARRIER_FACTORY: &str = "FRE_BRE";
pub const MEMBERS: [&str; 4] = ["acme-aero", "frames-munich", "inspect-hamburg", CARRIER];

/// Adds the carrier to the order, and draws the chain as the buyer.
pub async fn drawn(world: &World) -> Api {
    let admin = story::set_up(world).await;
    admin
        .post("/organisations", json!({ "organisationId": CARRIER, "name": CARRIER }))
        .await
        .expect_ok();
    for role in ["PLANNER", "VIEWER"] {
        let user = format!("/users/{CARRIER}-{}", role.to_lowercase());
        let body = json!({ "password": PASSWORD, "role": role, "organisationId": CARRIER });
        admin.put(&user, body).await.expect_ok();
    }
    let body = json!({ "factoryId": CARRIER_FACTORY, "organisationId": CARRIER, "name": "Bremen" });
    admin.post("/factories", body).await.expect_ok();
    for path in [format!("members/{CARRIER}"), format!("factories/{CARRIER_FACTORY}")] {
        admin.put(&format!("/collaborations/order/{path}"), json!({})).await.expect_ok();
    }
    let buyer = story::planner(world, "acme-aero").await;
    story::put_network(&buyer, network()).await;
    // The inspector asks the maker as well, which is nobody else's business.
    let inspector = story::planner(world, "inspect-hamburg").await;
    let path = requests_path("MakeFrame1");
    inspector.post(&path, story::request("AskedByHamburg", "inspect-hamburg")).await.expect_ok();
    admin
}

/// Make in Munich, inspect in Hamburg, ship from Bremen.
pub fn network() -> Value {
    let mut network = story::network();
    network["operationList"][0]["plannedStart"] = json!("2026-01-05T06:00:00Z");
    network["operationList"][0]["plannedEnd"] = json!("2026-01-09T14:00:00Z");
    network["operationList"][1]["name"] = json!("Inspect the frame");
    network["operationList"][1]["plannedStart"] = json!("2026-01-10T06:00:00Z");
    network["operationList"][1]["plannedQuantity"] = json!(12);
    network["operationList"].as_array_mut().expect("a list").push(json!({
        "operationId": "ShipFrame1", "operationType": "TRANSPORTATION", "owningFactoryId": CARRIER_FACTORY,
        "destination": "Bremen quay",
        "dynamicDataRequestList": [story::request("ShipRequest", "acme-aero")] }));
    network["operationRelationList"].as_array_mut().expect("a list").push(json!({
        "operationRelationId": "rel2", "relationType": "FINISH_TO_START",
        "predecessorOperationId": "InspectFrame1", "successorOperationId": "ShipFrame1" }));
    network
}

pub fn requests_path(operation: &str) -> String {
    format!("/operation-networks/{NETWORK}/operations/{operation}/requests")
}

/// Body that puts a network.
pub fn body(network: Value) -> Value {
    json!({ "collaborationId": "order", "operationNetwork": network })
}

/// The network as a member sees it, ready to be changed and put again.
pub async fn seen(api: &Api) -> Value {
    api.get(&story::network_path()).await.expect_ok()["network"].clone()
}

/// The operation with this id in a document.
pub fn operation<'a>(network: &'a mut Value, id: &str) -> &'a mut Value {
    let list = network["operationList"].as_array_mut().expect("a list");
    list.iter_mut().find(|operation| operation["operationId"] == id).expect("the operation")
}

/// Ids of a list's elements, by the name of their member.
pub fn ids(list: &Value, member: &str) -> Vec<String> {
    let elements = list.as_array().cloned().unwrap_or_default();
    elements.iter().filter_map(|element| element[member].as_str().map(str::to_owned)).collect()
}

/// Pairs of code and pointer of a refusal, in their order.
#[track_caller]
pub fn faults(answer: crate::harness::Answer) -> Vec<(String, String)> {
    let problem = answer.expect_problem(422, "INVALID_DOCUMENT");
    let faults = problem["faults"].as_array().expect("faults");
    let text = |fault: &Value, name: &str| fault[name].as_str().expect("a text").to_owned();
    faults
        .iter()
        .map(|fault| {
            let pointer = text(fault, "pointer");
            let pointer = pointer.strip_prefix("/operationNetwork").unwrap_or(&pointer).to_owned();
            (text(fault, "code"), pointer)
        })
        .collect()
}

/// The connector of the maker, which has accepted its part.
pub async fn munich(world: &World, admin: &Api) -> Peer {
    let munich = Peer::enrolled(world, admin, "FOR_MUC").await;
    let part = munich.receive("operation-network", |part| part["revision"] == 2).await;
    munich.accept(&part);
    munich
}
