//! Values as people read them: plain JSON beside OPC UA values.

use asi_model::{
    DataValue, DateTime, StatusCode,
    opcua_json::{DataEncoding, encode_variant},
};
use disclosure::Released;
use serde::Serialize;

use super::roles::BeforeGate;

/// Value in the form that pages show. It is made of one that a gate released:
///
/// ```
/// fn show(released: &disclosure::Released) -> factory_connector::api::ShownValue {
///     released.into()
/// }
/// ```
///
/// Any other one takes the proof that it is shown to an operator or engineer:
///
/// ```compile_fail,E0277
/// fn show(value: &asi_model::DataValue) -> factory_connector::api::ShownValue {
///     value.into()
/// }
/// ```
///
/// ```compile_fail,E0277
/// use factory_connector::api::{ShownValue, Viewer};
/// fn show(value: &asi_model::DataValue, user: &Viewer) -> ShownValue {
///     ShownValue::before_gate(value, user.into())
/// }
/// ```
///
/// ```
/// use factory_connector::api::{Engineer, ShownValue};
/// fn show(value: &asi_model::DataValue, user: &Engineer) -> ShownValue {
///     ShownValue::before_gate(value, user.into())
/// }
/// ```
///
/// Nor is it put together or changed elsewhere:
///
/// ```compile_fail,E0616
/// fn change(shown: &mut factory_connector::api::ShownValue) {
///     shown.value = 17.into();
/// }
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ShownValue {
    /// The value as plain JSON; 64-bit integers as text; null where there is none.
    #[schema(value_type = asi_model::openapi::PlainValue)]
    value: serde_json::Value,
    /// The status, by its name where it has one.
    status: String,
    /// Time of the measurement, by the source's clock.
    source_timestamp: Option<DateTime>,
}

impl From<&Released> for ShownValue {
    fn from(value: &Released) -> Self {
        Self::of(value)
    }
}

impl ShownValue {
    /// Shows a value that no gate released.
    #[must_use]
    pub fn before_gate(value: &DataValue, _proof: BeforeGate) -> Self {
        Self::of(value)
    }

    /// Shows the result of a mapping's function.
    #[must_use]
    pub fn of_function(result: mapping_engine::TracedValue, _proof: BeforeGate) -> Self {
        Self {
            value: result.value,
            status: StatusCode(result.status).to_string(),
            source_timestamp: result.source_timestamp,
        }
    }

    fn of(value: &DataValue) -> Self {
        let json = encode_variant(&value.value, DataEncoding::NonReversible104);
        Self {
            value: serde_json::from_slice(&json).unwrap_or_default(),
            status: value.status.to_string(),
            source_timestamp: value.source_timestamp,
        }
    }
}
