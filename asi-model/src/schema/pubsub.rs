//! Schemas of the PubSub messages in the encodings that connectors write. Their types keep meaning
//! apart from encoding, so the schemas are stated here.

use serde_json::{Value, json};

use super::SCHEMA_BASE;
use crate::{
    pubsub::{DataSetMessageKind, PubSubState},
    values::BuiltInType,
};

fn envelope(message_type: &str, description: &str, properties: Value, required: &[&str]) -> Value {
    let mut members = json!({
        "MessageId": { "type": "string", "minLength": 1, "description": "Unique per message." },
        "MessageType": { "const": message_type },
        "PublisherId": { "type": "string", "description": "Factory id, or factory id and asset id with a dot between." }
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

fn definitions() -> Value {
    let uint = |max: u64| json!({ "type": "integer", "minimum": 0, "maximum": max });
    let kinds = [
        DataSetMessageKind::KeyFrame,
        DataSetMessageKind::DeltaFrame,
        DataSetMessageKind::Event,
        DataSetMessageKind::KeepAlive,
    ];
    json!({
        "UInt16": uint(u64::from(u16::MAX)),
        "UInt32": uint(u64::from(u32::MAX)),
        "BuiltInType": { "type": "integer", "minimum": 1, "maximum": BuiltInType::ALL.len() },
        "DateTime": { "type": "string", "format": "date-time" },
        "MetaDataVersion": {
            "type": "object",
            "properties": { "MajorVersion": { "$ref": "#/$defs/UInt32" }, "MinorVersion": { "$ref": "#/$defs/UInt32" } },
            "required": ["MajorVersion", "MinorVersion"]
        },
        "StatusCode": {
            "description": "A number in 1.04, an object in 1.05.",
            "anyOf": [
                { "$ref": "#/$defs/UInt32" },
                { "type": "object", "properties": { "Code": { "$ref": "#/$defs/UInt32" }, "Symbol": { "type": "string" } } }
            ]
        },
        "NodeId": {
            "description": "An object in 1.04, a string in 1.05.",
            "type": ["object", "string"]
        },
        "QualifiedName": {
            "description": "An object in 1.04, a string in 1.05.",
            "type": ["object", "string"]
        },
        "LocalizedText": {
            "type": "object",
            "properties": { "Locale": { "type": "string" }, "Text": { "type": "string" } }
        },
        "Variant104": {
            "type": "object",
            "properties": {
                "Type": { "$ref": "#/$defs/BuiltInType" },
                "Body": true,
                "Dimensions": { "type": "array", "items": { "$ref": "#/$defs/UInt32" } }
            },
            "required": ["Type", "Body"]
        },
        "Value105": {
            "description": "A Variant, or with status or times a DataValue, of 1.05.",
            "type": "object",
            "properties": {
                "UaType": { "$ref": "#/$defs/BuiltInType" },
                "Value": true,
                "Dimensions": { "type": "array", "items": { "$ref": "#/$defs/UInt32" } },
                "Status": { "$ref": "#/$defs/StatusCode" },
                "SourceTimestamp": { "$ref": "#/$defs/DateTime" },
                "ServerTimestamp": { "$ref": "#/$defs/DateTime" }
            },
            "required": ["UaType"]
        },
        "DataValue": {
            "description": "A DataValue of 1.04, or of 1.05 Verbose without its type.",
            "type": "object",
            "properties": {
                "Value": true,
                "Status": { "$ref": "#/$defs/StatusCode" },
                "SourceTimestamp": { "$ref": "#/$defs/DateTime" },
                "SourcePicoseconds": { "$ref": "#/$defs/UInt16" },
                "ServerTimestamp": { "$ref": "#/$defs/DateTime" },
                "ServerPicoseconds": { "$ref": "#/$defs/UInt16" }
            },
            "anyOf": [{ "required": ["Value"] }, { "required": ["Status"] }, { "required": ["SourceTimestamp"] }]
        },
        "Field": {
            "description": "1.04 reversible, 1.05 Compact, or a bare value of 1.05 Verbose.",
            "if": { "type": "object" },
            "then": {
                "anyOf": [
                    { "$ref": "#/$defs/Variant104" },
                    { "$ref": "#/$defs/Value105" },
                    { "$ref": "#/$defs/DataValue" },
                    { "description": "A bare structure.", "not": { "required": ["Type", "Body"] } }
                ]
            }
        },
        "DataSetMessage": {
            "type": "object",
            "properties": {
                "DataSetWriterId": { "$ref": "#/$defs/UInt16" },
                "DataSetWriterName": { "type": "string" },
                "PublisherId": { "type": "string" },
                "WriterGroupName": { "type": "string" },
                "SequenceNumber": { "$ref": "#/$defs/UInt32" },
                "MetaDataVersion": { "$ref": "#/$defs/MetaDataVersion" },
                "MinorVersion": { "$ref": "#/$defs/UInt32" },
                "Timestamp": { "$ref": "#/$defs/DateTime" },
                "Status": { "$ref": "#/$defs/StatusCode" },
                "MessageType": { "enum": kinds.map(DataSetMessageKind::name) },
                "Payload": { "type": "object", "additionalProperties": { "$ref": "#/$defs/Field" } }
            },
            "required": ["DataSetWriterId", "SequenceNumber", "Timestamp"],
            "if": {
                "properties": { "MessageType": { "const": DataSetMessageKind::KeepAlive.name() } },
                "required": ["MessageType"]
            },
            "then": { "properties": { "Payload": false } },
            "else": { "required": ["Payload"] }
        },
        "FieldMetaData": {
            "type": "object",
            "properties": {
                "Name": { "type": "string" },
                "Description": { "$ref": "#/$defs/LocalizedText" },
                "FieldFlags": { "$ref": "#/$defs/UInt16" },
                "BuiltInType": { "$ref": "#/$defs/BuiltInType" },
                "DataType": { "$ref": "#/$defs/NodeId" },
                "ValueRank": { "type": "integer" },
                "ArrayDimensions": { "type": "array", "items": { "$ref": "#/$defs/UInt32" } },
                "MaxStringLength": { "$ref": "#/$defs/UInt32" },
                "DataSetFieldId": { "type": "string", "format": "uuid" },
                "Properties": {
                    "type": "array",
                    "items": {
                        "type": "object",
                        "properties": { "Key": { "$ref": "#/$defs/QualifiedName" }, "Value": true },
                        "required": ["Key", "Value"]
                    }
                }
            },
            "required": ["Name", "BuiltInType", "DataType"]
        }
    })
}

pub(super) fn data() -> Value {
    envelope(
        "ua-data",
        "Values (OPC 10000-14 §7.2.5.3), in one of the encodings digicor, 1.05-compact and 1.05-verbose.",
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
