//! Property: model -> stack -> OPC UA Binary -> stack -> model is the identity.

use std::{io::Cursor, sync::Arc};

use asi_model::values::{
    Array, BuiltInType, DataValue, DateTime, DiagnosticInfo, ExpandedNodeId, ExtensionBody,
    ExtensionObject, Identifier, LocalizedText, Namespace, NodeId, QualifiedName, Scalar, Server,
    StatusCode, Variant,
};
use opcua_stack::{
    NamespaceTable,
    opcua::types::{
        BinaryDecodable, BinaryEncodable, ContextOwned, DataValue as StackDataValue,
        DecodingOptions, NamespaceMap,
    },
    values::{ConversionError, from_stack, to_stack, variant_to_stack},
};
use proptest::prelude::*;
use uuid::Uuid;

fn table() -> NamespaceTable {
    NamespaceTable::new(["http://opcfoundation.org/UA/", "urn:server", "urn:press"])
}

fn text() -> impl Strategy<Value = Option<Arc<str>>> {
    proptest::option::of("\\PC{0,12}".prop_map(|text| Arc::from(text.as_str())))
}

/// The stack sends an empty part of a localized text as a null one.
fn not_empty(
    text: impl Strategy<Value = Option<Arc<str>>>,
) -> impl Strategy<Value = Option<Arc<str>>> {
    text.prop_map(|text| text.filter(|text| !text.is_empty()))
}

fn bytes() -> impl Strategy<Value = Arc<[u8]>> {
    proptest::collection::vec(any::<u8>(), 1..20).prop_map(Arc::from)
}

fn time() -> impl Strategy<Value = DateTime> {
    (1_i64..2_650_467_743_990_000_000).prop_map(DateTime::from_ticks)
}

fn namespace() -> impl Strategy<Value = Namespace> {
    prop_oneof![
        Just(Namespace::Ua),
        Just(Namespace::Uri("urn:server".into())),
        Just(Namespace::Uri("urn:press".into())),
        (10_u16..20).prop_map(Namespace::Index)
    ]
}

fn node_id() -> impl Strategy<Value = NodeId> {
    let identifier = prop_oneof![
        any::<u32>().prop_map(Identifier::Numeric),
        "\\PC{1,12}".prop_map(|id| Identifier::String(Arc::from(id.as_str()))),
        any::<u128>().prop_map(|id| Identifier::Guid(Uuid::from_u128(id))),
        bytes().prop_map(Identifier::Opaque),
    ];
    (namespace(), identifier).prop_map(|(namespace, identifier)| NodeId { namespace, identifier })
}

fn expanded_node_id() -> impl Strategy<Value = ExpandedNodeId> {
    let server = prop_oneof![Just(Server::Local), (1_u32..9).prop_map(Server::Index)];
    (node_id(), server, any::<bool>()).prop_map(|(mut node_id, server, is_foreign)| {
        if is_foreign {
            node_id.namespace = Namespace::Uri("urn:elsewhere".into());
        } else if server != Server::Local {
            // An index of the local table means nothing on another server.
            node_id.namespace = Namespace::Ua;
        }
        ExpandedNodeId { node_id, server }
    })
}

fn extension_object() -> impl Strategy<Value = ExtensionObject> {
    // An id of no known type, so that the bytes may be anything.
    let type_id = |id: u32| ExpandedNodeId {
        node_id: NodeId::numeric("urn:press", id),
        server: Server::Local,
    };
    prop_oneof![
        Just(ExtensionObject {
            type_id: ExpandedNodeId { node_id: NodeId::null(), server: Server::Local },
            body: ExtensionBody::None
        }),
        (any::<u32>(), bytes()).prop_map(move |(id, bytes)| ExtensionObject {
            type_id: type_id(id),
            body: ExtensionBody::Binary(bytes)
        }),
    ]
}

