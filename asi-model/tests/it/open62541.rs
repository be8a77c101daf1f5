//! Reading by open62541 of what we write in 1.05: it writes again what it has read, and that is compared with the value it began
//! with.
//!
//! Left out are structures inside variants, which open62541 1.5.10 expects in another place
//! (`UaBody`) than the standard puts them, and texts with `\u0001`, which it refuses although JSON
//! allows it. Frozen texts and the tests of asi-model stand in for those; the fields of structures
//! alone it reads as their own type.

use std::{
    fs::File,
    process::{Command, Stdio},
};

use asi_model::{
    DataValue, NodeId, Scalar, Variant,
    opcua_json::{
        DataEncoding, DecodedValue, Encoder, Leniency, decode_value, encode_data_value,
        encode_variant,
    },
    values::ExtensionObject,
};

use crate::{
    foreign::{root, scratch},
    vectors::{Numbers, namespaces, scalars, variants},
};

/// A value as it is sent, with what has to come back.
struct Sent {
    /// Type that open62541 reads it as.
    letter: char,
    text: String,
    expected: DecodedValue,
    /// Member with the type of a structure, which stands beside its fields.
    type_member: Option<String>,
}

/// Writes it as text, since NaN is no equal of itself.
fn canonical(value: &DecodedValue) -> String {
    let text = match value {
        DecodedValue::Variant(value) | DecodedValue::Bare(value) => {
            encode_variant(value, DataEncoding::Reversible104)
        }
        DecodedValue::DataValue(value) => encode_data_value(value, DataEncoding::Reversible104),
    };
    String::from_utf8(text).unwrap()
}

/// Known faults of open62541 1.5.10: structures in their place, and escaped control
/// characters.
fn is_known_fault(value: &Variant) -> bool {
    let has_control = |text: Option<&str>| text.is_some_and(|text| text.contains('\u{1}'));
    let is_fault = |scalar: &Scalar| match scalar {
        Scalar::ExtensionObject(_) => true,
        Scalar::Variant(inner) => is_known_fault(inner),
        Scalar::String(text) | Scalar::XmlElement(text) => has_control(text.as_deref()),
        Scalar::LocalizedText(text) => has_control(text.text.as_deref()),
        Scalar::QualifiedName(name) => has_control(name.name.as_deref()),
        _ => false,
    };
    match value {
        Variant::Null => false,
        Variant::Scalar(scalar) => is_fault(scalar),
        Variant::Array(array) => array.elements.iter().any(is_fault),
    }
}

fn values(value: &Variant, encoder: &Encoder<'_>) -> [Sent; 2] {
    let time = "2019-03-26T18:28:54.2940194Z".parse().unwrap();
    let data_value = DataValue::good(value.clone(), time);
    let (mut plain, mut timed) = (Vec::new(), Vec::new());
    encoder.variant(&mut plain, value);
    encoder.data_value(&mut timed, &data_value);
    let sent = |letter, text, expected| {
        let text = String::from_utf8(text).unwrap();
        Sent { letter, text, expected, type_member: None }
    };
    [
        sent('V', plain, DecodedValue::Variant(value.clone())),
        sent('D', timed, DecodedValue::DataValue(data_value)),
    ]
}

/// The fields of a structure as its own type, which open62541 reads where the standard has them.
fn structure(object: &ExtensionObject, encoder: &Encoder<'_>) -> Sent {
    let (letter, id) = match &object.type_id.node_id {
        id if *id == NodeId::ua(884) => ('R', "i=884"),
        id if *id == NodeId::ua(887) => ('E', "i=887"),
        id => panic!("{id} has no type here"),
    };
    let mut text = Vec::new();
    encoder.extension_object(&mut text, object);
    let type_member = format!("{{\"UaTypeId\":\"{id}\",");
    let text = String::from_utf8(text).unwrap().replacen(&type_member, "{", 1);
    let object = Scalar::ExtensionObject(Box::new(object.clone()));
    let expected = DecodedValue::Variant(Variant::Scalar(object));
    Sent { letter, text, expected, type_member: Some(type_member) }
}

impl Sent {
    /// The value in a line of the answer.
    fn found(&self, line: &str) -> Result<String, String> {
        let again = line.strip_prefix('=').ok_or_else(|| line.to_owned())?;
        let (text, namespaces) = match &self.type_member {
            None => (again.to_owned(), namespaces()),
            Some(member) => {
                let again = again.replacen('{', member, 1);
                (format!("{{\"UaType\":22,\"Value\":{again}}}"), Vec::new())
            }
        };
        let read = decode_value(text.as_bytes(), Leniency::Lenient, &[], &namespaces);
        read.map(|(found, _)| canonical(&found)).map_err(|error| format!("{error}: {again}"))
    }
}

#[test]
fn foreign_compact_and_verbose_values_go_through_open62541_unchanged() {
    let status = Command::new(root().join("tests/foreign/asi/open62541/build.sh")).status();
    assert!(
        status.unwrap().success(),
        "tests/foreign/asi/open62541/build.sh compiles open62541's codec"
    );
    let table = namespaces();
    let scalars = scalars(&mut Numbers(1));
    let mut sent = Vec::new();
    for encoding in [DataEncoding::Compact105, DataEncoding::Verbose105] {
        let encoder = Encoder::described(encoding, &table, &[]);
        let known = variants(&scalars).into_iter().filter(|value| !is_known_fault(value));
        sent.extend(known.flat_map(|value| values(&value, &encoder)));
        let structures = scalars.iter().filter_map(|scalar| match scalar {
            Scalar::ExtensionObject(object) => Some(structure(object, &encoder)),
            _ => None,
        });
        sent.extend(structures);
    }
    let lines: String =
        sent.iter().map(|Sent { letter, text, .. }| format!("{letter} {text}\n")).collect();
    let file = scratch("compact-vectors.txt");
    std::fs::write(&file, lines).unwrap();
    let answer = Command::new(root().join("target/foreign/open62541/through"))
        .args(table.iter().map(|uri| &**uri))
        .stdin(Stdio::from(File::open(&file).unwrap()))
        .output()
        .unwrap();
    assert!(answer.status.success(), "{answer:?}");
    let answer = String::from_utf8(answer.stdout).unwrap();
    let lines: Vec<&str> = answer.lines().collect();
    assert_eq!(lines.len(), sent.len());
    assert!(lines.len() > 100, "{}", lines.len());
    let differences: Vec<String> = sent
        .iter()
        .zip(lines)
        .filter_map(|(sent, line)| {
            let (expected, found) = (canonical(&sent.expected), sent.found(line));
            (found.as_ref() != Ok(&expected))
                .then(|| format!("{}\n  expected {expected}\n  found    {found:?}", sent.text))
        })
        .take(20)
        .collect();
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}
