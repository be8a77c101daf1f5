//! Documents generated from types.

use schemars::{JsonSchema, Schema, SchemaGenerator, generate::SchemaSettings};
use serde_json::{Value, json};

/// Prefix of the schemas' ids; the message type follows.
pub const SCHEMA_BASE: &str = "urn:verbund:schema:";

pub(super) fn document<T: JsonSchema>(name: &str) -> Value {
    let schema: Schema =
        SchemaGenerator::new(SchemaSettings::draft2020_12()).into_root_schema_for::<T>();
    let mut schema = schema.to_value();
    schema["$id"] = json!(format!("{SCHEMA_BASE}{name}"));
    schema
}

/// A message's own members, and the member `messageType`.
pub(super) fn message<T: JsonSchema>(message_type: &str) -> Value {
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