fn leaf(of: BuiltInType) -> BoxedStrategy<Scalar> {
    use BuiltInType as T;
    match of {
        T::Boolean => any::<bool>().prop_map(Scalar::Boolean).boxed(),
        T::SByte => any::<i8>().prop_map(Scalar::SByte).boxed(),
        T::Byte => any::<u8>().prop_map(Scalar::Byte).boxed(),
        T::Int16 => any::<i16>().prop_map(Scalar::Int16).boxed(),
        T::UInt16 => any::<u16>().prop_map(Scalar::UInt16).boxed(),
        T::Int32 => any::<i32>().prop_map(Scalar::Int32).boxed(),
        T::UInt32 => any::<u32>().prop_map(Scalar::UInt32).boxed(),
        T::Int64 => any::<i64>().prop_map(Scalar::Int64).boxed(),
        T::UInt64 => any::<u64>().prop_map(Scalar::UInt64).boxed(),
        T::Float => any::<f32>().prop_map(Scalar::Float).boxed(),
        T::Double => any::<f64>().prop_map(Scalar::Double).boxed(),
        T::String => text().prop_map(Scalar::String).boxed(),
        T::DateTime => time().prop_map(Scalar::DateTime).boxed(),
        T::Guid => any::<u128>().prop_map(|id| Scalar::Guid(Uuid::from_u128(id))).boxed(),
        T::ByteString => proptest::option::of(bytes()).prop_map(Scalar::ByteString).boxed(),
        T::XmlElement => text().prop_map(Scalar::XmlElement).boxed(),
        T::NodeId => node_id().prop_map(|id| Scalar::NodeId(Box::new(id))).boxed(),
        T::ExpandedNodeId => {
            expanded_node_id().prop_map(|id| Scalar::ExpandedNodeId(Box::new(id))).boxed()
        }
        T::StatusCode => any::<u32>().prop_map(|code| Scalar::StatusCode(StatusCode(code))).boxed(),
        T::QualifiedName => (namespace(), text())
            .prop_map(|(namespace, name)| {
                Scalar::QualifiedName(Box::new(QualifiedName { namespace, name }))
            })
            .boxed(),
        T::LocalizedText => (not_empty(text()), not_empty(text()))
            .prop_map(|(locale, text)| {
                Scalar::LocalizedText(Box::new(LocalizedText { locale, text }))
            })
            .boxed(),
        T::ExtensionObject => {
            extension_object().prop_map(|object| Scalar::ExtensionObject(Box::new(object))).boxed()
        }
        T::DataValue => (leaf(T::Double), time())
            .prop_map(|(value, at)| Scalar::DataValue(Box::new(DataValue::good(value, at))))
            .boxed(),
        T::Variant => {
            leaf(T::Int64).prop_map(|value| Scalar::Variant(Box::new(value.into()))).boxed()
        }
        T::DiagnosticInfo => (any::<Option<i32>>(), any::<Option<u32>>())
            .prop_map(|(symbolic_id, status)| {
                let inner = DiagnosticInfo { locale: Some(3), ..DiagnosticInfo::default() };
                Scalar::DiagnosticInfo(Box::new(DiagnosticInfo {
                    symbolic_id,
                    inner_status_code: status.map(StatusCode),
                    inner_diagnostic_info: Some(Box::new(inner)),
                    ..DiagnosticInfo::default()
                }))
            })
            .boxed(),
    }
}

fn array(of: BuiltInType) -> impl Strategy<Value = Variant> {
    let plain =
        proptest::collection::vec(leaf(of), 0..5).prop_map(move |elements| (elements, None));
    let matrix = proptest::collection::vec(leaf(of), 6)
        .prop_map(move |elements| (elements, Some(vec![2, 3])));
    prop_oneof![plain, matrix].prop_map(move |(elements, dimensions)| {
        Variant::Array(Arc::new(Array { element_type: of, elements, dimensions }))
    })
}

fn variant() -> impl Strategy<Value = Variant> {
    prop_oneof![
        1 => Just(Variant::Null),
        10 => proptest::sample::select(BuiltInType::ALL.to_vec()).prop_flat_map(|of| {
            // A variant never holds a variant directly.
            let scalar = if of == BuiltInType::Variant { BuiltInType::String } else { of };
            prop_oneof![leaf(scalar).prop_map(Variant::Scalar), array(of)]
        }),
    ]
}

fn data_value() -> impl Strategy<Value = DataValue> {
    (
        variant(),
        any::<u32>(),
        proptest::option::of(time()),
        0_u16..10_000,
        proptest::option::of(time()),
        0_u16..10_000,
    )
        .prop_map(|(value, status, source, source_picoseconds, server, server_picoseconds)| {
            DataValue {
                value,
                status: StatusCode(status),
                source_timestamp: source,
                // Without a time its picoseconds mean nothing and do not travel.
                source_picoseconds: if source.is_some() { source_picoseconds } else { 0 },
                server_timestamp: server,
                server_picoseconds: if server.is_some() { server_picoseconds } else { 0 },
            }
        })
}

fn over_the_wire(value: &StackDataValue) -> StackDataValue {
    let mut namespaces = NamespaceMap::new();
    namespaces.add_namespace("urn:server");
    namespaces.add_namespace("urn:press");
    let context = ContextOwned::new_default(namespaces, DecodingOptions::default());
    let mut bytes = Vec::new();
    value.encode(&mut bytes, &context.context()).expect("encodes");
    StackDataValue::decode(&mut Cursor::new(bytes), &context.context()).expect("decodes")
}

proptest! {
    #[test]
    fn every_value_survives_the_wire(value in data_value()) {
        let stack = to_stack(&value, &table()).expect("converts");
        let back = from_stack(over_the_wire(&stack), &table());
        // NaN differs from itself; its text does not.
        prop_assert_eq!(format!("{back:?}"), format!("{value:?}"));
    }
}

#[test]
fn what_the_peer_cannot_understand_is_refused() {
    let check = |value: Variant, expected: ConversionError| {
        assert_eq!(variant_to_stack(&value, &table()).expect_err("must be refused"), expected);
    };
    check(
        Variant::Scalar(Scalar::NodeId(Box::new(NodeId::string("urn:lathe", "Counter")))),
        ConversionError::UnknownNamespace { uri: "urn:lathe".into() },
    );
    check(
        Variant::Array(Arc::new(Array {
            element_type: BuiltInType::Int32,
            elements: vec![Scalar::Int32(1), Scalar::Double(2.0)],
            dimensions: None,
        })),
        ConversionError::InvalidArray,
    );
    check(
        Variant::Array(Arc::new(Array {
            element_type: BuiltInType::Int32,
            elements: vec![Scalar::Int32(1)],
            dimensions: Some(vec![u32::MAX, u32::MAX, u32::MAX]),
        })),
        ConversionError::InvalidArray,
    );
    let mut nested = Variant::from(1_i32);
    for _ in 0..100 {
        nested = Variant::Scalar(Scalar::Variant(Box::new(nested)));
    }
    check(nested, ConversionError::TooDeep);
}
