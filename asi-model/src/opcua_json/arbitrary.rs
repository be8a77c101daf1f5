//! Random values of every type, for round trips.

use std::sync::Arc;

use proptest::prelude::*;
use uuid::Uuid;

use crate::values::{
    Array, BuiltInType, DataValue, DateTime, DiagnosticInfo, ExpandedNodeId, ExtensionBody,
    ExtensionObject, Identifier, LocalizedText, Namespace, NodeId, QualifiedName, Scalar, Server,
    StatusCode, StructureField, StructureKind, StructureType, StructureValue, Variant,
};

pub(crate) fn range(low: f64, high: f64) -> ExtensionObject {
    let mut structure = StructureValue::default();
    structure.fields.insert("Low".into(), low.into());
    structure.fields.insert("High".into(), high.into());
    ExtensionObject { type_id: NodeId::ua(884).into(), body: ExtensionBody::Structure(structure) }
}

/// Structures of every kind, beside those of namespace 0.
pub(crate) fn described() -> Vec<StructureType> {
    let structure = |id: &str, kind, fields| StructureType {
        type_id: NodeId::string("urn:types", id),
        encoding_ids: Vec::new(),
        name: id.into(),
        kind,
        fields,
    };
    use BuiltInType as T;
    let power = ["SecondsAggregated", "WattsMin", "WattsMax"]
        .map(|name| StructureField::scalar(name, T::Double));
    let optional = vec![
        StructureField { is_optional: true, ..StructureField::scalar("A", T::Int32) },
        StructureField::scalar("B", T::String),
        StructureField { is_optional: true, ..StructureField::scalar("C", T::UInt64) },
    ];
    let union =
        vec![StructureField::scalar("Number", T::Int32), StructureField::scalar("Text", T::String)];
    let nested = vec![
        StructureField::structure("Range", NodeId::ua(884)),
        StructureField::scalar("Any", T::Variant),
        StructureField::scalar("Object", T::ExtensionObject),
        StructureField::scalar("Numbers", T::Int64).array(),
    ];
    // Fields called as the members of envelopes.
    let tricky = ["Type", "Body", "Value"].map(|name| StructureField::scalar(name, T::Int32));
    vec![
        structure("Power", StructureKind::Plain, power.to_vec()),
        structure("Optional", StructureKind::WithOptionalFields, optional),
        structure("Union", StructureKind::Union, union),
        structure("Nested", StructureKind::Plain, nested),
        structure("Tricky", StructureKind::Plain, tricky.to_vec()),
    ]
}

pub(crate) fn arc_text() -> impl Strategy<Value = Arc<str>> {
    prop_oneof![any::<String>(), "[a-z:;%=#/0-9]{0,8}"].prop_map(Arc::from)
}

pub(crate) fn namespace() -> impl Strategy<Value = Namespace> {
    prop_oneof![
        Just(Namespace::Ua),
        // Beyond any table of namespaces that a test has.
        (100_u16..).prop_map(Namespace::Index),
        arc_text().prop_map(|uri| Namespace::uri(&uri)),
    ]
}

pub(crate) fn node_id() -> impl Strategy<Value = NodeId> {
    let identifier = prop_oneof![
        any::<u32>().prop_map(Identifier::Numeric),
        arc_text().prop_map(Identifier::String),
        any::<u128>().prop_map(|bits| Identifier::Guid(Uuid::from_u128(bits))),
        any::<Vec<u8>>().prop_map(|bytes| Identifier::Opaque(bytes.into())),
    ];
    (namespace(), identifier).prop_map(|(namespace, identifier)| NodeId { namespace, identifier })
}

pub(crate) fn date_time() -> impl Strategy<Value = DateTime> {
    (0..=DateTime::MAX.ticks()).prop_map(DateTime::from_ticks)
}

pub(crate) fn diagnostic_info() -> impl Strategy<Value = DiagnosticInfo> {
    let leaf = (
        any::<[Option<i32>; 4]>(),
        proptest::option::of(arc_text()),
        proptest::option::of(any::<u32>().prop_map(StatusCode)),
    )
        .prop_map(|(numbers, additional_info, inner_status_code)| DiagnosticInfo {
            symbolic_id: numbers[0],
            namespace_uri: numbers[1],
            locale: numbers[2],
            localized_text: numbers[3],
            additional_info,
            inner_status_code,
            inner_diagnostic_info: None,
        });
    let leaf = leaf.boxed();
    (leaf.clone(), proptest::option::of(leaf)).prop_map(|(outer, inner)| DiagnosticInfo {
        inner_diagnostic_info: inner.map(Box::new),
        ..outer
    })
}

