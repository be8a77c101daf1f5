//! Decodes with open62541 every value that asi-model writes in 1.05, lets open62541 write it again,
//! and compares what is read from that with the value it began with.
//!
//! Left out are structures inside variants, which open62541 1.5.10 expects in another place
//! (`UaBody`) than the standard puts them, and texts with `\u0001`, which it refuses although JSON
//! allows it. Frozen texts and the tests of asi-model stand in for those; the fields of structures
//! alone it reads as their own type.

#[path = "../../../../../asi-model/tests/it/vectors.rs"]
mod vectors;

use std::{ffi::c_void, process::ExitCode, ptr, sync::Arc};

use asi_model::{
    DataValue, NodeId, Scalar, Variant,
    opcua_json::{
        DataEncoding, DecodedValue, Encoder, Leniency, decode_value, encode_data_value,
        encode_variant,
    },
    values::ExtensionObject,
};
use open62541_sys as ua;

/// The namespaces as open62541 wants them: a table from index 0 on.
struct Mapping {
    mapping: ua::UA_NamespaceMapping,
    /// Keeps what the table points to.
    _strings: Vec<ua::UA_String>,
    _texts: Vec<Arc<str>>,
}

fn string(text: &str) -> ua::UA_String {
    ua::UA_String { length: text.len(), data: text.as_ptr().cast_mut() }
}

impl Mapping {
    fn new(namespaces: &[Arc<str>]) -> Box<Self> {
        let mut texts: Vec<Arc<str>> = vec!["http://opcfoundation.org/UA/".into()];
        texts.extend(namespaces.iter().cloned());
        let mut strings: Vec<ua::UA_String> = texts.iter().map(|text| string(text)).collect();
        let mapping = ua::UA_NamespaceMapping {
            namespaceUris: strings.as_mut_ptr(),
            namespaceUrisSize: strings.len(),
            local2remote: ptr::null_mut(),
            local2remoteSize: 0,
            remote2local: ptr::null_mut(),
            remote2localSize: 0,
        };
        Box::new(Self { mapping, _strings: strings, _texts: texts })
    }
}

/// The value as open62541 writes it after having read it.
fn through_open62541(
    text: &[u8],
    data_type: u32,
    mapping: &mut Mapping,
) -> Result<Vec<u8>, String> {
    // SAFETY: the types table has this many entries; the value is initialised by the decoder, used
    // once, and cleared.
    unsafe {
        let data_type = &raw const ua::UA_TYPES[data_type as usize];
        let mut decode: ua::UA_DecodeJsonOptions = std::mem::zeroed();
        decode.namespaceMapping = &raw mut mapping.mapping;
        let mut encode: ua::UA_EncodeJsonOptions = std::mem::zeroed();
        encode.namespaceMapping = &raw mut mapping.mapping;
        encode.useReversible = true;
        let value: *mut c_void = ua::UA_new(data_type);
        let source = ua::UA_ByteString { length: text.len(), data: text.as_ptr().cast_mut() };
        let status = ua::UA_decodeJson(&raw const source, value, data_type, &raw const decode);
        if status != 0 {
            ua::UA_delete(value, data_type);
            return Err(format!("not decoded: 0x{status:08X}"));
        }
        let mut written: ua::UA_ByteString = std::mem::zeroed();
        let status = ua::UA_encodeJson(value, data_type, &raw mut written, &raw const encode);
        ua::UA_delete(value, data_type);
        if status != 0 {
            return Err(format!("decoded, but not encoded: 0x{status:08X}"));
        }
        let copy = std::slice::from_raw_parts(written.data, written.length).to_vec();
        ua::UA_ByteString_clear(&raw mut written);
        Ok(copy)
    }
}

/// Writes it as text, since NaN is no equal of itself.
fn canonical(value: &DecodedValue) -> String {
    let text = match value {
        DecodedValue::Variant(value) | DecodedValue::Bare(value) => {
            encode_variant(value, DataEncoding::Reversible104)
        }
        DecodedValue::DataValue(value) => encode_data_value(value, DataEncoding::Reversible104),
    };
    String::from_utf8(text).expect("our own text")
}

