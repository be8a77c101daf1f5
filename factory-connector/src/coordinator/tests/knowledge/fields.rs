//! Fields of the plant: two requests with different recipients, and fields of all kinds of types.

use asi_model::{
    BuiltInType, FieldKey, NodeId, RequestKey, Scalar, Variant,
    values::{
        Array, DiagnosticInfo, ExtensionBody, ExtensionObject, LocalizedText, QualifiedName,
        StructureValue,
    },
};
use serde_json::{Value, json};

use super::*;

/// Value of a field in which others, and itself, may be withheld.
pub(super) const WITHHELD_STATE: i32 = 7;

/// A field: its request, its name and its type.
pub(super) struct FieldOf {
    pub(super) request: usize,
    pub(super) name: &'static str,
    pub(super) field_type: BuiltInType,
    pub(super) is_array: bool,
}

const fn of(request: usize, name: &'static str, field_type: BuiltInType) -> FieldOf {
    FieldOf { request, name, field_type, is_array: false }
}

const fn array_of(request: usize, name: &'static str, field_type: BuiltInType) -> FieldOf {
    FieldOf { request, name, field_type, is_array: true }
}

pub(super) const FIELDS: [FieldOf; 26] = [
    of(0, "made", BuiltInType::UInt64),
    of(0, "level", BuiltInType::Double),
    of(0, "note", BuiltInType::String),
    of(0, "state", BuiltInType::Int32),
    of(1, "count", BuiltInType::Int64),
    of(1, "speed", BuiltInType::Float),
    of(1, "on", BuiltInType::Boolean),
    of(1, "since", BuiltInType::DateTime),
    of(0, "grade", BuiltInType::Byte),
    array_of(0, "curve", BuiltInType::UInt16),
    of(0, "batch", BuiltInType::Guid),
    of(1, "image", BuiltInType::ByteString),
    of(1, "title", BuiltInType::LocalizedText),
    array_of(1, "marks", BuiltInType::DateTime),
    array_of(0, "samples", BuiltInType::DataValue),
    array_of(1, "mixed", BuiltInType::Variant),
    of(1, "quality", BuiltInType::StatusCode),
    of(0, "shift", BuiltInType::SByte),
    of(1, "offset", BuiltInType::Int16),
    of(0, "cycles", BuiltInType::UInt32),
    of(1, "sheet", BuiltInType::XmlElement),
    of(0, "place", BuiltInType::NodeId),
    of(1, "origin", BuiltInType::ExpandedNodeId),
    of(0, "kind", BuiltInType::QualifiedName),
    of(0, "part", BuiltInType::ExtensionObject),
    of(1, "trouble", BuiltInType::DiagnosticInfo),
];

/// The field at whose state others look.
pub(super) const STATE: usize = 3;

/// Organisations that may be recipients of a request.
pub(super) const PARTNERS: [&str; 3] = ["acme", "hull", "keel"];

impl FieldOf {
    pub(super) fn key(&self) -> FieldKey {
        let request = RequestKey {
            operation_network_id: "n".parse().expect("an id"),
            operation_id: "op".parse().expect("an id"),
            dynamic_data_request_id: format!("R{}", self.request).parse().expect("an id"),
        };
        request.field(self.name.parse().expect("a name"))
    }

    /// Makes a value of the field's type of a number from 1000 on: a scalar, or an array of two.
    pub(super) fn value(&self, number: u32) -> Variant {
        if !self.is_array {
            return Variant::Scalar(self.scalar(number));
        }
        Variant::Array(Arc::new(Array {
            element_type: self.field_type,
            elements: vec![self.scalar(number), self.scalar(number + 1)],
            dimensions: None,
        }))
    }

    /// Makes a scalar of the field's type of a number from 1000 on. Different numbers make different
    /// values, but for those of a truth value and of a small type.
    #[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation)]
    pub(super) fn scalar(&self, number: u32) -> Scalar {
        let whole = i32::try_from(number).expect("small");
        match self.field_type {
            BuiltInType::UInt64 => Scalar::UInt64(number.into()),
            BuiltInType::Double => Scalar::Double(number.into()),
            BuiltInType::String => Scalar::from(format!("text {number}").as_str()),
            BuiltInType::Int32 if number.is_multiple_of(3) => Scalar::Int32(WITHHELD_STATE),
            BuiltInType::Int32 => Scalar::Int32(whole),
            BuiltInType::Int64 => Scalar::Int64(-i64::from(whole)),
            BuiltInType::Float => Scalar::Float(number as f32),
            BuiltInType::Boolean => Scalar::Boolean(number.is_multiple_of(2)),
            BuiltInType::Byte => Scalar::Byte((number % 251) as u8),
            BuiltInType::UInt16 => Scalar::UInt16((number % 50_021) as u16),
            BuiltInType::Guid => Scalar::Guid(uuid::Uuid::from_u128(number.into())),
            BuiltInType::ByteString => {
                Scalar::ByteString(Some(number.to_be_bytes().to_vec().into()))
            }
            BuiltInType::LocalizedText => Scalar::LocalizedText(Box::new(LocalizedText {
                locale: Some("de".into()),
                text: Some(format!("Text {number}").into()),
            })),
            BuiltInType::DataValue => Scalar::DataValue(Box::new(sample(number))),
            BuiltInType::Variant => Scalar::Variant(Box::new(held(number))),
            BuiltInType::StatusCode => Scalar::StatusCode(code(number)),
            // The next step still fits the type.
            BuiltInType::SByte => Scalar::SByte((number % 100) as i8),
            BuiltInType::Int16 => Scalar::Int16((number % 30_011) as i16),
            BuiltInType::UInt32 => Scalar::UInt32(number),
            BuiltInType::XmlElement => {
                Scalar::XmlElement(Some(format!("<sheet>{number}</sheet>").into()))
            }
            BuiltInType::NodeId => Scalar::NodeId(Box::new(NodeId::ua(number))),
            BuiltInType::ExpandedNodeId => {
                Scalar::ExpandedNodeId(Box::new(NodeId::ua(number).into()))
            }
            BuiltInType::QualifiedName => Scalar::QualifiedName(Box::new(QualifiedName {
                name: Some(format!("Kind {number}").into()),
                ..QualifiedName::default()
            })),
            BuiltInType::ExtensionObject => Scalar::ExtensionObject(Box::new(part(number))),
            BuiltInType::DiagnosticInfo => Scalar::DiagnosticInfo(Box::new(DiagnosticInfo {
                symbolic_id: Some(whole),
                additional_info: Some(format!("info {number}").into()),
                inner_status_code: Some(code(number)),
                ..DiagnosticInfo::default()
            })),
            _ => Scalar::DateTime(plant::start().after(Duration::from_millis(number.into()))),
        }
    }
}

