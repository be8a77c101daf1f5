//! A small frame order: a buyer, a maker, an inspector, and a stranger without a part in it.

use serde_json::{Value, json};

use crate::{
    connector::Peer,
    harness::{Api, World, eventually},
};

pub const NETWORK: &str = "frame-4711";

/// Organisations, factories, users and a collaboration.
pub async fn set_up(world: &World) -> Api {
    let admin = world.admin().await;
    for id in ["acme-aero", "frames-munich", "inspect-hamburg", "stranger"] {
        admin.post("/organisations", json!({ "organisationId": id, "name": id })).await.expect_ok();
        for role in ["PLANNER", "VIEWER"] {
            let user = format!("/users/{id}-{}", role.to_lowercase());
            let body =
                json!({ "password": crate::harness::PASSWORD, "role": role, "organisationId": id });
            admin.put(&user, body).await.expect_ok();
        }
    }
    for (factory, owner) in [("FOR_MUC", "frames-munich"), ("INS_HAM", "inspect-hamburg")] {
        let body = json!({ "factoryId": factory, "organisationId": owner, "name": factory });
        admin.post("/factories", body).await.expect_ok();
    }
    let collaboration = json!({ "collaborationId": "order", "name": "Frame order",
        "members": ["acme-aero", "frames-munich", "inspect-hamburg"], "factories": ["FOR_MUC", "INS_HAM"] });
    admin.post("/collaborations", collaboration).await.expect_ok();
    admin
}

pub async fn planner(world: &World, organisation: &str) -> Api {
    world.sign_in(&format!("{organisation}-planner"), crate::harness::PASSWORD).await
}

pub fn request(id: &str, requester: &str) -> Value {
    json!({ "dynamicDataRequestId": id, "requesterId": requester, "recipientList": [requester],
        "purpose": "Plan the final assembly", "reportDataFormat": { "reportName": "ProgressReport",
        "reportFieldList": [
            { "name": "progressStatus", "unit": "PIECE", "type": 9, "semantic": "PRODUCED_QUANTITY" },
            { "name": "note", "type": 12 } ] } })
}

pub fn request_of_tool(id: &str, requester: &str, tool: &str) -> Value {
    let mut request = request(id, requester);
    request["dynamicDataRequestPublisherId"] = json!(tool);
    request
}

pub fn network() -> Value {
    json!({ "operationNetworkId": NETWORK, "name": "Frame order 4711", "operationList": [
        { "operationId": "MakeFrame1", "operationType": "PRODUCTION", "owningFactoryId": "FOR_MUC",
          "plannedQuantity": 12, "quantityUnit": "PIECE",
          "dynamicDataRequestList": [request("ReqResponse1", "acme-aero")] },
        { "operationId": "InspectFrame1", "operationType": "INSPECTION", "owningFactoryId": "INS_HAM" } ],
      "operationRelationList": [ { "operationRelationId": "rel1", "relationType": "FINISH_TO_START",
        "predecessorOperationId": "MakeFrame1", "successorOperationId": "InspectFrame1" } ] })
}

pub fn network_path() -> String {
    format!("/operation-networks/{NETWORK}")
}

pub async fn put_network(api: &Api, network: Value) -> Value {
    api.put(&network_path(), json!({ "collaborationId": "order", "operationNetwork": network }))
        .await
        .expect_ok()
}

/// A report of FOR_MUC as the wire contract shows it, released to the buyer.
pub fn report(message_id: &str, sequence: u32, value: u64) -> Value {
    report_to(&["acme-aero"], message_id, sequence, value)
}

/// A report of FOR_MUC, released to these organisations.
pub fn report_to(recipients: &[&str], message_id: &str, sequence: u32, value: u64) -> Value {
    let mut report = former_report(message_id, sequence, value);
    report["Messages"][0]["Payload"]["recipientList"] = json!({ "Type": 12, "Body": recipients });
    report
}

/// A report as connectors sent it before reports said to whom they were released.
pub fn former_report(message_id: &str, sequence: u32, value: u64) -> Value {
    json!({ "MessageId": message_id, "MessageType": "ua-data", "PublisherId": "FOR_MUC",
      "Messages": [data_set_message(sequence, value)] })
}