/// Known faults of open62541 1.5.10: structures in their place, and escaped control
/// characters.
fn is_known_fault(value: &Variant) -> bool {
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

fn has_control(text: Option<&str>) -> bool {
    text.is_some_and(|text| text.contains('\u{1}'))
}

/// The fields of a structure as its own type, which open62541 reads where the standard has them.
fn structure_alone(
    object: &ExtensionObject,
    encoder: &Encoder<'_>,
    mapping: &mut Mapping,
) -> Result<(), String> {
    let (data_type, id) = match object.type_id.node_id {
        ref id if *id == NodeId::ua(884) => (ua::UA_TYPES_RANGE, "i=884"),
        ref id if *id == NodeId::ua(887) => (ua::UA_TYPES_EUINFORMATION, "i=887"),
        ref id => return Err(format!("{id} has no type here")),
    };
    let mut text = Vec::new();
    encoder.extension_object(&mut text, object);
    let type_member = format!("{{\"UaTypeId\":\"{id}\",");
    let fields = String::from_utf8_lossy(&text).replacen(&type_member, "{", 1);
    let again = through_open62541(fields.as_bytes(), data_type, mapping)?;
    let again = String::from_utf8_lossy(&again).replacen('{', &type_member, 1);
    let typed = format!("{{\"UaType\":22,\"Value\":{again}}}");
    let (found, _) = decode_value(typed.as_bytes(), Leniency::Lenient, &[], &[])
        .map_err(|error| error.to_string())?;
    let expected =
        DecodedValue::Variant(Variant::Scalar(Scalar::ExtensionObject(Box::new(object.clone()))));
    if canonical(&found) == canonical(&expected) {
        Ok(())
    } else {
        Err(format!("{fields} was read as {again}"))
    }
}

fn main() -> ExitCode {
    let namespaces = vectors::namespaces();
    let mut mapping = Mapping::new(&namespaces);
    let (mut count, mut differences) = (0, 0);
    let scalars = vectors::scalars(&mut vectors::Numbers(1));
    for value in vectors::variants(&scalars).into_iter().filter(|value| !is_known_fault(value)) {
        for encoding in [DataEncoding::Compact105, DataEncoding::Verbose105] {
            let encoder = Encoder::described(encoding, &namespaces, &[]);
            let time = "2019-03-26T18:28:54.2940194Z".parse().expect("a time");
            let data_value = DataValue::good(value.clone(), time);
            for (data_type, expected) in [
                (ua::UA_TYPES_VARIANT, DecodedValue::Variant(value.clone())),
                (ua::UA_TYPES_DATAVALUE, DecodedValue::DataValue(data_value)),
            ] {
                let mut text = Vec::new();
                match &expected {
                    DecodedValue::DataValue(value) => encoder.data_value(&mut text, value),
                    DecodedValue::Variant(value) | DecodedValue::Bare(value) => {
                        encoder.variant(&mut text, value)
                    }
                }
                count += 1;
                let found = through_open62541(&text, data_type, &mut mapping).and_then(|again| {
                    decode_value(&again, Leniency::Lenient, &[], &namespaces)
                        .map(|(found, _)| canonical(&found))
                        .map_err(|error| format!("{error}: {}", String::from_utf8_lossy(&again)))
                });
                let expected = canonical(&expected);
                if found.as_ref() != Ok(&expected) {
                    differences += 1;
                    if differences <= 20 {
                        eprintln!(
                            "{}\n  expected {expected}\n  found    {found:?}",
                            String::from_utf8_lossy(&text)
                        );
                    }
                }
            }
        }
    }
    for scalar in &scalars {
        let Scalar::ExtensionObject(object) = scalar else { continue };
        for encoding in [DataEncoding::Compact105, DataEncoding::Verbose105] {
            count += 1;
            let encoder = Encoder::described(encoding, &namespaces, &[]);
            if let Err(error) = structure_alone(object, &encoder, &mut mapping) {
                differences += 1;
                eprintln!("{error}");
            }
        }
    }
    println!("open62541: {count} values, {differences} differences");
    if differences == 0 && count > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
