//! JSON Schemas (2020-12) of every message, generated from the types and published under `schema/`.
//!
//! A schema tells the structure; the rules beyond it are the validation's.

use schemars::{JsonSchema, Schema, SchemaGenerator, generate::SchemaSettings};
use serde_json::{Value, json};

use crate::{
    messages::{
        Acknowledgement, AssetOffer, AssetRequest, Comment, Decision, Gap, Lease, LeaseRequest,
        OperationNetworkMessage, Receipt, Withdraw,
    },
    network::OperationNetwork,
};

mod pubsub;

/// Where the schemas are published; the file name follows.
pub const SCHEMA_BASE: &str = "urn:verbund:schema:";

/// Every schema with its file name.
#[must_use]
pub fn all() -> Vec<(&'static str, Value)> {
    vec![
        ("operation-network.schema.json", message::<OperationNetworkMessage>("operation-network")),
        ("withdraw.schema.json", message::<Withdraw>("withdraw")),
        ("comment.schema.json", message::<Comment>("comment")),
        ("asset-request.schema.json", message::<AssetRequest>("asset-request")),
        ("receipt.schema.json", message::<Receipt>("receipt")),
        ("lease.schema.json", message::<Lease>("lease")),
        ("acknowledgement.schema.json", message::<Acknowledgement>("acknowledgement")),
        ("decision.schema.json", message::<Decision>("decision")),
        ("gap.schema.json", message::<Gap>("gap")),
        ("asset-offer.schema.json", message::<AssetOffer>("asset-offer")),
        ("lease-request.schema.json", message::<LeaseRequest>("lease-request")),
        ("network.schema.json", document::<OperationNetwork>("network")),
        ("ua-data.schema.json", pubsub::data()),
        ("ua-metadata.schema.json", pubsub::meta_data()),
        ("ua-status.schema.json", pubsub::status()),
    ]
}

/// The text of a schema file.
#[must_use]
pub fn text(schema: &Value) -> String {
    format!("{schema:#}\n")
}

fn document<T: JsonSchema>(name: &str) -> Value {
    let schema: Schema =
        SchemaGenerator::new(SchemaSettings::draft2020_12()).into_root_schema_for::<T>();
    let mut schema = schema.to_value();
    schema["$id"] = json!(format!("{SCHEMA_BASE}{name}"));
    schema
}

/// A message's own members, and the member that tells its type.
fn message<T: JsonSchema>(message_type: &str) -> Value {
    let mut schema = document::<T>(message_type);
    schema["title"] = json!(message_type);
    if let Some(properties) = schema["properties"].as_object_mut() {
        properties.shift_insert(
            0,
            "messageType".to_owned(),
            json!({ "const": message_type, "description": "Tells the message's type." }),
        );
    }
    if let Some(required) = schema["required"].as_array_mut() {
        required.insert(0, json!("messageType"));
    }
    schema
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{pubsub::PubSubMessage, validation};

    fn files(folder: &str) -> Vec<(String, Vec<u8>)> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
            .expect("the folder exists")
            .map(|entry| {
                let path = entry.expect("readable").path();
                let name = path.file_name().expect("a file").to_string_lossy().into_owned();
                (name, std::fs::read(&path).expect("readable"))
            })
            .collect();
        files.sort();
        files
    }

    /// `asi schema asi-model/schema` writes them anew.
    #[test]
    fn the_published_schemas_are_fresh() {
        let mut wanted: Vec<(String, Vec<u8>)> = all()
            .iter()
            .map(|(name, schema)| ((*name).to_owned(), text(schema).into_bytes()))
            .collect();
        wanted.sort();
        for ((name, text), (wanted_name, wanted_text)) in files("schema").iter().zip(&wanted) {
            assert_eq!(name, wanted_name);
            assert!(text == wanted_text, "{name} is stale: run `asi schema asi-model/schema`");
        }
        assert_eq!(files("schema").len(), wanted.len());
    }

    #[test]
    fn every_example_validates() {
        let mut uncovered: Vec<String> = all()
            .iter()
            .map(|(name, _)| name.trim_end_matches(".schema.json").to_owned())
            .collect();
        uncovered.retain(|name| name != "network");
        for (name, bytes) in files("examples").iter().filter(|(name, _)| name.ends_with(".json")) {
            let message_type = name.split('.').next().expect("a name");
            let schema = all()
                .into_iter()
                .find(|(file, _)| file.trim_end_matches(".schema.json") == message_type)
                .unwrap_or_else(|| panic!("{name} has no schema"))
                .1;
            let validator = jsonschema::draft202012::new(&schema).expect("a valid schema");
            let instance: Value = serde_json::from_slice(bytes).expect("JSON");
            let errors: Vec<String> =
                validator.iter_errors(&instance).map(|error| error.to_string()).collect();
            assert_eq!(errors, Vec::<String>::new(), "{name}");
            assert!(
                !validator.is_valid(&json!({ "messageType": message_type })),
                "{name}: the schema asks for nothing"
            );
            check_readable(name, message_type, bytes, &instance);
            uncovered.retain(|kind| kind != message_type);
        }
        assert_eq!(uncovered, Vec::<String>::new(), "message types without example");
    }

    fn check_readable(name: &str, message_type: &str, bytes: &[u8], instance: &Value) {
        match message_type {
            "operation-network" | "withdraw" | "comment" | "asset-request" | "receipt"
            | "lease" => {
                let message = validation::parse_any_platform_message(bytes).expect(name);
                assert_eq!(message.message_type(), message_type);
                let again = serde_json::to_vec(&message).expect("writable");
                assert_eq!(validation::parse_any_platform_message(&again).as_ref(), Ok(&message));
                // serde reads the same from its own text, as the stores do.
                assert_eq!(
                    serde_json::from_slice::<crate::messages::PlatformMessage>(&again).expect(name),
                    message
                );
            }
            "acknowledgement" | "decision" | "gap" | "asset-offer" | "lease-request" => {
                let message = validation::parse_factory_message(bytes).expect(name);
                let again = serde_json::to_vec(&message).expect("writable");
                assert_eq!(validation::parse_factory_message(&again).as_ref(), Ok(&message));
                assert_eq!(
                    serde_json::from_slice::<crate::messages::FactoryMessage>(&again).expect(name),
                    message
                );
            }
            _ => {
                let decoded = crate::pubsub::json::decode(bytes).expect(name);
                assert_eq!(decoded.message.message_type(), message_type);
                if name.contains("1.05-verbose") {
                    return;
                }
                assert_eq!(decoded.diagnostics, [], "{name}");
                let encoding = if name.contains("1.05") {
                    crate::pubsub::json::Encoding::Compact105
                } else {
                    crate::pubsub::json::Encoding::Digicor
                };
                let again = match &decoded.message {
                    // Indexes are written where the metadata lists the namespaces.
                    PubSubMessage::MetaData(_)
                    | PubSubMessage::Data(_)
                    | PubSubMessage::Status(_) => {
                        crate::pubsub::json::encode_message(&decoded.message, encoding)
                    }
                    PubSubMessage::Other { .. } => panic!("{name} is of unknown type"),
                };
                let again: Value = serde_json::from_slice(&again).expect("JSON");
                assert_eq!(&again, instance, "{name} is not written as it was read");
            }
        }
    }
}
