//! From local variables to the value a requested field may get.
//!
//! A [`Mapping`] names inputs, a chain of functions and a target field. The engine takes changes of
//! inputs from the shop floor, runs the chains - built-in functions in its own task, scripts in
//! worker processes - and yields *candidates*: values with status and times that the disclosure
//! gate then judges. It ends there.

pub mod comparison;
mod convert;
mod diagnostic;
mod dry_run;
mod engine;
pub mod exchange;
mod expression;
mod fault;
mod inputs;
pub mod mapping;
mod number;
mod path;
mod quality;
mod script;
mod script_source;
mod state;
mod stored;
pub mod suggestion;
mod text;
mod transform;

pub use diagnostic::{DiagnosticCode, MappingDiagnostic, Severity};
pub use dry_run::{DryRunSample, Trace, TraceRun, TraceStep, TracedFault, TracedValue};
pub use engine::{
    Candidate, CircuitState, EngineError, HealthCounts, HistoryConfig, InputStatus, MappingEngine,
    MappingEngineConfig, MappingEngineHandle, MappingHealth, MappingStatus, MappingSurvey,
    Published, SurveyedMapping, TargetKey,
};
pub use fault::{Fault, FaultKind, FaultRecord};
pub use inputs::Inputs;
pub use mapping::{Literal, Mapping, MappingId, MappingInput, Step, TypeName};
pub use number::Number;
pub use script::config::{ScriptConfig, ScriptEngine};
pub use state::TransformState;