/// Finite numbers, and both infinities; NaN is no equal of itself.
pub(crate) fn double() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("NaN", |value| !value.is_nan())
}

pub(crate) fn plain_scalar() -> impl Strategy<Value = Scalar> {
    prop_oneof![
        any::<bool>().prop_map(Scalar::Boolean),
        any::<i8>().prop_map(Scalar::SByte),
        any::<u8>().prop_map(Scalar::Byte),
        any::<i16>().prop_map(Scalar::Int16),
        any::<u16>().prop_map(Scalar::UInt16),
        any::<i32>().prop_map(Scalar::Int32),
        any::<u32>().prop_map(Scalar::UInt32),
        any::<i64>().prop_map(Scalar::Int64),
        any::<u64>().prop_map(Scalar::UInt64),
        any::<f32>().prop_filter("NaN", |value| !value.is_nan()).prop_map(Scalar::Float),
        double().prop_map(Scalar::Double),
        proptest::option::of(arc_text()).prop_map(Scalar::String),
        date_time().prop_map(Scalar::DateTime),
        any::<u128>().prop_map(|bits| Scalar::Guid(Uuid::from_u128(bits))),
        proptest::option::of(any::<Vec<u8>>())
            .prop_map(|bytes| Scalar::ByteString(bytes.map(Arc::from))),
        proptest::option::of(arc_text()).prop_map(Scalar::XmlElement),
        node_id().prop_map(|id| Scalar::NodeId(Box::new(id))),
        (
            node_id(),
            prop_oneof![
                Just(Server::Local),
                (1_u32..).prop_map(Server::Index),
                arc_text().prop_map(Server::Uri)
            ]
        )
            .prop_map(|(node_id, server)| Scalar::ExpandedNodeId(Box::new(
                ExpandedNodeId { node_id, server }
            ))),
        any::<u32>().prop_map(|code| Scalar::StatusCode(StatusCode(code))),
        (namespace(), arc_text()).prop_map(|(namespace, name)| Scalar::QualifiedName(Box::new(
            QualifiedName { namespace, name: Some(name) }
        ))),
        Just(Scalar::QualifiedName(Box::default())),
        (proptest::option::of(arc_text()), proptest::option::of(arc_text())).prop_map(
            |(locale, text)| Scalar::LocalizedText(Box::new(LocalizedText { locale, text }))
        ),
        diagnostic_info().prop_map(|info| Scalar::DiagnosticInfo(Box::new(info))),
    ]
}

pub(crate) fn structure_of(
    description: &StructureType,
    values: Vec<Variant>,
    mask: u32,
    switch: u32,
) -> ExtensionObject {
    let mut structure = StructureValue::default();
    let mut fields = description.fields.iter().zip(values);
    match description.kind {
        StructureKind::Plain => {
            structure.fields = fields.map(|(field, value)| (field.name.clone(), value)).collect()
        }
        StructureKind::WithOptionalFields => {
            let mut bit = 0;
            let mut present = 0;
            for (field, value) in fields {
                if field.is_optional {
                    let is_present = mask >> bit & 1 == 1;
                    present |= u32::from(is_present) << bit;
                    bit += 1;
                    if !is_present {
                        continue;
                    }
                }
                structure.fields.insert(field.name.clone(), value);
            }
            structure.encoding_mask = Some(present);
        }
        StructureKind::Union => {
            let switch = switch % (u32::try_from(description.fields.len()).expect("few") + 1);
            structure.switch_field = Some(switch);
            if let Some((field, value)) =
                fields.nth((switch as usize).wrapping_sub(1)).filter(|_| switch > 0)
            {
                structure.fields.insert(field.name.clone(), value);
            }
        }
    }
    ExtensionObject {
        type_id: description.type_id.clone().into(),
        body: ExtensionBody::Structure(structure),
    }
}

