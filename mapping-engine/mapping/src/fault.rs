//! Faults of functions on single values.

use std::sync::Arc;

use asi_model::{DateTime, StatusCode};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A function could not make a value of what it got. The candidate is then without value and has
/// [`Fault::status`].
///
/// The message is for the factory engineer; it may name parameters, never the value itself.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Fault {
    /// Status that the partner sees instead of a value.
    pub status: StatusCode,
    /// Kind, for programs.
    pub kind: FaultKind,
    /// Sentence that names the fault, without the value.
    pub message: Arc<str>,
    /// The line in the script, from 1.
    pub line: Option<u32>,
    /// The column in the script, from 1.
    pub column: Option<u32>,
}

/// Kinds of faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum FaultKind {
    /// The value is of a type that the function does not take.
    TypeMismatch,
    /// The value or result lies outside what the type or table can say.
    OutOfRange,
    /// A text is not what it should be.
    Decoding,
    /// A script does not compile.
    ScriptSyntax,
    /// A script threw an error.
    ScriptError,
    /// A script ran longer than its budget.
    ScriptTimeout,
    /// A script wanted more memory than its budget.
    ScriptOutOfMemory,
    /// A script returned something that is not a value.
    ScriptResult,
    /// A script took its worker process down.
    ScriptCrash,
    /// The script worker cannot be started.
    WorkerUnavailable,
    /// The script is not run at present because it failed too often.
    CircuitOpen,
}

impl Fault {
    /// A fault without a position.
    #[must_use]
    pub fn new(kind: FaultKind, status: StatusCode, message: impl Into<Arc<str>>) -> Self {
        Self { status, kind, message: message.into(), line: None, column: None }
    }

    /// The types do not fit.
    #[must_use]
    pub fn type_mismatch(message: impl Into<Arc<str>>) -> Self {
        Self::new(FaultKind::TypeMismatch, StatusCode::BAD_TYPE_MISMATCH, message)
    }

    /// The value is outside of what can be said.
    #[must_use]
    pub fn out_of_range(message: impl Into<Arc<str>>) -> Self {
        Self::new(FaultKind::OutOfRange, StatusCode::BAD_OUT_OF_RANGE, message)
    }

    /// A text is not what it should be.
    #[must_use]
    pub fn decoding(message: impl Into<Arc<str>>) -> Self {
        Self::new(FaultKind::Decoding, StatusCode::BAD_DECODING_ERROR, message)
    }
}

/// A fault with its place and time, as shown to the engineer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FaultRecord {
    /// Time of the fault by the local clock.
    pub at: DateTime,
    /// Index of the function in the chain; absent for the end of the chain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<usize>,
    /// Kind, for programs.
    pub kind: FaultKind,
    /// Sentence that names the fault, without the value.
    pub message: String,
    /// The line in the script, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// The column in the script, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<u32>,
}

impl FaultRecord {
    /// A fault seen at a time at a function.
    #[must_use]
    pub fn new(at: DateTime, step: Option<usize>, fault: &Fault) -> Self {
        let Fault { kind, message, line, column, .. } = fault;
        Self { at, step, kind: *kind, message: message.to_string(), line: *line, column: *column }
    }
}
