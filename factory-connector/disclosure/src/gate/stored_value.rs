//! Values in a stored state: the compact encoding of OPC UA JSON (OPC 10000-6, 5.4), but for structures.
//!
//! That encoding writes the fields of a structure without types, for readers that know its description. The store
//! knows none, so that each field is stored as a variant, which names its type. Such a text takes the place of
//! an XML body, which no reader interprets by the type's description. No XML begins with a brace, so that neither
//! is taken for the other.

use std::sync::Arc;

use asi_model::{
    BuiltInType, DataValue, Scalar, Variant,
    opcua_json::{DataEncoding, DecodedValue, Leniency, decode_value, encode_data_value},
    values::{Array, ExtensionBody, ExtensionObject, StructureValue},
};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

/// Types whose values may hold structures.
const HOLDING: [BuiltInType; 3] =
    [BuiltInType::ExtensionObject, BuiltInType::DataValue, BuiltInType::Variant];

/// A structure as stored.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct StoredStructure {
    /// Names and values in the order of the structure, since JSON objects have none.
    structure_fields: Vec<(Arc<str>, Box<RawValue>)>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    switch_field: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    encoding_mask: Option<u32>,
}

/// Encodes a value for the store.
pub(super) fn data_value_to_json(value: &DataValue) -> Box<RawValue> {
    let json = encode_data_value(&to_stored(value.clone()), DataEncoding::Compact105);
    let json = String::from_utf8(json).expect("the encoder writes UTF-8");
    RawValue::from_string(json).expect("the encoder writes JSON")
}

/// Decodes a value of the store.
///
/// # Errors
/// A description of the fault in the text.
pub(super) fn data_value_from_json(json: &str) -> Result<DataValue, String> {
    // By itself an empty object could as well be an empty structure.
    if json == "{}" {
        return Ok(DataValue::default());
    }
    let (value, _) = decode_value(json.as_bytes(), Leniency::Lenient, &[], &[])
        .map_err(|error| error.to_string())?;
    // A value without quality is written as its variant. Unlike in reports, a status code or a value with a
    // quality that it holds is not taken for its own quality.
    Ok(from_stored(match value {
        DecodedValue::DataValue(value) => value,
        DecodedValue::Variant(value) | DecodedValue::Bare(value) => {
            DataValue { value, ..DataValue::default() }
        }
    }))
}

/// Replaces each structure by the text that is stored for it.
fn to_stored(value: DataValue) -> DataValue {
    DataValue { value: each(value.value, stored), ..value }
}

/// Replaces each text that was stored for a structure by the structure.
fn from_stored(value: DataValue) -> DataValue {
    DataValue { value: each(value.value, read), ..value }
}

/// Replaces the extension objects of a value, those within held values included.
fn each(value: Variant, replace: fn(ExtensionObject) -> ExtensionObject) -> Variant {
    let of_scalar = |scalar: Scalar| match scalar {
        Scalar::ExtensionObject(object) => Scalar::ExtensionObject(Box::new(replace(*object))),
        Scalar::Variant(held) => Scalar::Variant(Box::new(each(*held, replace))),
        Scalar::DataValue(held) => {
            let value = each(held.value.clone(), replace);
            Scalar::DataValue(Box::new(DataValue { value, ..*held }))
        }
        other => other,
    };
    match value {
        Variant::Scalar(scalar) => Variant::Scalar(of_scalar(scalar)),
        Variant::Array(array) if HOLDING.contains(&array.element_type) => {
            let array = Arc::unwrap_or_clone(array);
            let elements = array.elements.into_iter().map(of_scalar).collect();
            Variant::Array(Arc::new(Array { elements, ..array }))
        }
        other => other,
    }
}

fn stored(object: ExtensionObject) -> ExtensionObject {
    let ExtensionBody::Structure(structure) = object.body else { return object };
    let of_field = |(name, value): (Arc<str>, Variant)| {
        (name, data_value_to_json(&DataValue { value, ..DataValue::default() }))
    };
    let stored = StoredStructure {
        structure_fields: structure.fields.into_iter().map(of_field).collect(),
        switch_field: structure.switch_field,
        encoding_mask: structure.encoding_mask,
    };
    let text = serde_json::to_string(&stored).expect("names and JSON texts serialise");
    ExtensionObject { body: ExtensionBody::Xml(text.into()), ..object }
}

/// Reads a structure. XML stays as it is, and so do structures of former versions, which are JSON texts.
fn read(object: ExtensionObject) -> ExtensionObject {
    let ExtensionBody::Xml(text) = &object.body else { return object };
    let Ok(stored) = serde_json::from_str::<StoredStructure>(text) else { return object };
    let of_field = |(name, json): (Arc<str>, Box<RawValue>)| {
        data_value_from_json(json.get()).map(|value| (name, value.value))
    };
    let fields = stored.structure_fields.into_iter().map(of_field).collect::<Result<_, _>>();
    let Ok(fields) = fields else { return object };
    let (switch_field, encoding_mask) = (stored.switch_field, stored.encoding_mask);
    let structure = StructureValue { fields, switch_field, encoding_mask };
    ExtensionObject { body: ExtensionBody::Structure(structure), ..object }
}
