//! Attempts of one member on what belongs to another, a row for each operation that changes
//! something.

use serde_json::{Value, json};

use super::Member;
use crate::{
    chain::{body, ids, requests_path},
    harness::PASSWORD,
    story::{self, network_path},
};

/// Documents that name what the author does not see of the chain: all of it as it is, and each
/// hidden operation, request and relation put among what is shown. The changes of what is shown are
/// walked in [`super::places`].
fn grafts(chain: &Value, shown: &Value, owner: &Member) -> Vec<Value> {
    let mut documents = vec![chain.clone()];
    let mut put = |place: &str, element: &Value| {
        let mut document = shown.clone();
        if let Some(list) = document.pointer_mut(place).and_then(Value::as_array_mut) {
            list.push(element.clone());
            documents.push(document);
        }
    };
    let is_shown = |list: &str, member: &str, element: &Value| {
        ids(&shown[list], member).iter().any(|id| element[member] == id.as_str())
    };
    for operation in chain["operationList"].as_array().into_iter().flatten() {
        let is_owners = operation["owningFactoryId"] == owner.factory;
        if is_owners && !is_shown("operationList", "operationId", operation) {
            put("/operationList", operation);
        }
        for request in operation["dynamicDataRequestList"].as_array().into_iter().flatten() {
            let is_known = shown.to_string().contains(&request.to_string());
            if request["requesterId"] == owner.id && !is_known {
                let count = shown["operationList"].as_array().expect("operations").len();
                for index in 0..count {
                    put(&format!("/operationList/{index}/dynamicDataRequestList"), request);
                }
            }
        }
    }
    for relation in chain["operationRelationList"].as_array().into_iter().flatten() {
        if !is_shown("operationRelationList", "operationRelationId", relation) {
            put("/operationRelationList", relation);
        }
    }
    documents
}

/// Ids of a member's requests in the chain, with their operations and factories.
fn requests_of(chain: &Value, owner: &Member) -> Vec<(String, String, Value)> {
    let operations = chain["operationList"].as_array().expect("a list");
    let mut found = Vec::new();
    for operation in operations {
        for request in operation["dynamicDataRequestList"].as_array().into_iter().flatten() {
            if request["requesterId"] == owner.id {
                let text = |value: &Value| value.as_str().expect("a text").to_owned();
                found.push((
                    text(&operation["operationId"]),
                    text(&request["dynamicDataRequestId"]),
                    operation["owningFactoryId"].clone(),
                ));
            }
        }
    }
    found
}

/// Attempts of `author` with an operation against what is `owner`'s: paths and bodies.
pub fn attempts(
    operation: &str,
    author: &Member,
    owner: &Member,
    chain: &Value,
    shown: &Value,
) -> Vec<(String, Option<Value>)> {
    let one = |path: String, body: Value| vec![(path, Some(body))];
    let bare = |path: String| vec![(path, None)];
    match operation {
        "POST /organisations" => {
            one("/organisations".into(), json!({ "organisationId": "new", "name": "new" }))
        }
        "PUT /users/{userName}" => one(
            format!("/users/{}-planner", owner.id),
            json!({ "password": PASSWORD, "role": "PLANNER", "organisationId": author.id }),
        ),
        "DELETE /users/{userName}" => bare(format!("/users/{}-planner", owner.id)),
        "DELETE /tools/{toolId}" => bare(format!("/tools/{}", owner.tool())),
        "DELETE /factories/{factoryId}" => bare(format!("/factories/{}", owner.factory)),
        "DELETE /organisations/{organisationId}" => bare(format!("/organisations/{}", owner.id)),
        "DELETE /collaborations/{collaborationId}" => bare("/collaborations/order".into()),
        "DELETE /collaborations/{collaborationId}/members/{organisationId}" => {
            bare(format!("/collaborations/order/members/{}", owner.id))
        }
        "DELETE /collaborations/{collaborationId}/factories/{factoryId}" => {
            bare(format!("/collaborations/order/factories/{}", owner.factory))
        }
        "DELETE /users/{userName}/second-factor" => {
            bare(format!("/users/{}-planner/second-factor", owner.id))
        }
        "DELETE /users/{userName}/sessions/{sessionId}" => {
            bare(format!("/users/{}-planner/sessions/0123456789abcdef", owner.id))
        }
        "DELETE /sessions/{sessionId}" => bare("/sessions/0123456789abcdef".into()),
        "POST /factories" => one(
            "/factories".into(),
            json!({ "factoryId": "NEW", "organisationId": owner.id, "name": "new" }),
        ),
        "POST /factories/{factoryId}/enrolment-tokens" => {
            one(format!("/factories/{}/enrolment-tokens", owner.factory), json!({}))
        }
        "DELETE /factories/{factoryId}/credentials" => {
            bare(format!("/factories/{}/credentials", owner.factory))
        }
        "POST /factories/{factoryId}/lease/handovers" => one(
            format!("/factories/{}/lease/handovers", owner.factory),
            json!({ "instanceId": "b" }),
        ),
        "POST /tools" => one(
            "/tools".into(),
            json!({ "toolId": "NEW", "organisationId": owner.id, "name": "new" }),
        ),
        "POST /tools/{toolId}/credentials" => {
            one(format!("/tools/{}/credentials", owner.tool()), json!({}))
        }
        "DELETE /tools/{toolId}/credentials" => {
            bare(format!("/tools/{}/credentials", owner.tool()))
        }
        "POST /collaborations" => one(
            "/collaborations".into(),
            json!({ "collaborationId": "new", "name": "new", "members": [owner.id] }),
        ),
        "PUT /collaborations/{collaborationId}/members/{organisationId}" => {
            one("/collaborations/order/members/stranger".into(), json!({}))
        }
        "PUT /collaborations/{collaborationId}/factories/{factoryId}" => {
            one(format!("/collaborations/order/factories/{}", owner.factory), json!({}))
        }
        "POST /dead-letters/{deadLetterId}/replay" => {
            one("/dead-letters/ingest-1/replay".into(), json!({}))
        }
        _ => in_networks(operation, author, owner, chain, shown),
    }
}