/// A report's DataSetMessage without recipients.
pub fn data_set_message(sequence: u32, value: u64) -> Value {
    json!({ "DataSetWriterId": 1, "SequenceNumber": sequence,
        "MetaDataVersion": { "MajorVersion": 608_926_829, "MinorVersion": 608_926_829 },
        "Timestamp": "2019-04-18T18:20:30Z",
        "Payload": {
          "reportName": { "Type": 12, "Body": "ProgressReport" },
          "dynamicDataRequestId": { "Type": 12, "Body": "ReqResponse1" },
          "operationId": { "Type": 12, "Body": "MakeFrame1" },
          "operationNetworkId": { "Type": 12, "Body": NETWORK },
          "shopfloorTimestamp": { "Type": 13, "Body": "2019-04-18T18:20:05Z" },
          "progressStatus": { "Type": 9, "Body": value.to_string() },
          "progressStatusUnit": { "Type": 12, "Body": "PIECE" } } })
}

/// A decision of FOR_MUC, made before the reports.
pub fn decision(state: &str, reason: Option<&str>) -> Value {
    decision_at("2019-04-18T18:00:00Z", state, reason)
}

/// A decision of FOR_MUC, made at a time.
pub fn decision_at(time: &str, state: &str, reason: Option<&str>) -> Value {
    json!({ "messageType": "decision", "messageId": platform::clock::new_message_id(), "factoryId": "FOR_MUC",
        "operationNetworkId": NETWORK, "operationId": "MakeFrame1", "dynamicDataRequestId": "ReqResponse1",
        "fieldName": "progressStatus", "mappingState": state, "reason": reason,
        "decidedAt": time })
}

/// The story up to the first field being open to the buyer.
pub async fn accepted(world: &World) -> (Api, Api, Peer, Peer) {
    accepted_network(world, network()).await
}

/// The story with a network of its own, up to its first field being open.
pub async fn accepted_network(world: &World, network: Value) -> (Api, Api, Peer, Peer) {
    let admin = set_up(world).await;
    let buyer = planner(world, "acme-aero").await;
    let munich = Peer::enrolled(world, &admin, "FOR_MUC").await;
    let hamburg = Peer::enrolled(world, &admin, "INS_HAM").await;
    put_network(&buyer, network).await;
    for peer in [&munich, &hamburg] {
        let part = peer.receive("operation-network", |_| true).await;
        peer.accept(&part);
    }
    parts_are(&buyer, "ACCEPTED").await;
    munich.send("decision", &decision("MAPPED", None));
    state_is(&buyer, "MAPPED").await;
    (admin, buyer, munich, hamburg)
}

/// Waits until `progressStatus` is in a state.
pub async fn state_is(api: &Api, state: &str) -> Value {
    first_field(api, "mappingState", state).await
}

/// Waits until all parts are in a state.
pub async fn parts_are(api: &Api, state: &str) -> Value {
    eventually(state, || async {
        let view = api.get(&network_path()).await.expect_ok();
        let parts = view["parts"].as_array().cloned().unwrap_or_default();
        if parts.iter().all(|part| part["state"] == state) {
            Ok(view)
        } else {
            Err(view["parts"].to_string())
        }
    })
    .await
}

/// Waits until the part of one factory is in a state.
pub async fn part_is(api: &Api, factory: &str, state: &str) {
    eventually(state, || async {
        let view = api.get(&network_path()).await.expect_ok();
        let parts = view["parts"].as_array().cloned().unwrap_or_default();
        let is_there = |part: &Value| part["factoryId"] == factory && part["state"] == state;
        if parts.iter().any(is_there) { Ok(()) } else { Err(view["parts"].to_string()) }
    })
    .await;
}

/// Waits until the buyer sees a value of `progressStatus`.
pub async fn value_is(api: &Api, value: &str) -> Value {
    first_field(api, "value", value).await
}

/// Waits until a member of `progressStatus` has a value, and returns the network.
async fn first_field(api: &Api, member: &str, value: &str) -> Value {
    eventually(member, || async {
        let view = api.get(&network_path()).await.expect_ok();
        let field = view["fields"]
            .as_array()
            .and_then(|fields| fields.first())
            .cloned()
            .unwrap_or_default();
        if field[member] == value { Ok(view) } else { Err(field.to_string()) }
    })
    .await
}
