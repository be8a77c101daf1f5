//! Attempts of one member on what belongs to another, a row for each operation that changes
//! something.

use serde_json::{Value, json};

use super::Member;
use crate::{
    chain::{body, requests_path},
    harness::PASSWORD,
    story::{self, network_path},
};

/// Changes of documents of the chain that take something of `owner` for `author`.
fn takeovers(document: &Value, author: &Member, owner: &Member) -> Vec<Value> {
    let mut documents = Vec::new();
    let mut add = |change: &dyn Fn(&mut Value)| {
        let mut changed = document.clone();
        change(&mut changed);
        documents.push(changed);
    };
    for (index, operation) in document["operationList"].as_array().into_iter().flatten().enumerate()
    {
        if operation["owningFactoryId"] == owner.factory {
            for (name, value) in [
                ("name", json!("Taken")),
                ("owningFactoryId", json!(author.factory)),
                ("operationType", json!("PRODUCTION")),
                ("quantityUnit", json!("KGM")),
                ("operationId", json!("Renamed")),
            ] {
                // The drawer may propose a plan.
                if operation[name] != value && (name, author.id) != ("quantityUnit", "acme-aero") {
                    add(&|network| network["operationList"][index][name] = value.clone());
                }
            }
            add(&|network| {
                drop(network["operationList"].as_array_mut().expect("a list").remove(index))
            });
        }
        let requests = operation["dynamicDataRequestList"].as_array().into_iter().flatten();
        for (number, _) in requests.enumerate().filter(|(_, r)| r["requesterId"] == owner.id) {
            let list = |network: &mut Value| {
                std::mem::take(&mut network["operationList"][index]["dynamicDataRequestList"])
            };
            for (name, value) in [
                ("requesterId", json!(author.id)),
                ("recipientList", json!([owner.id, author.id])),
                ("purpose", json!("Taken")),
                ("dynamicDataRequestId", json!("Renamed")),
            ] {
                add(&|network| {
                    let mut requests = list(network);
                    requests[number][name] = value.clone();
                    network["operationList"][index]["dynamicDataRequestList"] = requests;
                });
            }
            add(&|network| {
                let mut requests = list(network);
                requests.as_array_mut().expect("a list").remove(number);
                network["operationList"][index]["dynamicDataRequestList"] = requests;
            });
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
            let documents =
                [chain, shown].into_iter().flat_map(|known| takeovers(known, author, owner));
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
            // Whose factory is asked has a part in the talk.
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