/// Attempts in the networks of the owner and of all.
fn in_networks(
    operation: &str,
    author: &Member,
    owner: &Member,
    chain: &Value,
    shown: &Value,
) -> Vec<(String, Option<Value>)> {
    let one = |path: String, body: Value| vec![(path, Some(body))];
    let bare = |path: String| vec![(path, None)];
    let asked = requests_of(chain, owner);
    match operation {
        "PUT /operation-networks/{operationNetworkId}" => {
            let mut taken = author.document();
            taken["operationNetworkId"] = json!(owner.network());
            let mut all = one(owner.path(), body(owner.document()));
            all.push((owner.path(), Some(body(taken))));
            let documents = grafts(chain, shown, owner).into_iter();
            all.extend(documents.map(|document| (network_path(), Some(body(document)))));
            all
        }
        "DELETE /operation-networks/{operationNetworkId}" => {
            let mut all = bare(owner.path());
            if owner.id == "acme-aero" {
                all.push((network_path(), None));
            }
            all
        }
        "POST /operation-networks/{operationNetworkId}/operations/{operationId}/requests" => {
            let own = format!("{}/operations/Own/requests", owner.path());
            let mut all = one(own.clone(), author.request());
            all.push((own, Some(owner.request())));
            for at in ["MakeFrame1", "InspectFrame1", "ShipFrame1"] {
                all.push((requests_path(at), Some(story::request("New", owner.id))));
                for (_, id, _) in &asked {
                    all.push((requests_path(at), Some(story::request(id, author.id))));
                }
            }
            all
        }
        "DELETE /operation-networks/{operationNetworkId}/operations/{operationId}/requests/{dynamicDataRequestId}" =>
        {
            let mut all =
                bare(format!("{}/operations/Own/requests/Req-{}", owner.path(), owner.id));
            all.extend(
                asked.iter().map(|(at, id, _)| (format!("{}/{id}", requests_path(at)), None)),
            );
            all
        }
        "POST /operation-networks/{operationNetworkId}/comments" => {
            let about = |factory: &Value, request: &str| {
                Some(
                    json!({ "factoryId": factory, "dynamicDataRequestId": request, "text": "psst" }),
                )
            };
            let request = format!("Req-{}", owner.id);
            let mut all = vec![(
                format!("{}/comments", owner.path()),
                about(&json!(owner.factory), &request),
            )];
            // Whose factory is asked has a part in the comments.
            for (_, id, factory) in asked.iter().filter(|(_, _, factory)| factory != author.factory)
            {
                all.push((format!("{}/comments", network_path()), about(factory, id)));
            }
            if author.id != "acme-aero" {
                let body = json!({ "factoryId": owner.factory, "text": "psst" });
                all.push((format!("{}/comments", network_path()), Some(body)));
            }
            all
        }
        other => panic!("{other} has no row: what may one member do to another with it?"),
    }
}
