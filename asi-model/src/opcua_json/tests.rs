//! Verdicts on fixtures, and round trips of random values.

use std::sync::Arc;

use proptest::prelude::*;

use super::{
    arbitrary::{data_value, described, plain_scalar, range, structure_of, variant},
    *,
};
use crate::values::{
    Array, BuiltInType, ExpandedNodeId, ExtensionBody, ExtensionObject, LocalizedText, Namespace,
    NodeId, QualifiedName, Scalar, Server,
};

fn read(text: &str, leniency: Leniency) -> Result<(DecodedValue, Vec<Diagnostic>), ValueError> {
    decode_value(text.as_bytes(), leniency, &[], &[])
}

/// The verdict table of the foreign stacks' comparison, as far as it is about us.
#[test]
fn fixtures_have_their_verdicts() {
    #[derive(Debug, PartialEq)]
    enum Verdict {
        Accepted,
        Noted,
        Rejected,
    }
    use Verdict::{Accepted as A, Noted as W, Rejected as R};
    let range = r#""Low":0,"High":359.99"#;
    for (text, strict, lenient) in [
        (r#"{"Type":12,"Body":"ProgressReport"}"#, A, A),
        (r#"{"Type":9,"Body":"1"}"#, A, A),
        (r#"{"Type":9,"Body":1}"#, R, W),
        (r#"{"Type":1,"Body":"false"}"#, R, W),
        (r#"{"Type":1,"Body":"no"}"#, R, R),
        (r#"{"UaType":9,"Value":"1"}"#, A, A),
        (r#"{"UaType":9,"Value":1}"#, R, W),
        (r#"{"UaType":7,"Value":"1"}"#, R, R),
        (r#"{"UaType":6,"Value":"1"}"#, R, R),
        (r#"{"UaType":6,"Value":"_1"}"#, R, R),
        (r#"{"UaType":6,"Value":"AUTOMATIC_3"}"#, A, A),
        (r#"{"UaType":11,"Value":"NaN"}"#, A, A),
        (r#"{"UaType":6,"Value":[1,2,3,4],"Dimensions":[2,2]}"#, A, A),
        (r#"{"UaType":6,"Value":[1,2,3],"Dimensions":[2,2]}"#, R, R),
        (r#"{"UaType":6,"Value":[],"Dimensions":[4294967295,4294967295,4294967295]}"#, R, R),
        (&format!(r#"{{"UaType":22,"Value":{{"UaTypeId":"i=884",{range}}}}}"#), A, A),
        (&format!(r#"{{"Type":22,"Body":{{"TypeId":{{"Id":884}},"Body":{{{range}}}}}}}"#), A, A),
        (&format!(r#"{{"Type":22,"Body":{{"TypeId":{{"Id":15375}},"Body":{{{range}}}}}}}"#), A, A),
        (&format!(r#"{{"Type":22,"Body":{{"TypeId":{{"Id":886}},"Body":{{{range}}}}}}}"#), A, A),
        (r#"{"Type":22,"Body":{"TypeId":{"Id":884},"Body":{"low":0,"high":359.99}}}"#, R, W),
        (
            r#"{"Value":{"Type":11,"Body":12.3},"SourceTimestamp":"2019-03-26T18:28:54.2940194Z"}"#,
            A,
            A,
        ),
        (r#"{"UaType":11,"Value":12.3,"SourceTimestamp":"2019-03-26T18:28:54.2940194Z"}"#, A, A),
        (r#"{"Value":12.3,"SourceTimestamp":"2019-03-26T18:28:54.2940194Z"}"#, W, W),
        (r#"{"SourceTimestamp":"2019-03-26T20:28:54+02:00","UaType":11,"Value":1}"#, A, A),
        (r#"{"Type":3,"Body":256}"#, R, R),
        (r#"{"Type":6,"Body":1.0}"#, R, R),
        (r#"{"Type":9,"Body":"18446744073709551615"}"#, A, A),
        (r#"{"Type":9,"Body":"18446744073709551616"}"#, R, R),
        (r#"{"Type":9,"Body":"+1"}"#, R, R),
        (r#"{"Type":10,"Body":1e39}"#, R, R),
        (r#"{"Type":11,"Body":1e309}"#, R, R),
        (r#"{"Type":26,"Body":1}"#, R, R),
        (r#"{"Type":0}"#, A, A),
        (r#"{"UaType":12}"#, A, A),
        (r#"{"Type":17,"Body":"nsu=urn:x;s=a"}"#, A, A),
        (r#"{"Type":17,"Body":{"IdType":4,"Id":"a"}}"#, R, R),
        (r#"{"Type":14,"Body":"{72962b91-fa75-4ae6-8d28-b404dc7daf63}"}"#, R, R),
        (r#"{"Type":14,"Body":"72962B91-FA75-4AE6-8D28-B404DC7DAF63"}"#, A, A),
        (r#"{"Type":12,"Body":"a","Type":12}"#, R, R),
        (&format!("{}1{}", r#"{"Type":24,"Body":"#.repeat(200), "}".repeat(200)), R, R),
    ] {
        let verdict = |leniency| match read(text, leniency) {
            Ok((_, notes)) if notes.is_empty() => A,
            Ok(_) => W,
            Err(_) => R,
        };
        assert_eq!(verdict(Leniency::Strict), strict, "strict: {text}");
        assert_eq!(verdict(Leniency::Lenient), lenient, "lenient: {text}");
    }
}

#[test]
fn every_type_is_written_as_the_table_says() {
    let text = |text: &str| Some(Arc::<str>::from(text));
    let localized = LocalizedText { locale: text("en"), text: text("t") };
    let node = NodeId::string("urn:x", "abc");
    let name = QualifiedName { namespace: Namespace::uri("urn:x"), name: text("n") };
    let status = StatusCode::BAD_INVALID_ARGUMENT;
    let range = range(0.0, 9.0);
    for (scalar, reversible, non_reversible, compact, verbose) in [
        (Scalar::Boolean(true), "true", "true", "true", "true"),
        (Scalar::SByte(-1), "-1", "-1", "-1", "-1"),
        (Scalar::Int64(-5), "\"-5\"", "\"-5\"", "\"-5\"", "\"-5\""),
        (
            Scalar::Double(f64::NEG_INFINITY),
            "\"-Infinity\"",
            "\"-Infinity\"",
            "\"-Infinity\"",
            "\"-Infinity\"",
        ),
        (Scalar::String(None), "null", "null", "null", "null"),
        (
            Scalar::ByteString(Some(Arc::from(*b"abc"))),
            "\"YWJj\"",
            "\"YWJj\"",
            "\"YWJj\"",
            "\"YWJj\"",
        ),
        (
            Scalar::NodeId(Box::new(node.clone())),
            r#"{"IdType":1,"Id":"abc","Namespace":"urn:x"}"#,
            r#"{"IdType":1,"Id":"abc","Namespace":"urn:x"}"#,
            r#""nsu=urn:x;s=abc""#,
            r#""nsu=urn:x;s=abc""#,
        ),
        (
            Scalar::ExpandedNodeId(Box::new(ExpandedNodeId {
                node_id: NodeId::numeric("urn:x", 5),
                server: Server::Uri("urn:srv".into()),
            })),
            r#"{"Id":5,"Namespace":"urn:x","ServerUri":"urn:srv"}"#,
            r#"{"Id":5,"Namespace":"urn:x","ServerUri":"urn:srv"}"#,
            r#""svu=urn:srv;nsu=urn:x;i=5""#,
            r#""svu=urn:srv;nsu=urn:x;i=5""#,
        ),
        (
            Scalar::StatusCode(status),
            "2158690304",
            r#"{"Code":2158690304,"Symbol":"BadInvalidArgument"}"#,
            r#"{"Code":2158690304}"#,
            r#"{"Code":2158690304,"Symbol":"BadInvalidArgument"}"#,
        ),
        (Scalar::StatusCode(StatusCode::GOOD), "0", "{}", "{}", "{}"),
        (
            Scalar::QualifiedName(Box::new(name)),
            r#"{"Name":"n","Uri":"urn:x"}"#,
            r#"{"Name":"n","Uri":"urn:x"}"#,
            r#""nsu=urn:x;n""#,
            r#""nsu=urn:x;n""#,
        ),
        (
            Scalar::LocalizedText(Box::new(localized)),
            r#"{"Locale":"en","Text":"t"}"#,
            r#""t""#,
            r#"{"Locale":"en","Text":"t"}"#,
            r#"{"Locale":"en","Text":"t"}"#,
        ),
        (
            Scalar::ExtensionObject(Box::new(range)),
            r#"{"TypeId":{"Id":884},"Body":{"Low":0,"High":9}}"#,
            r#"{"Low":0,"High":9}"#,
            r#"{"UaTypeId":"i=884","Low":0,"High":9}"#,
            r#"{"UaTypeId":"i=884","Low":0,"High":9}"#,
        ),
        (
            Scalar::ExtensionObject(Box::new(ExtensionObject {
                type_id: node.into(),
                body: ExtensionBody::Binary(Arc::from(*b"abc")),
            })),
            r#"{"TypeId":{"IdType":1,"Id":"abc","Namespace":"urn:x"},"Encoding":1,"Body":"YWJj"}"#,
            r#""YWJj""#,
            r#"{"UaTypeId":"nsu=urn:x;s=abc","UaEncoding":1,"UaBody":"YWJj"}"#,
            r#"{"UaTypeId":"nsu=urn:x;s=abc","UaEncoding":1,"UaBody":"YWJj"}"#,
        ),
    ] {
        for (encoding, expected) in [
            (DataEncoding::Reversible104, reversible),
            (DataEncoding::NonReversible104, non_reversible),
            (DataEncoding::Compact105, compact),
            (DataEncoding::Verbose105, verbose),
        ] {
            let mut out = Vec::new();
            Encoder::new(encoding).scalar(&mut out, &scalar);
            assert_eq!(String::from_utf8_lossy(&out), expected, "{encoding:?}");
        }
    }
}

#[test]
fn matrices_nest_or_lie_flat() {
    let matrix = Variant::Array(Arc::new(Array {
        element_type: BuiltInType::Int32,
        elements: (1..=6).map(Scalar::Int32).collect(),
        dimensions: Some(vec![2, 3]),
    }));
    for (encoding, expected) in [
        (DataEncoding::Reversible104, r#"{"Type":6,"Body":[1,2,3,4,5,6],"Dimensions":[2,3]}"#),
        (DataEncoding::NonReversible104, "[[1,2,3],[4,5,6]]"),
        (DataEncoding::Compact105, r#"{"UaType":6,"Value":[1,2,3,4,5,6],"Dimensions":[2,3]}"#),
    ] {
        assert_eq!(String::from_utf8(encode_variant(&matrix, encoding)), Ok(expected.to_owned()));
    }
    let (value, _) =
        read(r#"{"Type":6,"Body":[[1,2,3],[4,5,6]]}"#, Leniency::Lenient).expect("a matrix");
    assert_eq!(value, DecodedValue::Variant(matrix));
    assert!(read(r#"{"Type":6,"Body":[[1,2,3],[4,5]]}"#, Leniency::Lenient).is_err());
}

#[test]
fn namespaces_travel_as_indexes_where_a_table_is_known() {
    let table: Vec<Arc<str>> = vec!["urn:a".into(), "urn:b".into()];
    let id = Variant::Scalar(Scalar::NodeId(Box::new(NodeId::string("urn:b", "x"))));
    let mut out = Vec::new();
    Encoder::described(DataEncoding::Reversible104, &table, &[]).variant(&mut out, &id);
    assert_eq!(
        String::from_utf8_lossy(&out),
        r#"{"Type":17,"Body":{"IdType":1,"Id":"x","Namespace":2}}"#
    );
    let (value, _) = decode_value(&out, Leniency::Strict, &[], &table).expect("a value");
    assert_eq!(value, DecodedValue::Variant(id));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn variants_read_back(value in variant()) {
        let types = described();
        for encoding in [DataEncoding::Reversible104, DataEncoding::Compact105, DataEncoding::Verbose105] {
            let mut out = Vec::new();
            Encoder::described(encoding, &[], &types).variant(&mut out, &value);
            let (found, notes) = decode_value(&out, Leniency::Strict, &types, &[])
                .map_err(|error| TestCaseError::fail(format!("{error}: {}", String::from_utf8_lossy(&out))))?;
            let found = match found {
                DecodedValue::Variant(found) | DecodedValue::Bare(found) => found,
                DecodedValue::DataValue(_) => return Err(TestCaseError::fail("a data value")),
            };
            prop_assert_eq!(&found, &value, "{:?} {}", encoding, String::from_utf8_lossy(&out));
            prop_assert_eq!(notes, vec![]);
        }
    }

    #[test]
    fn data_values_read_back(value in data_value(variant())) {
        let types = described();
        for encoding in [DataEncoding::Reversible104, DataEncoding::Compact105, DataEncoding::Verbose105] {
            let mut out = Vec::new();
            Encoder::described(encoding, &[], &types).data_value(&mut out, &value);
            let tape = Tape::read(&out, LIMITS).expect("our own JSON");
            let found = Decoder::new(Leniency::Strict, &types, &[]).data_value(tape.root());
            let found = found.map_err(|mismatch| TestCaseError::fail(mismatch.into_error().to_string()))?;
            prop_assert_eq!(&found, &value, "{:?} {}", encoding, String::from_utf8_lossy(&out));
        }
    }

    /// Bare values need their type, and lose locales and the types of what may be anything.
    #[test]
    fn bare_values_read_back_with_their_type(scalar in plain_scalar()) {
        let types = described();
        let built_in_type = scalar.built_in_type();
        let data_type = NodeId::ua(u32::from(built_in_type.id()));
        let hint = decode::TypeHint { built_in_type, data_type: &data_type, value_rank: -1 };
        for encoding in [DataEncoding::NonReversible104, DataEncoding::Verbose105] {
            let mut out = Vec::new();
            Encoder::described(encoding, &[], &types).scalar(&mut out, &scalar);
            let tape = Tape::read(&out, LIMITS).expect("our own JSON");
            let found = Decoder::new(Leniency::Strict, &types, &[]).bare(tape.root(), hint);
            let found = found.map_err(|mismatch| TestCaseError::fail(mismatch.into_error().to_string()))?;
            let mut expected = Variant::Scalar(scalar.clone());
            if encoding == DataEncoding::NonReversible104 && let Scalar::LocalizedText(text) = &scalar {
                let kept = LocalizedText { locale: None, text: text.text.clone() };
                expected = Variant::Scalar(Scalar::LocalizedText(Box::new(kept)));
            }
            // A null is null, whatever its type.
            if out == b"null" {
                expected = Variant::Null;
            }
            prop_assert_eq!(found, expected, "{:?} {}", encoding, String::from_utf8_lossy(&out));
        }
    }

    #[test]
    fn any_text_is_met_without_panic(text in ".{0,60}", json in json_like()) {
        for text in [text, json] {
            let _ = read(&text, Leniency::Lenient);
            let _ = read(&text, Leniency::Strict);
            let _ = crate::pubsub::json::decode(text.as_bytes());
            let _ = crate::validation::parse_any_platform_message(text.as_bytes());
            let _ = crate::validation::parse_factory_message(text.as_bytes());
        }
    }
}

/// JSON made of the words of this encoding.
fn json_like() -> impl Strategy<Value = String> {
    let word = prop_oneof![
        Just("Type"),
        Just("Body"),
        Just("UaType"),
        Just("Value"),
        Just("UaTypeId"),
        Just("TypeId"),
        Just("Dimensions"),
        Just("Payload"),
        Just("Messages"),
        Just("MessageType"),
        Just("Status"),
        Just("Id"),
        Just("Array"),
        Just("MetaData"),
        Just("Fields"),
        Just("SourceTimestamp"),
        Just("UaBody"),
        Just("UaEncoding"),
    ];
    let leaf = prop_oneof![
        Just("null".to_owned()),
        Just("true".to_owned()),
        (-30_i32..30).prop_map(|number| number.to_string()),
        word.clone().prop_map(|word| format!("{word:?}")),
        Just("\"ua-data\"".to_owned()),
        Just("\"i=884\"".to_owned()),
        Just("1e400".to_owned()),
    ];
    leaf.prop_recursive(6, 60, 6, move |inner| {
        prop_oneof![
            proptest::collection::vec(inner.clone(), 0..5)
                .prop_map(|list| format!("[{}]", list.join(","))),
            proptest::collection::vec((word.clone(), inner), 0..6).prop_map(|members| {
                let members: Vec<String> =
                    members.into_iter().map(|(name, value)| format!("{name:?}:{value}")).collect();
                format!("{{{}}}", members.join(","))
            }),
        ]
    })
}

/// Frozen texts of structures, which no foreign decoder of 1.05 reads as the standard writes them.
#[test]
fn enumerations_in_structures_have_names_for_people() {
    use crate::values::{EnumType, EnumValue, StructureField, StructureKind};
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
        let encodings = [
            DataEncoding::Reversible104,
            DataEncoding::NonReversible104,
            DataEncoding::Compact105,
            DataEncoding::Verbose105,
        ];
        for (encoding, expected) in encodings.into_iter().zip(texts) {
            let mut out = Vec::new();
            Encoder::described(encoding, &[], &types).extension_object(&mut out, &object);
            assert_eq!(String::from_utf8_lossy(&out), expected, "{encoding:?}");
        }
    }
}
