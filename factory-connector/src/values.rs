//! Values as people read and type them: plain JSON beside OPC UA values.

use asi_model::{
    BuiltInType, DataValue, DateTime, StatusCode,
    opcua_json::{DataEncoding, Leniency, decode_value, encode_variant},
};
use serde::Serialize;

/// A value as pages show it.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ShownValue {
    /// The value as plain JSON; 64-bit integers as text; null where there is none.
    pub value: serde_json::Value,
    /// The status, by its name where it has one.
    pub status: String,
    /// When the source measured it.
    pub source_timestamp: Option<DateTime>,
}

impl From<&DataValue> for ShownValue {
    fn from(value: &DataValue) -> Self {
        let json = encode_variant(&value.value, DataEncoding::NonReversible104);
        Self {
            value: serde_json::from_slice(&json).unwrap_or_default(),
            status: value.status.to_string(),
            source_timestamp: value.source_timestamp,
        }
    }
}

/// A value that a person typed, as the field's type.
///
/// # Errors
/// A sentence that says what the field needs.
pub fn typed_value(
    json: &serde_json::Value,
    field_type: BuiltInType,
    at: DateTime,
) -> Result<DataValue, String> {
    // `{"UaType": type, "Value": ...}` is how the compact encoding names the type of a bare value.
    let typed = serde_json::json!({ "UaType": field_type.id(), "Value": json });
    let (value, _) = decode_value(typed.to_string().as_bytes(), Leniency::Lenient, &[], &[])
        .map_err(|_| format!("the field needs a {field_type}, and {json} is none"))?;
    let value = value.into_data_value();
    if value.value.built_in_type() != Some(field_type) {
        return Err(format!("the field needs a {field_type}, and {json} is none"));
    }
    Ok(DataValue { source_timestamp: Some(at), status: StatusCode::GOOD, ..value })
}

#[cfg(test)]
mod tests {
    use asi_model::Variant;

    use super::*;

    #[test]
    fn typed_values_are_of_the_fields_type() {
        let at = DateTime::MIN;
        let check = |json: serde_json::Value, field_type, expected: Option<Variant>| {
            assert_eq!(
                typed_value(&json, field_type, at).ok().map(|value| value.value),
                expected,
                "{json}"
            );
        };
        check(serde_json::json!(7), BuiltInType::UInt64, Some(7_u64.into()));
        check(serde_json::json!("7"), BuiltInType::UInt64, Some(7_u64.into()));
        check(serde_json::json!(-7), BuiltInType::UInt64, None);
        check(serde_json::json!("text"), BuiltInType::String, Some("text".into()));
        check(serde_json::json!(true), BuiltInType::Boolean, Some(true.into()));
        check(serde_json::json!("x"), BuiltInType::Double, None);
    }
}
