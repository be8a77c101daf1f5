//! Samples that a mapping is tried on, and the trace of what it made of them.

use asi_model::{DataValue, DateTime};
use mapping::{MappingDiagnostic, TraceStep, TracedFault, TracedValue};
use schemars::JsonSchema;
use serde::Serialize;
use utoipa::ToSchema;

/// Most samples of a dry run.
pub const SAMPLES_MAX: usize = 10_000;

/// A recorded or live value to try a mapping on.
#[derive(Debug, Clone, PartialEq)]
pub struct DryRunSample {
    /// The name of the input.
    pub input: String,
    /// Arrival time by the local clock; timers that are due between two samples run in between.
    pub at: DateTime,
    pub value: DataValue,
}

/// Result of a dry run.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Trace {
    /// All diagnostics of the mapping; with an error there are no runs.
    pub diagnostics: Vec<MappingDiagnostic>,
    /// One run per sample, and per timer that ran out in between.
    pub runs: Vec<TraceRun>,
}

/// One run of the chain.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TraceRun {
    /// Time of the run by the local clock.
    pub at: DateTime,
    /// The input that changed; absent where time passed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<String>,
    /// Value that came in; absent where time passed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<TracedValue>,
    /// Results of the functions, as far as the chain got.
    pub steps: Vec<TraceStep>,
    /// Candidate; absent where the mapping yielded none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub candidate: Option<TracedValue>,
    /// Fault at the end of the chain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fault: Option<TracedFault>,
}
