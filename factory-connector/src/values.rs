//! Values as people read them: plain JSON beside OPC UA values.

use asi_model::{
    DataValue, DateTime,
    opcua_json::{DataEncoding, encode_variant},
};
use disclosure::Released;
use serde::Serialize;

/// Value in the form that pages show.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ShownValue {
    /// The value as plain JSON; 64-bit integers as text; null where there is none.
    #[schema(value_type = asi_model::openapi::PlainValue)]
    pub value: serde_json::Value,
    /// The status, by its name where it has one.
    pub status: String,
    /// Time of the measurement, by the source's clock.
    pub source_timestamp: Option<DateTime>,
}

impl From<&Released> for ShownValue {
    fn from(value: &Released) -> Self {
        Self::from(&**value)
    }
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
