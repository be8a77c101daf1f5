//! Intermediate values of a chain, for people.

use asi_model::{BuiltInType, DataValue, DateTime, Scalar, Variant};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value as Json;
use utoipa::ToSchema;

use crate::{
    convert,
    document::TypeName,
    fault::{Fault, FaultKind},
    quality::Meta,
};

/// Result of one function on one value.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TraceStep {
    /// Index of the function.
    pub step: usize,
    /// Name of the function, as in JSON.
    pub function: String,
    /// Value yielded; absent where it held the value back or failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<TracedValue>,
    /// Fault, where it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<TracedFault>,
}

/// Fault of a function.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TracedFault {
    /// Kind, for programs.
    pub kind: FaultKind,
    /// Sentence that names the fault.
    pub message: String,
    /// The line in the script, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// The column in the script, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<u32>,
}

/// A value for people: 64-bit integers as text, arrays cut after 256 elements, structures as
/// objects.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TracedValue {
    /// The built-in type; absent where there is no value.
    #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
    pub value_type: Option<TypeName>,
    /// Value as plain JSON.
    #[schema(value_type = asi_model::openapi::PlainValue)]
    pub value: Json,
    /// The status code.
    pub status: u32,
    /// The status' name, where it is a well-known one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status_name: Option<String>,
    /// Time at which the source measured it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source_timestamp: Option<DateTime>,
    /// Time at which the server last knew it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub server_timestamp: Option<DateTime>,
}

/// Most elements of an array that are shown.
const ELEMENTS_SHOWN_MAX: usize = 256;

impl TracedValue {
    /// A value as people see it.
    #[must_use]
    pub fn of(value: &DataValue) -> Self {
        Self::new(&value.value, &Meta::of(value))
    }

    fn new(value: &Variant, meta: &Meta) -> Self {
        Self {
            value_type: value.built_in_type().map(TypeName),
            value: json_of(value, 0),
            status: meta.status.0,
            status_name: meta.status.symbol().map(str::to_owned),
            source_timestamp: meta.source_timestamp,
            server_timestamp: meta.server_timestamp,
        }
    }
}

impl From<&Fault> for TracedFault {
    fn from(fault: &Fault) -> Self {
        Self {
            kind: fault.kind,
            message: fault.message.to_string(),
            line: fault.line,
            column: fault.column,
        }
    }
}

impl TraceStep {
    pub(crate) fn passed(
        trace: Option<&mut Vec<Self>>,
        step: usize,
        function: &str,
        value: &Variant,
        meta: &Meta,
    ) {
        if let Some(trace) = trace {
            let value = Some(TracedValue::new(value, meta));
            trace.push(Self { step, function: function.to_owned(), value, fault: None });
        }
    }

    pub(crate) fn held(trace: Option<&mut Vec<Self>>, step: usize, function: &str) {
        if let Some(trace) = trace {
            trace.push(Self { step, function: function.to_owned(), value: None, fault: None });
        }
    }

    pub(crate) fn failed(
        trace: Option<&mut Vec<Self>>,
        step: usize,
        function: &str,
        fault: &Fault,
    ) {
        if let Some(trace) = trace {
            trace.push(Self {
                step,
                function: function.to_owned(),
                value: None,
                fault: Some(fault.into()),
            });
        }
    }
}

/// Plain JSON for people. Values nest at most as deep as their decoder allows; 16 levels are shown.
fn json_of(value: &Variant, depth: usize) -> Json {
    match value {
        Variant::Null => Json::Null,
        Variant::Scalar(scalar) => scalar_json(scalar, depth),
        Variant::Array(array) => {
            let shown = array
                .elements
                .iter()
                .take(ELEMENTS_SHOWN_MAX)
                .map(|element| scalar_json(element, depth));
            Json::Array(shown.collect())
        }
    }
}

fn scalar_json(scalar: &Scalar, depth: usize) -> Json {
    use asi_model::values::ExtensionBody;
    match scalar {
        Scalar::Boolean(v) => Json::Bool(*v),
        Scalar::Float(v) if v.is_finite() => Json::from(*v),
        Scalar::Double(v) if v.is_finite() => Json::from(*v),
        Scalar::Variant(inner) if depth < 16 => json_of(inner, depth + 1),
        Scalar::ExtensionObject(object) if depth < 16 => match &object.body {
            ExtensionBody::Structure(structure) => {
                let members = structure
                    .fields
                    .iter()
                    .map(|(name, value)| (name.to_string(), json_of(value, depth + 1)));
                Json::Object(members.collect())
            }
            _ => Json::Null,
        },
        other => {
            let is_small = other.as_i128().is_some()
                && !matches!(other.built_in_type(), BuiltInType::Int64 | BuiltInType::UInt64);
            match other.as_i128().and_then(|v| i64::try_from(v).ok()).filter(|_| is_small) {
                Some(v) => Json::from(v),
                None => convert::to_text(other).map_or(Json::Null, Json::String),
            }
        }
    }
}
