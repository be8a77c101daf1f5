//! Every kind of message, by the examples of the wire contract, turned against things of others.
//! A kind without an example, or without a row here, fails the test.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use asi_model::messages::FactoryMessage;
use serde_json::{Value, json};
use utoipa::PartialSchema;

/// A document of the contract that is no message.
const NO_MESSAGE: &str = "network";
/// Kind of a data set message that has no values.
const KEEP_ALIVE: &str = "ua-keepalive";
/// Kinds besides those of the schemas: what a tool asks, and what a later version may send.
const FURTHER: [&str; 2] = ["data-request", "ua-connection"];

/// An example of a message.
pub struct Example {
    /// The message type, and what tells examples of it apart: `ua-data/ua-keepalive`.
    pub kind: String,
    pub body: Value,
}

/// Returns what happens to a message with its sender's name that is about something of others: the
/// codes that its dead letter may have; none where it speaks of the sender's own alone.
pub fn refusals(kind: &str) -> &'static [&'static str] {
    match kind {
        "acknowledgement" | "decision/asset" | "gap" | "asset-offer" | "lease-request"
        | "receipt-request" => &[],
        "decision" | "revocation" | "past-release" => &["FOREIGN_REQUEST"],
        "comment" => &["FOREIGN_REQUEST", "UNKNOWN_NETWORK"],
        "ledger-checkpoint" => &["INVALID_CHECKPOINT"],
        "operation-network" | "withdraw" | "asset-request" | "receipt" | "lease"
        | "ledger-cosignature" | "data-request" => &["INVALID_MESSAGE"],
        "ua-data/ua-keyframe" | "ua-data/ua-deltaframe" | "ua-data/ua-event" => {
            &["FOREIGN_REQUEST", "NO_REQUEST"]
        }
        "ua-data/ua-keepalive" | "ua-metadata" | "ua-status" | "ua-connection" => &[],
        other => panic!("{other} has no row: what becomes of it where it is about others?"),
    }
}

/// Returns what happens to a message in the name of another factory.
pub fn forged(kind: &str) -> &'static [&'static str] {
    match refusals(kind) {
        ["INVALID_MESSAGE"] => &["INVALID_MESSAGE"],
        _ if kind == "ua-connection" => &[],
        _ => &["FORGED_PUBLISHER"],
    }
}

/// Reads the examples of all kinds.
pub fn examples() -> Vec<Example> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../asi-model/examples");
    let mut examples = Vec::new();
    let mut known = BTreeSet::new();
    for entry in std::fs::read_dir(folder).expect("the examples of the contract") {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("a text");
        let body: Value = serde_json::from_str(&text).expect("JSON");
        let kind = body["messageType"].as_str().or(body["MessageType"].as_str());
        let kind = kind.expect("a message").to_owned();
        known.insert(kind.clone());
        let Some(parts) = body["Messages"].as_array().map(Vec::len) else {
            let is_of_asset = kind == "decision" && body["assetId"].is_string();
            let kind = if is_of_asset { format!("{kind}/asset") } else { kind };
            examples.push(Example { kind, body });
            continue;
        };
        // Only a keep-alive is without a payload.
        let is_empty = body["Messages"][0]["Payload"].is_null();
        for of_part in data_set_kinds().into_iter().filter(|of| !is_empty || of == KEEP_ALIVE) {
            let mut body = body.clone();
            for index in 0..parts {
                body["Messages"][index]["MessageType"] = json!(of_part);
            }
            examples.push(Example { kind: format!("{kind}/{of_part}"), body });
        }
    }
    for kind in FURTHER {
        let name = if kind.starts_with("ua-") { "MessageType" } else { "messageType" };
        let body = json!({ name: kind, "PublisherId": "", "factoryId": "", "messageId": "",
            "MessageId": "" });
        examples.push(Example { kind: kind.to_owned(), body });
    }
    let schemas = asi_model::schema::all();
    let kinds = schemas.iter().map(|(_, schema)| schema["$id"].as_str().expect("an id"));
    let kinds = kinds.map(|id| id.rsplit(':').next().expect("a name").to_owned());
    let kinds: BTreeSet<_> =
        kinds.filter(|kind| kind != NO_MESSAGE).chain(of_factories()).collect();
    assert_eq!(known, kinds, "each kind has an example");
    examples
}

/// Kinds of messages of factories, besides those of OPC UA PubSub.
fn of_factories() -> Vec<String> {
    let schema = serde_json::to_value(FactoryMessage::schema()).expect("it serialises");
    let variants = schema["oneOf"].as_array().expect("a variant of each kind");
    let kinds = variants.iter().flat_map(|variant| {
        let parts = variant["allOf"].as_array().cloned().unwrap_or_default();
        parts.into_iter().filter_map(|part| {
            part["properties"]["messageType"]["enum"][0].as_str().map(str::to_owned)
        })
    });
    let kinds: Vec<String> = kinds.collect();
    assert_eq!(kinds.len(), variants.len(), "{schema:#}");
    kinds
}

/// Kinds of data set messages.
fn data_set_kinds() -> Vec<String> {
    let schemas = asi_model::schema::all();
    let of_data = schemas.iter().find(|(name, _)| *name == "ua-data.schema.json");
    let (_, schema) = of_data.expect("the schema of reports");
    let kinds = &schema["$defs"]["DataSetMessage"]["properties"]["MessageType"]["enum"];
    let kinds = kinds.as_array().expect("all kinds").iter();
    kinds.map(|kind| kind.as_str().expect("a name").to_owned()).collect()
}

/// Returns an example with these values of members, wherever they are in it. Publishers keep the
/// names of their assets.
pub fn filled(body: &Value, values: &BTreeMap<&str, Value>) -> Value {
    match body {
        Value::Object(members) => members
            .iter()
            .map(|(name, member)| {
                let filled = match values.get(name.as_str()) {
                    Some(value) => replaced(name, member, value),
                    None => filled(member, values),
                };
                (name.clone(), filled)
            })
            .collect(),
        Value::Array(elements) => elements.iter().map(|element| filled(element, values)).collect(),
        other => other.clone(),
    }
}

/// Returns a member with another value in the same encoding.
fn replaced(name: &str, member: &Value, value: &Value) -> Value {
    let mut replaced = member.clone();
    for body in ["Body", "Value"] {
        if member.get(body).is_some() {
            replaced[body] = value.clone();
            return replaced;
        }
    }
    match (name, member.as_str().and_then(|text| text.split_once('.'))) {
        ("PublisherId", Some((_, asset))) => {
            json!(format!("{}.{asset}", value.as_str().expect("an id")))
        }
        _ => value.clone(),
    }
}
