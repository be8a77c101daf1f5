//! Diagnostics of a mapping: all at once, each with its position.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Fault or warning about a mapping document, with its JSON pointer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MappingDiagnostic {
    /// Severity; a mapping with an error does not run.
    pub severity: Severity,
    /// JSON pointer into the mapping, as `/steps/2/factor`.
    pub pointer: String,
    /// A stable code in camelCase.
    pub code: DiagnosticCode,
    /// Fault and remedy, in a sentence.
    pub message: String,
    /// The line in the expression or script, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// The column in the expression or script, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<u32>,
}

/// Severity of a diagnostic.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema, ToSchema,
)]
#[serde(rename_all = "camelCase")]
pub enum Severity {
    /// Good to know.
    Hint,
    /// Runs, but probably not as meant.
    Warning,
    /// Does not run.
    Error,
}

/// Stable codes of diagnostics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum DiagnosticCode {
    /// More of something than allowed.
    TooMany,
    /// Absence of what is needed.
    Missing,
    /// A name that breaks the rules or stands twice.
    InvalidName,
    /// A name that nothing has.
    UnknownName,
    /// A parameter outside of what it may be.
    InvalidParameter,
    /// A type that does not fit its function or the target.
    TypeMismatch,
    /// Digits or fractions may get lost.
    LossyConversion,
    /// A unit that is not known.
    UnknownUnit,
    /// Units of different kinds.
    IncompatibleUnits,
    /// The unit that leaves the chain is not the one asked for.
    UnitMismatch,
    /// Text that does not parse.
    Syntax,
    /// The script could not be tried.
    WorkerUnavailable,
    /// The script failed when it was loaded.
    ScriptFault,
    /// State outside `ctx.state`, which a restarted worker loses.
    ClosureState,
    /// An input that no function uses.
    UnusedInput,
}

impl MappingDiagnostic {
    /// An error at a place.
    #[must_use]
    pub fn error(
        pointer: impl Into<String>,
        code: DiagnosticCode,
        message: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Error, pointer, code, message)
    }

    /// A warning at a place.
    #[must_use]
    pub fn warning(
        pointer: impl Into<String>,
        code: DiagnosticCode,
        message: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Warning, pointer, code, message)
    }

    fn new(
        severity: Severity,
        pointer: impl Into<String>,
        code: DiagnosticCode,
        message: impl Into<String>,
    ) -> Self {
        let (pointer, message) = (pointer.into(), message.into());
        Self { severity, pointer, code, message, line: None, column: None }
    }

    /// The same with a position in an expression or script.
    #[must_use]
    pub fn at(mut self, line: Option<u32>, column: Option<u32>) -> Self {
        (self.line, self.column) = (line, column);
        self
    }

    /// True for what keeps the mapping from running.
    #[must_use]
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}
