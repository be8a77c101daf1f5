//! Verdicts on fixtures, and round trips of random values.

use std::sync::Arc;

use proptest::prelude::*;
use uuid::Uuid;

use super::*;
use crate::values::{
    Array, BuiltInType, DateTime, DiagnosticInfo, ExpandedNodeId, ExtensionBody, ExtensionObject, Identifier,
    LocalizedText, Namespace, NodeId, QualifiedName, Scalar, Server, StructureField, StructureKind, StructureValue,
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
        (r#"{"UaType":11,"Value":"NaN"}"#, A, A),
        (r#"{"UaType":6,"Value":[1,2,3,4],"Dimensions":[2,2]}"#, A, A),
        (r#"{"UaType":6,"Value":[1,2,3],"Dimensions":[2,2]}"#, R, R),
        (r#"{"UaType":6,"Value":[],"Dimensions":[4294967295,4294967295,4294967295]}"#, R, R),
        (&format!(r#"{{"UaType":22,"Value":{{"UaTypeId":"i=884",{range}}}}}"#), A, A),
        (&format!(r#"{{"Type":22,"Body":{{"TypeId":{{"Id":884}},"Body":{{{range}}}}}}}"#), A, A),
        (&format!(r#"{{"Type":22,"Body":{{"TypeId":{{"Id":15375}},"Body":{{{range}}}}}}}"#), A, A),
        (&format!(r#"{{"Type":22,"Body":{{"TypeId":{{"Id":886}},"Body":{{{range}}}}}}}"#), A, A),
        (r#"{"Type":22,"Body":{"TypeId":{"Id":884},"Body":{"low":0,"high":359.99}}}"#, R, W),
        (r#"{"Value":{"Type":11,"Body":12.3},"SourceTimestamp":"2019-03-26T18:28:54.2940194Z"}"#, A, A),
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
        (Scalar::Double(f64::NEG_INFINITY), "\"-Infinity\"", "\"-Infinity\"", "\"-Infinity\"", "\"-Infinity\""),
        (Scalar::String(None), "null", "null", "null", "null"),
        (Scalar::ByteString(Some(Arc::from(*b"abc"))), "\"YWJj\"", "\"YWJj\"", "\"YWJj\"", "\"YWJj\""),
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

fn range(low: f64, high: f64) -> ExtensionObject {
    let mut structure = StructureValue::default();
    structure.fields.insert("Low".into(), low.into());
    structure.fields.insert("High".into(), high.into());
    ExtensionObject { type_id: NodeId::ua(884).into(), body: ExtensionBody::Structure(structure) }
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
    let (value, _) = read(r#"{"Type":6,"Body":[[1,2,3],[4,5,6]]}"#, Leniency::Lenient).expect("a matrix");
    assert_eq!(value, DecodedValue::Variant(matrix));
    assert!(read(r#"{"Type":6,"Body":[[1,2,3],[4,5]]}"#, Leniency::Lenient).is_err());
}

#[test]
fn namespaces_travel_as_indexes_where_a_table_is_known() {
    let table: Vec<Arc<str>> = vec!["urn:a".into(), "urn:b".into()];
    let id = Variant::Scalar(Scalar::NodeId(Box::new(NodeId::string("urn:b", "x"))));
    let mut out = Vec::new();
    Encoder::described(DataEncoding::Reversible104, &table, &[]).variant(&mut out, &id);
    assert_eq!(String::from_utf8_lossy(&out), r#"{"Type":17,"Body":{"IdType":1,"Id":"x","Namespace":2}}"#);
    let (value, _) = decode_value(&out, Leniency::Strict, &[], &table).expect("a value");
    assert_eq!(value, DecodedValue::Variant(id));
}

/// Structures of every kind, beside those of namespace 0.
fn described() -> Vec<StructureType> {
    let structure = |id: &str, kind, fields| StructureType {
        type_id: NodeId::string("urn:types", id),
        encoding_ids: Vec::new(),
        name: id.into(),
        kind,
        fields,
    };
    use BuiltInType as T;
    let power = ["SecondsAggregated", "WattsMin", "WattsMax"].map(|name| StructureField::scalar(name, T::Double));
    let optional = vec![
        StructureField { is_optional: true, ..StructureField::scalar("A", T::Int32) },
        StructureField::scalar("B", T::String),
        StructureField { is_optional: true, ..StructureField::scalar("C", T::UInt64) },
    ];
    let union = vec![StructureField::scalar("Number", T::Int32), StructureField::scalar("Text", T::String)];
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

fn arc_text() -> impl Strategy<Value = Arc<str>> {
    prop_oneof![any::<String>(), "[a-z:;%=#/0-9]{0,8}"].prop_map(Arc::from)
}

fn namespace() -> impl Strategy<Value = Namespace> {
    prop_oneof![
        Just(Namespace::Ua),
        (1_u16..).prop_map(Namespace::Index),
        arc_text().prop_map(|uri| Namespace::uri(&uri)),
    ]
}

fn node_id() -> impl Strategy<Value = NodeId> {
    let identifier = prop_oneof![
        any::<u32>().prop_map(Identifier::Numeric),
        arc_text().prop_map(Identifier::String),
        any::<u128>().prop_map(|bits| Identifier::Guid(Uuid::from_u128(bits))),
        any::<Vec<u8>>().prop_map(|bytes| Identifier::Opaque(bytes.into())),
    ];
    (namespace(), identifier).prop_map(|(namespace, identifier)| NodeId { namespace, identifier })
}

fn date_time() -> impl Strategy<Value = DateTime> {
    (0..=DateTime::MAX.ticks()).prop_map(DateTime::from_ticks)
}

fn diagnostic_info() -> impl Strategy<Value = DiagnosticInfo> {
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
    (leaf.clone(), proptest::option::of(leaf))
        .prop_map(|(outer, inner)| DiagnosticInfo { inner_diagnostic_info: inner.map(Box::new), ..outer })
}

/// Finite numbers, and both infinities; NaN is no equal of itself.
fn double() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("NaN", |value| !value.is_nan())
}

fn plain_scalar() -> impl Strategy<Value = Scalar> {
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
        proptest::option::of(any::<Vec<u8>>()).prop_map(|bytes| Scalar::ByteString(bytes.map(Arc::from))),
        proptest::option::of(arc_text()).prop_map(Scalar::XmlElement),
        node_id().prop_map(|id| Scalar::NodeId(Box::new(id))),
        (
            node_id(),
            prop_oneof![Just(Server::Local), (1_u32..).prop_map(Server::Index), arc_text().prop_map(Server::Uri)]
        )
            .prop_map(|(node_id, server)| Scalar::ExpandedNodeId(Box::new(ExpandedNodeId { node_id, server }))),
        any::<u32>().prop_map(|code| Scalar::StatusCode(StatusCode(code))),
        (namespace(), arc_text()).prop_map(|(namespace, name)| Scalar::QualifiedName(Box::new(QualifiedName {
            namespace,
            name: Some(name)
        }))),
        Just(Scalar::QualifiedName(Box::default())),
        (proptest::option::of(arc_text()), proptest::option::of(arc_text()))
            .prop_map(|(locale, text)| Scalar::LocalizedText(Box::new(LocalizedText { locale, text }))),
        diagnostic_info().prop_map(|info| Scalar::DiagnosticInfo(Box::new(info))),
    ]
}

fn structure_of(description: &StructureType, values: Vec<Variant>, mask: u32, switch: u32) -> ExtensionObject {
    let mut structure = StructureValue::default();
    let mut fields = description.fields.iter().zip(values);
    match description.kind {
        StructureKind::Plain => structure.fields = fields.map(|(field, value)| (field.name.clone(), value)).collect(),
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
            if let Some((field, value)) = fields.nth((switch as usize).wrapping_sub(1)).filter(|_| switch > 0) {
                structure.fields.insert(field.name.clone(), value);
            }
        }
    }
    ExtensionObject { type_id: description.type_id.clone().into(), body: ExtensionBody::Structure(structure) }
}

fn extension_object() -> impl Strategy<Value = ExtensionObject> {
    let values = (any::<[i32; 3]>(), double(), double(), any::<u64>(), any::<Vec<i64>>(), arc_text());
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
        move |bytes| ExtensionObject { type_id: unknown.clone().into(), body: ExtensionBody::Binary(bytes.into()) }
    });
    let xml = arc_text().prop_map({
        let unknown = unknown.clone();
        move |text| ExtensionObject { type_id: unknown.clone().into(), body: ExtensionBody::Xml(text) }
    });
    let json = any::<i32>().prop_map(move |number| ExtensionObject {
        type_id: unknown.clone().into(),
        body: ExtensionBody::Json(format!("{{\"x\":[{number},{{\"y\":null}}]}}").into()),
    });
    let null = Just(ExtensionObject { type_id: NodeId::null().into(), body: ExtensionBody::None });
    prop_oneof![4 => structured, 1 => opaque, 1 => xml, 1 => json, 1 => null]
}

fn scalar() -> impl Strategy<Value = Scalar> {
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
fn array_of(scalar: impl Strategy<Value = Scalar> + Clone + 'static) -> impl Strategy<Value = Variant> {
    let matrix = (proptest::collection::vec(1_u32..4, 2..4), scalar.clone()).prop_map(|(dimensions, scalar)| {
        let count = dimensions.iter().product::<u32>() as usize;
        let elements = vec![scalar.clone(); count];
        Array { element_type: scalar.built_in_type(), elements, dimensions: Some(dimensions) }
    });
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

fn variant() -> impl Strategy<Value = Variant> {
    prop_oneof![1 => Just(Variant::Null), 20 => array_of(scalar().boxed())]
}

fn data_value(value: impl Strategy<Value = Variant>) -> impl Strategy<Value = DataValue> {
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
            proptest::collection::vec(inner.clone(), 0..5).prop_map(|list| format!("[{}]", list.join(","))),
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