pub(crate) fn extension_object() -> impl Strategy<Value = ExtensionObject> {
    let values =
        (any::<[i32; 3]>(), double(), double(), any::<u64>(), any::<Vec<i64>>(), arc_text());
    let structured = (0..6_usize, values, any::<u32>(), any::<u32>()).prop_map(
        |(which, (ints, low, high, unsigned, numbers, text), mask, switch)| {
            let types = described();
            let text = Variant::Scalar(Scalar::String(Some(text)));
            let ints = ints.map(Variant::from);
            let range_value = Variant::Scalar(Scalar::ExtensionObject(Box::new(range(low, high))));
            let numbers = Variant::Array(Arc::new(Array {
                element_type: BuiltInType::Int64,
                elements: numbers.into_iter().map(Scalar::Int64).collect(),
                dimensions: None,
            }));
            let values = match which {
                0 => vec![low.into(), high.into(), low.into()],
                1 => vec![ints[0].clone(), text, unsigned.into()],
                2 => vec![ints[0].clone(), text],
                3 => vec![
                    range_value.clone(),
                    Variant::Scalar(Scalar::Variant(Box::new(unsigned.into()))),
                    range_value,
                    numbers,
                ],
                4 => ints.to_vec(),
                _ => return range(low, high),
            };
            structure_of(&types[which], values, mask, switch)
        },
    );
    let unknown = NodeId::string("urn:nobody", "knows");
    let opaque = any::<Vec<u8>>().prop_map({
        let unknown = unknown.clone();
        move |bytes| ExtensionObject {
            type_id: unknown.clone().into(),
            body: ExtensionBody::Binary(bytes.into()),
        }
    });
    let xml = arc_text().prop_map({
        let unknown = unknown.clone();
        move |text| ExtensionObject {
            type_id: unknown.clone().into(),
            body: ExtensionBody::Xml(text),
        }
    });
    let json = any::<i32>().prop_map(move |number| ExtensionObject {
        type_id: unknown.clone().into(),
        body: ExtensionBody::Json(format!("{{\"x\":[{number},{{\"y\":null}}]}}").into()),
    });
    let null = Just(ExtensionObject { type_id: NodeId::null().into(), body: ExtensionBody::None });
    prop_oneof![4 => structured, 1 => opaque, 1 => xml, 1 => json, 1 => null]
}

pub(crate) fn scalar() -> impl Strategy<Value = Scalar> {
    let leaf = prop_oneof![
        6 => plain_scalar(),
        1 => extension_object().prop_map(|object| Scalar::ExtensionObject(Box::new(object))),
    ];
    leaf.prop_recursive(3, 24, 4, |inner| {
        let value = array_of(inner.clone());
        prop_oneof![
            data_value(value).prop_map(|value| Scalar::DataValue(Box::new(value))),
            inner.prop_map(|scalar| Scalar::Variant(Box::new(Variant::Scalar(scalar)))),
        ]
    })
}

/// A scalar, an array or a matrix.
pub(crate) fn array_of(
    scalar: impl Strategy<Value = Scalar> + Clone + 'static,
) -> impl Strategy<Value = Variant> {
    let matrix = (proptest::collection::vec(1_u32..4, 2..4), scalar.clone()).prop_map(
        |(dimensions, scalar)| {
            let count = dimensions.iter().product::<u32>() as usize;
            let elements = vec![scalar.clone(); count];
            Array { element_type: scalar.built_in_type(), elements, dimensions: Some(dimensions) }
        },
    );
    let list = (scalar.clone(), 0_usize..5).prop_map(|(scalar, count)| Array {
        element_type: scalar.built_in_type(),
        elements: vec![scalar; count],
        dimensions: None,
    });
    prop_oneof![
        4 => scalar.prop_map(Variant::Scalar),
        1 => prop_oneof![list, matrix].prop_map(|array| Variant::Array(Arc::new(array))),
    ]
}

pub(crate) fn variant() -> impl Strategy<Value = Variant> {
    prop_oneof![1 => Just(Variant::Null), 20 => array_of(scalar().boxed())]
}

pub(crate) fn data_value(
    value: impl Strategy<Value = Variant>,
) -> impl Strategy<Value = DataValue> {
    let time = || (date_time(), 0_u16..10_000);
    (value, any::<u32>(), proptest::option::of(time()), proptest::option::of(time())).prop_map(
        |(value, status, source, server)| DataValue {
            value,
            status: StatusCode(status),
            source_timestamp: source.map(|(time, _)| time),
            source_picoseconds: source.map_or(0, |(_, picoseconds)| picoseconds),
            server_timestamp: server.map(|(time, _)| time),
            server_picoseconds: server.map_or(0, |(_, picoseconds)| picoseconds),
        },
    )
}
