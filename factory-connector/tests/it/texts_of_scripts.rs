//! Texts that scripts make of values: those who may not decide see them nowhere.

use serde_json::{Value, json};

use crate::{
    plant::{Plant, SignedIn, field},
    roles::{operations, person},
};

/// A text that scripts make, beside the value; their source, which everybody sees, does not have it.
const SECRET: &str = "sesame-4711";

/// Addresses of what never ends, or ends the session.
const LEFT_OUT: [&str; 2] = ["streamEvents", "signOut"];

/// Fields with a script each, by name: it throws an error with the value, or the text itself.
const FIELDS: [(&str, &str); 2] = [
    ("label", "(v) => { throw new Error(`sesame-${4700 + 11}` + v) }"),
    ("count", "(v) => { throw `sesame-${4700 + 11}` + v }"),
];

/// Returns a path with the parameters of a field.
fn filled(template: &str, name: &str) -> String {
    let parts = template.split('/').map(|part| match part {
        "{operationNetworkId}" => "frame",
        "{operationId}" => "MakeFrame",
        "{dynamicDataRequestId}" => "Req",
        "{fieldName}" => name,
        "{sourceId}" => "Mill1",
        part if part.starts_with('{') => "unknown",
        part => part,
    });
    parts.collect::<Vec<_>>().join("/")
}

/// Calls every operation about the fields, with an empty document where it takes one. Returns the number of
/// those that the person may use.
async fn calls(user: &SignedIn, role: &str) -> usize {
    let mut admitted = 0;
    let operations = operations();
    let operations =
        operations.iter().filter(|operation| !LEFT_OUT.contains(&operation.id.as_str()));
    for operation in operations {
        for (name, _) in FIELDS {
            let body = (operation.method != "GET").then(|| "{}".to_owned());
            let path = filled(&operation.template, name);
            let (status, text) = user.call(operation.method.clone(), &path, body).await;
            assert!(!text.contains(SECRET), "{} for a {role}: {status} {text}", operation.id);
            admitted += usize::from(status.is_success());
        }
    }
    admitted
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nobody_below_an_engineer_sees_what_a_script_throws() {
    let fields = json!([{ "name": "label", "type": 12 }, { "name": "count", "type": 9 }]);
    let plant = Plant::start(fields).await;
    let node = plant.node("Mill1", "Spindle.Temperature");
    let people = [
        ("VIEWER", person(&plant, "VIEWER").await),
        ("OPERATOR", person(&plant, "OPERATOR").await),
    ];
    for (name, source) in FIELDS {
        let mapping = json!({ "inputs": [{ "name": "a", "sourceId": "Mill1", "nodeId": node }],
            "steps": [{ "function": "script", "source": source }] });
        plant.map(name, mapping).await;
        let path = format!("{}/mapping-status", field(name));
        let is_shown = |status: &Value| status["lastFault"].to_string().contains(SECRET);
        plant.until("the engineer sees the text", &path, is_shown).await;
    }
    for (role, user) in people {
        let admitted = calls(&user, role).await;
        assert!(admitted > 40, "a {role} may use {admitted} of them only");
    }
}
