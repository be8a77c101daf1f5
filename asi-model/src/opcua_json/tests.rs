//! Readings of fixtures, and round trips of random values.

use std::sync::Arc;

use proptest::prelude::*;

use super::{
    arbitrary::{data_value, described, is_alike, plain_value, variant},
    *,
};
use crate::values::{Array, BuiltInType, LocalizedText, NodeId, Scalar};

mod frozen;

fn read(text: &str, leniency: Leniency) -> Result<(DecodedValue, Vec<Diagnostic>), ValueError> {
    decode_value(text.as_bytes(), leniency, &[], &[])
}

#[test]
fn a_status_in_foreign_spellings_stays() {
    let bad = StatusCode(0x8031_0000);
    for (member, status, notes) in [
        (r#""Status":2150694912"#, bad, 0),
        (r#""Status":{"Code":2150694912}"#, bad, 0),
        (r#""StatusCode":2150694912"#, bad, 1),
        (r#""StatusCode":{"Code":2150694912,"Symbol":"BadNoCommunication"}"#, bad, 1),
        // Names that the table does not know keep their severity.
        (r#""Status":{"Symbol":"BadNoCommunication"}"#, StatusCode::BAD, 0),
        (r#""StatusCode":"UncertainSubNormal""#, StatusCode::UNCERTAIN_SUB_NORMAL, 2),
        (r#""Status":"GoodClamped""#, StatusCode::GOOD_CLAMPED, 1),
        (r#""StatusCode":0"#, StatusCode::GOOD, 1),
        // The standard's member wins.
        (r#""StatusCode":0,"Status":2150694912"#, bad, 0),
    ] {
        for value in [r#""UaType":11,"Value":1.5"#, r#""Value":{"Type":11,"Body":1.5}"#] {
            let text = format!("{{{value},{member}}}");
            let (read, found) = read(&text, Leniency::Lenient).expect("a data value");
            let expected = DataValue { value: 1.5.into(), status, ..DataValue::default() };
            assert_eq!(read, DecodedValue::DataValue(expected), "{text}");
            assert_eq!(found.len(), notes, "{text}: {found:?}");
        }
    }
    for member in [r#""StatusCode":"worn""#, r#""StatusCode":true"#, r#""Status":{"Symbol":"x"}"#] {
        let text = format!(r#"{{"UaType":11,"Value":1.5,{member}}}"#);
        assert!(read(&text, Leniency::Lenient).is_err(), "{text}");
    }
}

// The table of the comparison with foreign stacks, as far as it is about us.
#[test]
fn fixtures_are_accepted_noted_or_rejected() {
    #[derive(Debug, PartialEq)]
    enum Reading {
        Accepted,
        Noted,
        Rejected,
    }
    use Reading::{Accepted as A, Noted as W, Rejected as R};
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
        (r#"{"Type":13,"Body":"0001-01-01T00:00:00Z"}"#, A, A),
        (r#"{"Type":13,"Body":"1601-01-01T00:00:00Z"}"#, A, A),
        (r#"{"Type":13,"Body":"1500-01-01T00:00:00Z"}"#, W, W),
        (r#"{"Type":13,"Body":"0000-01-01T00:00:00Z"}"#, W, W),
        (r#"{"Type":13,"Body":"2016-12-31T23:59:60Z"}"#, W, W),
        (r#"{"Type":13,"Body":"2019-04-18 18:20:30Z"}"#, R, W),
        (r#"{"UaType":11,"Value":1,"SourceTimestamp":"2019-04-18 18:20:30Z"}"#, R, W),
        ("1e308", W, W),
        ("1e309", R, R),
        ("[1,-1e309]", R, R),
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
        let reading = |leniency| match read(text, leniency) {
            Ok((_, notes)) if notes.is_empty() => A,
            Ok(_) => W,
            Err(_) => R,
        };
        assert_eq!(reading(Leniency::Strict), strict, "strict: {text}");
        assert_eq!(reading(Leniency::Lenient), lenient, "lenient: {text}");
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
            prop_assert!(is_alike(&found, &value), "{:?} {}: {:?}", encoding, String::from_utf8_lossy(&out), found);
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
            prop_assert!(is_alike(&found, &value), "{:?} {}: {:?}", encoding, String::from_utf8_lossy(&out), found);
        }
    }

    /// Bare values need their type, and lose locales and the types of what may be anything.
    #[test]
    fn bare_values_read_back_with_their_type(value in plain_value()) {
        let types = described();
        let built_in_type = value.built_in_type().expect("no null");
        let data_type = NodeId::ua(u32::from(built_in_type.id()));
        let value_rank = rank(&value);
        let hint = decode::TypeHint { built_in_type, data_type: &data_type, value_rank };
        for encoding in [DataEncoding::NonReversible104, DataEncoding::Verbose105] {
            let mut out = Vec::new();
            Encoder::described(encoding, &[], &types).bare(&mut out, &value);
            let tape = Tape::read(&out, LIMITS).expect("our own JSON");
            let found = Decoder::new(Leniency::Strict, &types, &[]).bare(tape.root(), hint);
            let found = found.map_err(|mismatch| TestCaseError::fail(mismatch.into_error().to_string()))?;
            // A null is null, whatever its type.
            let expected = if out == b"null" { Variant::Null } else { kept(&value, encoding) };
            prop_assert!(is_alike(&found, &expected), "{:?} {}: {:?}", encoding, String::from_utf8_lossy(&out), found);
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

/// The ValueRank of a value: -1 for a scalar, else the number of dimensions.
fn rank(value: &Variant) -> i32 {
    match value {
        Variant::Array(array) => {
            let dimensions = array.dimensions.as_ref().map_or(1, Vec::len);
            i32::try_from(dimensions).expect("few")
        }
        _ => -1,
    }
}

/// The part of a value that its bare form has.
fn kept(value: &Variant, encoding: DataEncoding) -> Variant {
    let scalar = |scalar: &Scalar| match scalar {
        Scalar::LocalizedText(text) if encoding == DataEncoding::NonReversible104 => {
            let kept = LocalizedText { locale: None, text: text.text.clone() };
            Scalar::LocalizedText(Box::new(kept))
        }
        other => other.clone(),
    };
    match value {
        Variant::Null => Variant::Null,
        Variant::Scalar(value) => Variant::Scalar(scalar(value)),
        Variant::Array(array) => {
            let elements = array.elements.iter().map(scalar).collect();
            Variant::Array(Arc::new(Array { elements, ..Array::clone(array) }))
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
