//! Definitions that the schemas of PubSub messages share.

use serde_json::{Map, Value, json};

use crate::{pubsub::DataSetMessageKind, values::BuiltInType};

/// Returns all definitions, by their names under `$defs`.
pub(super) fn definitions() -> Value {
    let mut all = Map::new();
    let parts = [
        numbers(),
        names(),
        variants(),
        data_value(),
        field(),
        data_set_message(),
        field_meta_data(),
    ];
    for part in parts {
        if let Value::Object(part) = part {
            all.extend(part);
        }
    }
    Value::Object(all)
}

/// Numbers, times and versions.
fn numbers() -> Value {
    json!({
        "UInt16": { "type": "integer", "minimum": 0, "maximum": u16::MAX },
        "UInt32": { "type": "integer", "minimum": 0, "maximum": u32::MAX },
        "BuiltInType": { "type": "integer", "minimum": 1, "maximum": BuiltInType::ALL.len() },
        "DateTime": { "type": "string", "format": "date-time" },
        "MetaDataVersion": {
            "type": "object",
            "properties": {
                "MajorVersion": { "$ref": "#/$defs/UInt32" },
                "MinorVersion": { "$ref": "#/$defs/UInt32" }
            },
            "required": ["MajorVersion", "MinorVersion"]
        }
    })
}

/// Status codes, and what names things.
fn names() -> Value {
    json!({
        "StatusCode": {
            "description": "A number in 1.04, an object in 1.05.",
            "anyOf": [
                { "$ref": "#/$defs/UInt32" },
                {
                    "type": "object",
                    "properties": {
                        "Code": { "$ref": "#/$defs/UInt32" },
                        "Symbol": { "type": "string" }
                    }
                }
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
        }
    })
}

/// Values with their type: of 1.04, and of 1.05.
fn variants() -> Value {
    json!({
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
        }
    })
}

/// Values with status and times.
fn data_value() -> Value {
    json!({
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
            "anyOf": [
                { "required": ["Value"] },
                { "required": ["Status"] },
                { "required": ["SourceTimestamp"] }
            ]
        }
    })
}

/// Members of a payload.
fn field() -> Value {
    json!({
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
        }
    })
}

/// DataSetMessages.
fn data_set_message() -> Value {
    let kinds = [
        DataSetMessageKind::KeyFrame,
        DataSetMessageKind::DeltaFrame,
        DataSetMessageKind::Event,
        DataSetMessageKind::KeepAlive,
    ];
    json!({
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
                "Payload": {
                    "type": "object",
                    "description": concat!(
                        "In a report: reportName, dynamicDataRequestId, operationId, operationNetworkId, ",
                        "shopfloorTimestamp, recipientList (ids of the organisations that may read it, ",
                        "an array of String), then each field, followed by its unit where it has one."
                    ),
                    "additionalProperties": { "$ref": "#/$defs/Field" }
                }
            },
            "required": ["DataSetWriterId", "SequenceNumber", "Timestamp"],
            "if": {
                "properties": { "MessageType": { "const": DataSetMessageKind::KeepAlive.name() } },
                "required": ["MessageType"]
            },
            "then": { "properties": { "Payload": false } },
            "else": { "required": ["Payload"] }
        }
    })
}

/// Metadata of one field.
fn field_meta_data() -> Value {
    json!({
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
