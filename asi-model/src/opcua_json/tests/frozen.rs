//! Frozen texts of all four forms, where no foreign decoder could tell a difference.

use std::sync::Arc;

use super::super::{
    arbitrary::{described, range, structure_of},
    *,
};
use crate::values::{
    Array, BuiltInType, EnumType, EnumValue, ExpandedNodeId, ExtensionBody, ExtensionObject,
    LocalizedText, Namespace, NodeId, QualifiedName, Scalar, Server, StructureField, StructureKind,
};

const ENCODINGS: [DataEncoding; 4] = [
    DataEncoding::Reversible104,
    DataEncoding::NonReversible104,
    DataEncoding::Compact105,
    DataEncoding::Verbose105,
];

/// Scalars with their texts: 1.04 reversible and non-reversible, 1.05 Compact and Verbose.
fn frozen_scalars() -> Vec<(Scalar, [&'static str; 4])> {
    let text = |text: &str| Some(Arc::<str>::from(text));
    let localized = LocalizedText { locale: text("en"), text: text("t") };
    let node = NodeId::string("urn:x", "abc");
    let name = QualifiedName { namespace: Namespace::uri("urn:x"), name: text("n") };
    let status = StatusCode::BAD_INVALID_ARGUMENT;
    vec![
        (Scalar::Boolean(true), ["true"; 4]),
        (Scalar::SByte(-1), ["-1"; 4]),
        (Scalar::Int64(-5), ["\"-5\""; 4]),
        (Scalar::Double(f64::NEG_INFINITY), ["\"-Infinity\""; 4]),
        (Scalar::String(None), ["null"; 4]),
        (Scalar::ByteString(Some(Arc::from(*b"abc"))), ["\"YWJj\""; 4]),
        (
            Scalar::NodeId(Box::new(node.clone())),
            [
                r#"{"IdType":1,"Id":"abc","Namespace":"urn:x"}"#,
                r#"{"IdType":1,"Id":"abc","Namespace":"urn:x"}"#,
                r#""nsu=urn:x;s=abc""#,
                r#""nsu=urn:x;s=abc""#,
            ],
        ),
        (
            Scalar::ExpandedNodeId(Box::new(ExpandedNodeId {
                node_id: NodeId::numeric("urn:x", 5),
                server: Server::Uri("urn:srv".into()),
            })),
            [
                r#"{"Id":5,"Namespace":"urn:x","ServerUri":"urn:srv"}"#,
                r#"{"Id":5,"Namespace":"urn:x","ServerUri":"urn:srv"}"#,
                r#""svu=urn:srv;nsu=urn:x;i=5""#,
                r#""svu=urn:srv;nsu=urn:x;i=5""#,
            ],
        ),
        (
            Scalar::StatusCode(status),
            [
                "2158690304",
                r#"{"Code":2158690304,"Symbol":"BadInvalidArgument"}"#,
                r#"{"Code":2158690304}"#,
                r#"{"Code":2158690304,"Symbol":"BadInvalidArgument"}"#,
            ],
        ),
        (Scalar::StatusCode(StatusCode::GOOD), ["0", "{}", "{}", "{}"]),
        (
            Scalar::QualifiedName(Box::new(name)),
            [
                r#"{"Name":"n","Uri":"urn:x"}"#,
                r#"{"Name":"n","Uri":"urn:x"}"#,
                r#""nsu=urn:x;n""#,
                r#""nsu=urn:x;n""#,
            ],
        ),
        (
            Scalar::LocalizedText(Box::new(localized)),
            [
                r#"{"Locale":"en","Text":"t"}"#,
                r#""t""#,
                r#"{"Locale":"en","Text":"t"}"#,
                r#"{"Locale":"en","Text":"t"}"#,
            ],
        ),
    ]
}

/// Texts like [`frozen_scalars`], of extension objects.
fn frozen_objects() -> Vec<(ExtensionObject, [&'static str; 4])> {
    let binary = ExtensionObject {
        type_id: NodeId::string("urn:x", "abc").into(),
        body: ExtensionBody::Binary(Arc::from(*b"abc")),
    };
    vec![
        (
            range(0.0, 9.0),
            [
                r#"{"TypeId":{"Id":884},"Body":{"Low":0,"High":9}}"#,
                r#"{"Low":0,"High":9}"#,
                r#"{"UaTypeId":"i=884","Low":0,"High":9}"#,
                r#"{"UaTypeId":"i=884","Low":0,"High":9}"#,
            ],
        ),
        (
            binary,
            [
                concat!(
                    r#"{"TypeId":{"IdType":1,"Id":"abc","Namespace":"urn:x"},"#,
                    r#""Encoding":1,"Body":"YWJj"}"#
                ),
                r#""YWJj""#,
                r#"{"UaTypeId":"nsu=urn:x;s=abc","UaEncoding":1,"UaBody":"YWJj"}"#,
                r#"{"UaTypeId":"nsu=urn:x;s=abc","UaEncoding":1,"UaBody":"YWJj"}"#,
            ],
        ),
    ]
}

#[test]
fn every_type_is_written_as_the_table_says() {
    let objects = frozen_objects()
        .into_iter()
        .map(|(object, texts)| (Scalar::ExtensionObject(Box::new(object)), texts));
    for (scalar, texts) in frozen_scalars().into_iter().chain(objects) {
        for (encoding, expected) in ENCODINGS.into_iter().zip(texts) {
            let mut out = Vec::new();
            Encoder::new(encoding).scalar(&mut out, &scalar);
            assert_eq!(String::from_utf8_lossy(&out), expected, "{encoding:?}");
        }
    }
}

// No foreign decoder of 1.05 reads these as the standard writes them.
#[test]
fn enumerations_in_structures_have_names_for_people() {
    let mode = NodeId::string("urn:types", "Mode");
    let types = [StructureType {
        type_id: NodeId::string("urn:types", "State"),
        encoding_ids: Vec::new(),
        name: "State".into(),
        kind: StructureKind::Plain,
        fields: vec![
            StructureField {
                data_type: mode.clone(),
                ..StructureField::scalar("Mode", BuiltInType::Int32)
            },
            StructureField {
                data_type: mode.clone(),
                ..StructureField::scalar("Past", BuiltInType::Int32).array()
            },
            StructureField::scalar("Count", BuiltInType::Int32),
        ],
    }];
    let automatic = EnumValue { value: 3, name: "AUTO_MATIC".into(), ..EnumValue::default() };
    let enum_types = [EnumType {
        type_id: mode,
        name: "Mode".into(),
        built_in_type: BuiltInType::Int32,
        values: vec![automatic],
    }];
    let past = Array {
        element_type: BuiltInType::Int32,
        elements: vec![3.into(), (-7).into()],
        dimensions: None,
    };
    let values = vec![3.into(), Variant::Array(Arc::new(past)), 3.into()];
    let state = structure_of(&types[0], values, 0, 0);
    let value = Variant::Scalar(Scalar::ExtensionObject(Box::new(state)));
    for (encoding, expected) in [
        (DataEncoding::Reversible104, r#""Body":{"Mode":3,"Past":[3,-7],"Count":3}"#),
        (DataEncoding::Compact105, r#""Mode":3,"Past":[3,-7],"Count":3"#),
        (DataEncoding::Verbose105, r#""Mode":"AUTO_MATIC_3","Past":["AUTO_MATIC_3",-7],"Count":3"#),
    ] {
        let mut out = Vec::new();
        Encoder::described(encoding, &[], &types)
            .with_enum_types(&enum_types)
            .variant(&mut out, &value);
        let text = String::from_utf8_lossy(&out);
        assert!(text.contains(expected), "{text}");
        let (found, notes) =
            decode_value(&out, Leniency::Strict, &types, &[]).expect("our own value");
        assert_eq!((found, notes), (DecodedValue::Variant(value.clone()), vec![]), "{text}");
    }
}

#[test]
fn structures_are_written_as_frozen() {
    let types = described();
    let text = |text: &str| Variant::Scalar(Scalar::String(Some(text.into())));
    let range_value = || Variant::Scalar(Scalar::ExtensionObject(Box::new(range(0.0, 9.0))));
    let any = Variant::Scalar(Scalar::Variant(Box::new(7_u64.into())));
    let numbers = Variant::Array(Arc::new(Array {
        element_type: BuiltInType::Int64,
        elements: vec![Scalar::Int64(-1)],
        dimensions: None,
    }));
    for (object, texts) in [
        (
            structure_of(&types[1], vec![1.into(), text("b"), 2_u64.into()], 0b10, 0),
            [
                r#"{"TypeId":{"IdType":1,"Id":"Optional","Namespace":"urn:types"},"Body":{"EncodingMask":2,"B":"b","C":"2"}}"#,
                r#"{"B":"b","C":"2"}"#,
                r#"{"UaTypeId":"nsu=urn:types;s=Optional","EncodingMask":2,"B":"b","C":"2"}"#,
                r#"{"UaTypeId":"nsu=urn:types;s=Optional","B":"b","C":"2"}"#,
            ],
        ),
        (
            structure_of(&types[2], vec![1.into(), text("t")], 0, 2),
            [
                r#"{"TypeId":{"IdType":1,"Id":"Union","Namespace":"urn:types"},"Body":{"SwitchField":2,"Value":"t"}}"#,
                r#""t""#,
                r#"{"UaTypeId":"nsu=urn:types;s=Union","SwitchField":2,"Text":"t"}"#,
                r#"{"UaTypeId":"nsu=urn:types;s=Union","Text":"t"}"#,
            ],
        ),
        (
            structure_of(&types[3], vec![range_value(), any, range_value(), numbers], 0, 0),
            [
                concat!(
                    r#"{"TypeId":{"IdType":1,"Id":"Nested","Namespace":"urn:types"},"Body":{"Range":{"Low":0,"High":9},"#,
                    r#""Any":{"Type":9,"Body":"7"},"Object":{"TypeId":{"Id":884},"Body":{"Low":0,"High":9}},"Numbers":["-1"]}}"#
                ),
                r#"{"Range":{"Low":0,"High":9},"Any":"7","Object":{"Low":0,"High":9},"Numbers":["-1"]}"#,
                concat!(
                    r#"{"UaTypeId":"nsu=urn:types;s=Nested","Range":{"Low":0,"High":9},"Any":{"UaType":9,"Value":"7"},"#,
                    r#""Object":{"UaTypeId":"i=884","Low":0,"High":9},"Numbers":["-1"]}"#
                ),
                concat!(
                    r#"{"UaTypeId":"nsu=urn:types;s=Nested","Range":{"Low":0,"High":9},"Any":{"UaType":9,"Value":"7"},"#,
                    r#""Object":{"UaTypeId":"i=884","Low":0,"High":9},"Numbers":["-1"]}"#
                ),
            ],
        ),
    ] {
        for (encoding, expected) in ENCODINGS.into_iter().zip(texts) {
            let mut out = Vec::new();
            Encoder::described(encoding, &[], &types).extension_object(&mut out, &object);
            assert_eq!(String::from_utf8_lossy(&out), expected, "{encoding:?}");
        }
    }
}
