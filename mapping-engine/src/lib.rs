//! Engine that leads from local variables to the value a requested field may get.
//!
//! A [`Mapping`] names inputs, a chain of functions and a target field. The engine takes changes of
//! inputs from the shop floor, runs the chains - built-in functions in its own task, scripts in
//! worker processes - and yields *candidates*: values with status and times that the disclosure
//! gate then judges. It ends there.

mod dry_run;
mod engine;
mod inputs;
mod script;
mod unreleased;

// The documents and their transforms have a pure crate of their own; users of the engine need not
// name it.
pub use ::mapping;
pub use mapping::{
    Candidate, DiagnosticCode, Fault, FaultKind, FaultRecord, Literal, Mapping, MappingDiagnostic,
    MappingId, MappingInput, Number, PublishRequest, PublishRequest as Published, Severity, Step,
    TargetKey, TraceStep, TracedFault, TracedValue, TransformState, TypeName, comparison, exchange,
    suggestion,
};

pub use dry_run::{DryRunSample, Trace, TraceRun};
pub use engine::{
    CircuitState, EngineError, HealthCounts, HistoryConfig, InputStatus, MappingEngine,
    MappingEngineConfig, MappingEngineHandle, MappingHealth, MappingStatus, MappingSurvey,
    SurveyedMapping, VariableRecording,
};
pub use inputs::Inputs;
pub use script::{
    config::{ScriptConfig, ScriptRuntime},
    status::{LandlockState, ScriptWorkerStatus, WorkerPurpose, WorkerWalls},
};
pub use unreleased::{SeesUnreleased, Unreleased};
