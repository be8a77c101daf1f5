//! Trying a mapping: every intermediate value of every run.

use asi_model::{BuiltInType, DataValue, DateTime, Scalar, Variant};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value as Json;
use utoipa::ToSchema;

use crate::{
    convert,
    diagnostic::MappingDiagnostic,
    fault::{Fault, FaultKind},
    quality::Meta,
    transform::Flow,
};

/// Most samples of a dry run.
pub const SAMPLES_MAX: usize = 10_000;

/// A recorded or live value to try a mapping on.
#[derive(Debug, Clone, PartialEq)]
pub struct DryRunSample {
    /// The name of the input.
    pub input: String,
    /// When it came, by the local clock; timers between two samples run in between.
    pub at: DateTime,
    /// What came.
    pub value: DataValue,
}

/// What a mapping made of samples.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Trace {
    /// What is to be said about the mapping; with an error there are no runs.
    pub diagnostics: Vec<MappingDiagnostic>,
    /// One run per sample, and per timer that ran out in between.
    pub runs: Vec<TraceRun>,
}

/// One run of the chain.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TraceRun {
    /// When, by the local clock.
    #[schema(value_type = String, format = DateTime)]
    pub at: DateTime,
    /// The input that changed; absent where time passed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<String>,
    /// What came in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<TracedValue>,
    /// What each function made of it, as far as the chain got.
    pub steps: Vec<TraceStep>,
    /// What came out; absent where the mapping said nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub candidate: Option<TracedValue>,
    /// Why the end of the chain failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<TracedFault>,
}

/// What one function made of its value.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TraceStep {
    /// Index of the function.
    pub step: usize,
    /// Its name.
    pub function: String,
    /// What it yielded; absent where it held the value back or failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<TracedValue>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<TracedFault>,
}

/// Why a function failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TracedFault {
    /// What kind of fault it is.
    pub kind: FaultKind,
    /// What went wrong, in a sentence.
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
    pub value_type: Option<crate::mapping::TypeName>,
    /// The value.
    #[schema(value_type = Object)]
    pub value: Json,
    /// The status code.
    pub status: u32,
    /// The status' name, where it is a well-known one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status_name: Option<String>,
    /// When the source measured it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, format = DateTime)]
    pub source_timestamp: Option<DateTime>,
    /// When the server last knew it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, format = DateTime)]
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
            value_type: value.built_in_type().map(crate::mapping::TypeName),
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
    pub(crate) fn passed(trace: Option<&mut Vec<Self>>, step: usize, function: &str, flow: &Flow) {
        if let Some(trace) = trace {
            let value = Some(TracedValue::new(&flow.value, &flow.meta));
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
