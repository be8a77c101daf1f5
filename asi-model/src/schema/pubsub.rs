//! Schemas of the PubSub messages in the encodings that connectors write. Their types keep meaning
//! apart from encoding, so the schemas are stated here.

use serde_json::{Value, json};

use super::{SCHEMA_BASE, pubsub_definitions::definitions};
use crate::pubsub::PubSubState;

fn envelope(message_type: &str, description: &str, properties: Value, required: &[&str]) -> Value {
    let mut members = json!({
        "MessageId": { "type": "string", "minLength": 1, "description": "Unique per message." },
        "MessageType": { "const": message_type },
        "PublisherId": {
            "type": "string",
            "description": "Factory id, or factory id and asset id with a dot between."
        }
    });
    if let (Some(members), Value::Object(more)) = (members.as_object_mut(), properties) {
        members.extend(more);
    }
    let mut all = vec!["MessageId", "MessageType", "PublisherId"];
    all.extend(required);
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": format!("{SCHEMA_BASE}{message_type}"),
        "title": message_type,
        "description": description,
        "type": "object",
        "properties": members,
        "required": all,
        "$defs": definitions()
    })
}

pub(super) fn data() -> Value {
    envelope(
        "ua-data",
        concat!(
            "Values (OPC 10000-14 §7.2.5.3), ",
            "in one of the encodings digicor, 1.05-compact and 1.05-verbose."
        ),
        json!({
            "WriterGroupName": { "type": "string" },
            "DataSetClassId": { "type": "string", "format": "uuid" },
            "Messages": { "type": "array", "items": { "$ref": "#/$defs/DataSetMessage" } }
        }),
        &["Messages"],
    )
}

pub(super) fn meta_data() -> Value {
    envelope(
        "ua-metadata",
        "What the values of one writer are (OPC 10000-14 §7.2.5.5.2).",
        json!({
            "DataSetWriterId": { "$ref": "#/$defs/UInt16" },
            "WriterGroupName": { "type": "string" },
            "DataSetWriterName": { "type": "string" },
            "Timestamp": { "$ref": "#/$defs/DateTime" },
            "MetaData": {
                "type": "object",
                "properties": {
                    "Namespaces": { "type": "array", "items": { "type": "string" } },
                    "StructureDataTypes": { "type": "array", "items": { "type": "object" } },
                    "EnumDataTypes": { "type": "array", "items": { "type": "object" } },
                    "SimpleDataTypes": { "type": "array", "items": { "type": "object" } },
                    "Name": { "type": "string" },
                    "Description": { "$ref": "#/$defs/LocalizedText" },
                    "Fields": { "type": "array", "items": { "$ref": "#/$defs/FieldMetaData" } },
                    "DataSetClassId": { "type": "string", "format": "uuid" },
                    "ConfigurationVersion": { "$ref": "#/$defs/MetaDataVersion" }
                },
                "required": ["Name", "Fields", "ConfigurationVersion"]
            }
        }),
        &["DataSetWriterId", "MetaData"],
    )
}

pub(super) fn status() -> Value {
    envelope(
        "ua-status",
        "How the publisher is (OPC 10000-14 §7.2.5.5.4).",
        json!({
            "Timestamp": { "$ref": "#/$defs/DateTime" },
            "NextReportTime": { "$ref": "#/$defs/DateTime" },
            "IsCyclic": { "type": "boolean" },
            "Status": { "type": "integer", "minimum": 0, "maximum": PubSubState::ALL.len() - 1 }
        }),
        &["IsCyclic", "Status"],
    )
}
