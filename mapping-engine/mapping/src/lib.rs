//! Mappings: the document that an engineer writes, and the transform that runs it.
//!
//! Pure: no I/O, no clock, no task. A [`Mapping`] names inputs, a chain of functions and a target
//! field. [`transform::compile`] checks it and makes a plan; a [`transform::Transform`] takes
//! values of inputs and yields candidates, whose state ([`TransformState`]) is stored with them.
//! The crate `mapping-engine` runs transforms on live values and calls scripts in worker processes.

pub mod comparison;
pub mod convert;
mod diagnostic;
mod document;
pub mod exchange;
mod expression;
mod fault;
mod number;
mod path;
mod publishing;
mod quality;
mod script_source;
mod state;
mod stored;
pub mod suggestion;
mod text;
mod trace;
pub mod transform;

pub use diagnostic::{DiagnosticCode, MappingDiagnostic, Severity};
pub use document::{
    Aggregate, Bit, BitText, BitTexts, Constant, Convert, Counter, CounterInput, Deadband,
    Debounce, Edge, EdgeDirection, Enumeration, EnumerationText, Expression, Format,
    INPUT_NAME_BYTES_MAX, INPUTS_MAX, Increment, InvalidMappingId, LateValues, Literal, Lookup,
    LookupEntry, Mapping, MappingId, MappingInput, Merge, MergeRule, OnDecrease, Overflow, Parse,
    Rate, RatePeriod, Rounding, SCRIPT_STEPS_MAX, STEPS_MAX, Scale, Script, Select, Step,
    Threshold, TypeName, UnitConversion, Window,
};
pub use fault::{Fault, FaultKind, FaultRecord};
pub use number::Number;
pub use publishing::{Candidate, PublishRequest, TargetKey};
pub use quality::Meta;
pub use state::TransformState;
pub use trace::{TraceStep, TracedFault, TracedValue};
