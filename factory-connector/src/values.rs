//! Values as this room keeps and shows them: as stored documents, and as plain JSON for pages.

use std::collections::VecDeque;

use asi_model::{
    BuiltInType, DataValue, DateTime, StatusCode,
    opcua_json::{DataEncoding, Leniency, decode_value, encode_data_value, encode_variant},
};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use crate::disclosure::GateState;

/// A gate's state as stored: data values in the compact encoding of OPC UA JSON.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct StoredGate {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    last_released_at: Option<DateTime>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    disclosed: Option<Box<RawValue>>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    waiting: Vec<(DateTime, Box<RawValue>)>,
}

/// A gate's state as a stored document.
#[must_use]
pub fn gate_to_json(state: &GateState) -> String {
    let stored = StoredGate {
        last_released_at: state.last_released_at,
        disclosed: state.disclosed.as_ref().map(raw),
        waiting: state.waiting.iter().map(|(at, value)| (*at, raw(value))).collect(),
    };
    serde_json::to_string(&stored).expect("times and JSON texts serialise")
}

/// A gate's state from a stored document.
///
/// # Errors
/// What is wrong with the document.
pub fn gate_from_json(text: &str) -> Result<GateState, String> {
    let stored: StoredGate = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let value = |json: &RawValue| data_value_from_json(json.get());
    Ok(GateState {
        last_released_at: stored.last_released_at,
        disclosed: stored.disclosed.as_deref().map(value).transpose()?,
        waiting: stored
            .waiting
            .iter()
            .map(|(at, json)| value(json).map(|value| (*at, value)))
            .collect::<Result<VecDeque<_>, _>>()?,
    })
}

fn raw(value: &DataValue) -> Box<RawValue> {
    RawValue::from_string(text(encode_data_value(value, DataEncoding::Compact105))).expect("the encoder writes JSON")
}

fn text(json: Vec<u8>) -> String {
    String::from_utf8(json).expect("the encoder writes UTF-8")
}

fn data_value_from_json(json: &str) -> Result<DataValue, String> {
    let (value, _) = decode_value(json.as_bytes(), Leniency::Lenient, &[], &[]).map_err(|error| error.to_string())?;
    Ok(value.into_data_value())
}

/// A value as pages show it.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ShownValue {
    /// The value as plain JSON; 64-bit integers as text; null where there is none.
    pub value: serde_json::Value,
    /// The status, by its name where it has one.
    pub status: String,
    /// When the source measured it.
    #[schema(value_type = Option<String>, format = "date-time")]
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
pub fn typed_value(json: &serde_json::Value, field_type: BuiltInType, at: DateTime) -> Result<DataValue, String> {
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
    fn a_gates_state_survives() {
        let at = DateTime::from_unix_micros(1_800_000_000_000_000);
        let state = GateState {
            last_released_at: Some(at),
            disclosed: Some(DataValue::good(u64::MAX, at)),
            waiting: [(at, DataValue::good(2.5_f64, at)), (at, DataValue::status_only(StatusCode::BAD_NO_DATA, None))]
                .into(),
        };
        let json = gate_to_json(&state);
        insta::assert_snapshot!(json, @r#"{"lastReleasedAt":"2027-01-15T08:00:00Z","disclosed":{"UaType":9,"Value":"18446744073709551615","SourceTimestamp":"2027-01-15T08:00:00Z"},"waiting":[["2027-01-15T08:00:00Z",{"UaType":11,"Value":2.5,"SourceTimestamp":"2027-01-15T08:00:00Z"}],["2027-01-15T08:00:00Z",{"Status":{"Code":2157641728}}]]}"#);
        assert_eq!(gate_from_json(&json), Ok(state));
        assert_eq!(gate_from_json("{}"), Ok(GateState::default()));
    }

    #[test]
    fn typed_values_are_of_the_fields_type() {
        let at = DateTime::MIN;
        let check = |json: serde_json::Value, field_type, expected: Option<Variant>| {
            assert_eq!(typed_value(&json, field_type, at).ok().map(|value| value.value), expected, "{json}");
        };
        check(serde_json::json!(7), BuiltInType::UInt64, Some(7_u64.into()));
        check(serde_json::json!("7"), BuiltInType::UInt64, Some(7_u64.into()));
        check(serde_json::json!(-7), BuiltInType::UInt64, None);
        check(serde_json::json!("text"), BuiltInType::String, Some("text".into()));
        check(serde_json::json!(true), BuiltInType::Boolean, Some(true.into()));
        check(serde_json::json!("x"), BuiltInType::Double, None);
    }
}
