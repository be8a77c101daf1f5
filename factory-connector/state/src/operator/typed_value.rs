//! Values that a person typed.

use asi_model::{
    BuiltInType, DataValue, DateTime, StatusCode,
    opcua_json::{Leniency, decode_value},
};

/// Converts a value that a person typed to the type of a field.
///
/// # Errors
/// The type that the field needs, in words.
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
