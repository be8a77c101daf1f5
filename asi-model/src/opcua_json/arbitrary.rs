//! Random values of every type, for round trips.

use std::{fmt, sync::Arc};

use proptest::{collection::vec, option, prelude::*, sample::select};
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
        option::of(arc_text()),
        option::of(any::<u32>().prop_map(StatusCode)),
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
    (leaf.clone(), option::of(leaf)).prop_map(|(outer, inner)| DiagnosticInfo {
        inner_diagnostic_info: inner.map(Box::new),
        ..outer
    })
}

/// True for equal values. NaN equals NaN here, though not as a number.
pub(crate) fn is_alike<T: PartialEq + fmt::Debug>(one: &T, other: &T) -> bool {
    one == other || format!("{one:?}") == format!("{other:?}")
}

/// Finite numbers, both infinities and NaN.
pub(crate) fn double() -> impl Strategy<Value = f64> {
    let special = select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0]);
    prop_oneof![8 => any::<f64>(), 1 => special]
}

fn float() -> impl Strategy<Value = f32> {
    let special = select(vec![f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0]);
    prop_oneof![8 => any::<f32>(), 1 => special]
}

/// Types whose values contain no others.
const PLAIN: [BuiltInType; 22] = {
    use BuiltInType as T;
    [
        T::Boolean,
        T::SByte,
        T::Byte,
        T::Int16,
        T::UInt16,
        T::Int32,
        T::UInt32,
        T::Int64,
        T::UInt64,
        T::Float,
        T::Double,
        T::String,
        T::DateTime,
        T::Guid,
        T::ByteString,
        T::XmlElement,
        T::NodeId,
        T::ExpandedNodeId,
        T::StatusCode,
        T::QualifiedName,
        T::LocalizedText,
        T::DiagnosticInfo,
    ]
};

/// A scalar of a type. One that contains another value contains a plain one.
fn scalar_of(built_in_type: BuiltInType) -> BoxedStrategy<Scalar> {
    use BuiltInType as T;
    let texts = || option::of(arc_text());
    match built_in_type {
        T::Boolean => any::<bool>().prop_map(Scalar::Boolean).boxed(),
        T::SByte => any::<i8>().prop_map(Scalar::SByte).boxed(),
        T::Byte => any::<u8>().prop_map(Scalar::Byte).boxed(),
        T::Int16 => any::<i16>().prop_map(Scalar::Int16).boxed(),
        T::UInt16 => any::<u16>().prop_map(Scalar::UInt16).boxed(),
        T::Int32 => any::<i32>().prop_map(Scalar::Int32).boxed(),
        T::UInt32 => any::<u32>().prop_map(Scalar::UInt32).boxed(),
        T::Int64 => any::<i64>().prop_map(Scalar::Int64).boxed(),
        T::UInt64 => any::<u64>().prop_map(Scalar::UInt64).boxed(),
        T::Float => float().prop_map(Scalar::Float).boxed(),
        T::Double => double().prop_map(Scalar::Double).boxed(),
        T::String => texts().prop_map(Scalar::String).boxed(),
        T::DateTime => date_time().prop_map(Scalar::DateTime).boxed(),
        T::Guid => any::<u128>().prop_map(|bits| Scalar::Guid(Uuid::from_u128(bits))).boxed(),
        T::ByteString => option::of(any::<Vec<u8>>())
            .prop_map(|bytes| Scalar::ByteString(bytes.map(Arc::from)))
            .boxed(),
        T::XmlElement => texts().prop_map(Scalar::XmlElement).boxed(),
        T::NodeId => node_id().prop_map(|id| Scalar::NodeId(Box::new(id))).boxed(),
        T::ExpandedNodeId => {
            expanded_node_id().prop_map(|id| Scalar::ExpandedNodeId(Box::new(id))).boxed()
        }
        T::StatusCode => any::<u32>().prop_map(|code| Scalar::StatusCode(StatusCode(code))).boxed(),
        T::QualifiedName => {
            qualified_name().prop_map(|name| Scalar::QualifiedName(Box::new(name))).boxed()
        }
        T::LocalizedText => (texts(), texts())
            .prop_map(|(locale, text)| {
                Scalar::LocalizedText(Box::new(LocalizedText { locale, text }))
            })
            .boxed(),
        T::ExtensionObject => {
            extension_object().prop_map(|object| Scalar::ExtensionObject(Box::new(object))).boxed()
        }
        T::DataValue => data_value(plain_scalar().prop_map(Variant::Scalar))
            .prop_map(|value| Scalar::DataValue(Box::new(value)))
            .boxed(),
        T::Variant => plain_scalar()
            .prop_map(|scalar| Scalar::Variant(Box::new(Variant::Scalar(scalar))))
            .boxed(),
        T::DiagnosticInfo => {
            diagnostic_info().prop_map(|info| Scalar::DiagnosticInfo(Box::new(info))).boxed()
        }
    }
}

