//! From local variables to the value a requested field may get.
//!
//! A [`Mapping`] names inputs, a chain of functions and a target field. The engine takes changes of inputs from the
//! shop floor, runs the chains - built-in functions in its own task, scripts in worker processes - and yields
//! *candidates*: values with status and times that the disclosure gate then judges. It ends there.

mod convert;
mod diagnostic;
mod fault;
mod inputs;
pub mod mapping;
mod number;

pub use diagnostic::{DiagnosticCode, MappingDiagnostic, Severity};
pub use fault::{Fault, FaultKind, FaultRecord};
pub use inputs::{InputChange, InputKey, Inputs, SourceId};
pub use mapping::{Literal, Mapping, MappingId, MappingInput, Step, TypeName};
pub use number::Number;