/// Makes a value of one of four types, so that an array has several.
fn held(number: u32) -> Variant {
    match number % 4 {
        0 => Variant::from(f64::from(number)),
        1 => {
            let time = plant::start().after(Duration::from_millis(number.into()));
            Variant::Scalar(Scalar::DateTime(time))
        }
        2 => Variant::from(format!("held {number}").as_str()),
        _ => Variant::Scalar(Scalar::StatusCode(code(number))),
    }
}

/// Makes a status code with a cause within the plant.
const fn code(number: u32) -> StatusCode {
    StatusCode([0x0096_0000, 0x4094_0000, 0x8089_0000][number as usize % 3])
}

/// Makes a value with a status and times of its own.
fn sample(number: u32) -> DataValue {
    let at = plant::start().after(Duration::from_millis(number.into()));
    DataValue {
        status: StatusCode(0x00A2_0000),
        server_timestamp: Some(at.after(Duration::from_millis(2))),
        ..DataValue::good(f64::from(number), at)
    }
}

/// Makes a structure of numbers, a time, a text and a value with a status and times of its own.
fn part(number: u32) -> ExtensionObject {
    let at = plant::start().after(Duration::from_millis(number.into()));
    let fields = [
        ("weight", Variant::from(f64::from(number))),
        ("count", Variant::Scalar(Scalar::UInt32(number))),
        ("at", Variant::Scalar(Scalar::DateTime(at))),
        ("label", Variant::from(format!("part {number}").as_str())),
        ("sample", Variant::Scalar(Scalar::DataValue(Box::new(sample(number))))),
    ];
    let fields = fields.into_iter().map(|(name, value)| (name.into(), value)).collect();
    let body = ExtensionBody::Structure(StructureValue { fields, ..StructureValue::default() });
    ExtensionObject { type_id: NodeId::ua(3_000).into(), body }
}

/// Recipients of the first request, by a number of which each bit stands for a partner; the second
/// request is always for the second partner.
pub(super) fn recipients(request: usize, bits: u8) -> Vec<&'static str> {
    let bits = if request == 0 { bits | 1 } else { 2 };
    let chosen = PARTNERS.iter().enumerate().filter(|(place, _)| bits & (1 << place) > 0);
    chosen.map(|(_, partner)| *partner).collect()
}

/// Returns the network in a revision, as the platform sends it.
pub(super) fn network(revision: u64, bits: u8, begins_at: Option<DateTime>) -> Value {
    let request = |number: usize| {
        let fields = FIELDS.iter().filter(|field| field.request == number);
        let fields: Vec<Value> = fields
            .map(|field| {
                json!({ "name": field.name, "type": field.field_type.id(),
                    "valueRank": if field.is_array { 1 } else { -1 } })
            })
            .collect();
        json!({ "dynamicDataRequestId": format!("R{number}"), "requesterId": "acme",
            "recipientList": recipients(number, bits), "purpose": "Plan", "updateFrequency": 1,
            "validFrom": begins_at,
            "updateFrequencyUnit": "MINUTE",
            "reportDataFormat": { "reportName": "Progress", "reportFieldList": fields } })
    };
    json!({ "messageId": format!("m{revision}"), "factoryId": "F", "collaborationId": "c",
        "revision": revision, "operationNetwork": { "operationNetworkId": "n",
        "operationList": [ { "operationId": "op", "operationType": "PRODUCTION",
            "dynamicDataRequestList": [request(0), request(1)] } ] } })
}

/// A type that a field can have is part of the histories.
#[test]
fn histories_have_every_type() {
    for field_type in BuiltInType::ALL {
        assert!(
            FIELDS.iter().any(|field| field.field_type == field_type),
            "no field has the type {}",
            field_type.name()
        );
    }
}