fn expanded_node_id() -> impl Strategy<Value = ExpandedNodeId> {
    let server = prop_oneof![
        Just(Server::Local),
        (1_u32..).prop_map(Server::Index),
        arc_text().prop_map(Server::Uri)
    ];
    (node_id(), server).prop_map(|(node_id, server)| ExpandedNodeId { node_id, server })
}

fn qualified_name() -> impl Strategy<Value = QualifiedName> {
    let named = (namespace(), arc_text())
        .prop_map(|(namespace, name)| QualifiedName { namespace, name: Some(name) });
    prop_oneof![3 => named, 1 => Just(QualifiedName::default())]
}

/// A scalar of a type whose values contain no others.
pub(crate) fn plain_scalar() -> impl Strategy<Value = Scalar> {
    select(PLAIN.to_vec()).prop_flat_map(scalar_of)
}

/// A scalar, an array or a matrix of such a type.
pub(crate) fn plain_value() -> impl Strategy<Value = Variant> {
    let arrays = select(PLAIN.to_vec()).prop_flat_map(|known| array(known, scalar_of(known)));
    prop_oneof![plain_scalar().prop_map(Variant::Scalar), arrays]
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
        prop_oneof![
            data_value(array_of(inner.clone()))
                .prop_map(|value| Scalar::DataValue(Box::new(value))),
            array_of(inner).prop_map(|value| Scalar::Variant(Box::new(value))),
        ]
    })
}

/// An array or a matrix, each of whose elements is another one.
fn array(
    element_type: BuiltInType,
    element: BoxedStrategy<Scalar>,
) -> impl Strategy<Value = Variant> {
    let lengths = prop_oneof![(0_u32..5).prop_map(|length| vec![length]), vec(1_u32..4, 2..4)];
    lengths.prop_flat_map(move |lengths| {
        let count = lengths.iter().product::<u32>() as usize;
        vec(element.clone(), count).prop_map(move |elements| {
            let dimensions = (lengths.len() > 1).then(|| lengths.clone());
            Variant::Array(Arc::new(Array { element_type, elements, dimensions }))
        })
    })
}

/// A scalar, an array of one type, or one of variants, whose elements have types of their own.
pub(crate) fn array_of(
    scalar: impl Strategy<Value = Scalar> + Clone + 'static,
) -> impl Strategy<Value = Variant> {
    let uniform =
        select(BuiltInType::ALL.to_vec()).prop_flat_map(|known| array(known, scalar_of(known)));
    let variants = scalar.clone().prop_map(|scalar| match scalar {
        Scalar::Variant(_) => scalar,
        other => Scalar::Variant(Box::new(Variant::Scalar(other))),
    });
    let variants = prop_oneof![1 => Just(Scalar::Variant(Box::default())), 8 => variants];
    prop_oneof![
        8 => scalar.prop_map(Variant::Scalar),
        1 => uniform,
        1 => array(BuiltInType::Variant, variants.boxed()),
    ]
}

pub(crate) fn variant() -> impl Strategy<Value = Variant> {
    prop_oneof![1 => Just(Variant::Null), 20 => array_of(scalar().boxed())]
}

pub(crate) fn data_value(
    value: impl Strategy<Value = Variant>,
) -> impl Strategy<Value = DataValue> {
    let time = || (date_time(), 0_u16..10_000);
    (value, any::<u32>(), option::of(time()), option::of(time())).prop_map(
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
