//! Plain JSON form of OPC UA values, with the status beside them, as the platform shows them and as
//! they are compared with a ledger.
//!
//! 64-bit integers are texts, as inside OPC UA payloads, so that no reader loses digits; the rest
//! of the numbers are numbers, what JSON has no number for (NaN, infinities) are texts. Structures
//! and other rare types keep their OPC UA JSON form.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::{
    DataValue, DateTime, Scalar, Variant,
    opcua_json::{DataEncoding, Encoder},
};

/// A value with its quality and source time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct ReportedValue {
    #[cfg_attr(feature = "openapi", schema(value_type = crate::openapi::PlainValue))]
    pub value: Value,
    /// Quality, by the standard's name.
    pub status: String,
    /// Time of the measurement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source_timestamp: Option<DateTime>,
}

impl From<&DataValue> for ReportedValue {
    fn from(value: &DataValue) -> Self {
        Self {
            value: value_json(&value.value),
            status: value.status.to_string(),
            source_timestamp: value.source_timestamp,
        }
    }
}

/// Converts a value to plain JSON, without its type.
#[must_use]
pub fn value_json(variant: &Variant) -> Value {
    match variant {
        Variant::Null => Value::Null,
        Variant::Scalar(value) => scalar(value),
        Variant::Array(array) if array.dimensions.is_none() => {
            array.elements.iter().map(scalar).collect()
        }
        Variant::Array(array) => json!({
            "dimensions": array.dimensions,
            "elements": array.elements.iter().map(scalar).collect::<Vec<_>>(),
        }),
    }
}

fn scalar(value: &Scalar) -> Value {
    match value {
        Scalar::Boolean(v) => json!(v),
        Scalar::SByte(v) => json!(v),
        Scalar::Byte(v) => json!(v),
        Scalar::Int16(v) => json!(v),
        Scalar::UInt16(v) => json!(v),
        Scalar::Int32(v) => json!(v),
        Scalar::UInt32(v) => json!(v),
        Scalar::Int64(v) => json!(v.to_string()),
        Scalar::UInt64(v) => json!(v.to_string()),
        // The shortest text of an f32 is what people mean by it; as f64 it would show digits nobody
        // measured.
        Scalar::Float(v) => number(v.to_string().parse().unwrap_or_else(|_| f64::from(*v))),
        Scalar::Double(v) => number(*v),
        Scalar::String(v) | Scalar::XmlElement(v) => json!(v.as_deref()),
        Scalar::DateTime(v) => json!(v.to_string()),
        Scalar::Guid(v) => json!(v.to_string()),
        Scalar::StatusCode(v) => json!(v.to_string()),
        Scalar::LocalizedText(v) => json!(v.text.as_deref()),
        Scalar::DataValue(v) => json!(ReportedValue::from(&**v)),
        Scalar::Variant(v) => value_json(v),
        other => opcua_form(other),
    }
}

fn number(value: f64) -> Value {
    serde_json::Number::from_f64(value).map_or_else(|| json!(value.to_string()), Value::Number)
}

fn opcua_form(value: &Scalar) -> Value {
    let mut out = Vec::new();
    Encoder::new(DataEncoding::Compact105).variant(&mut out, &Variant::Scalar(value.clone()));
    serde_json::from_slice(&out).unwrap_or(Value::Null)
}

/// Returns the number in a plain value, if it is one.
#[must_use]
pub fn as_number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => number.as_f64(),
        Value::String(text) => text.parse().ok().filter(|number: &f64| number.is_finite()),
        Value::Bool(flag) => Some(f64::from(u8::from(*flag))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{BuiltInType, values::Array};

    #[test]
    fn values_are_plain() {
        let array = |elements: Vec<Scalar>| {
            Variant::Array(Arc::new(Array {
                element_type: BuiltInType::Int16,
                elements,
                dimensions: None,
            }))
        };
        for (value, expected) in [
            (Variant::Null, json!(null)),
            (12_u64.into(), json!("12")),
            (12_u16.into(), json!(12)),
            (0.1_f32.into(), json!(0.1)),
            (f64::NAN.into(), json!("NaN")),
            ("text".into(), json!("text")),
            (true.into(), json!(true)),
            (array(vec![Scalar::Int16(1), Scalar::Int16(2)]), json!([1, 2])),
        ] {
            assert_eq!(value_json(&value), expected, "{value:?}");
        }
    }

    #[test]
    fn numbers_are_found_again() {
        for (value, expected) in [
            (json!("12"), Some(12.0)),
            (json!(1.5), Some(1.5)),
            (json!("NaN"), None),
            (json!([]), None),
        ] {
            assert_eq!(as_number(&value), expected, "{value}");
        }
    }
}
