//! QuickJS errors as faults of the protocol.

use rquickjs::{CaughtError, Coerced, Ctx, Exception, FromJs};
use script_protocol::{
    FaultKind, ScriptFault,
    worker::fault::{out_of_memory, position, thrown},
};

/// Interruption of a call or conversion.
#[derive(Debug)]
pub enum Failure {
    /// JavaScript threw (a getter of the result, say), or the engine failed.
    Engine(rquickjs::Error),
    /// The script broke a rule of the protocol.
    Fault(ScriptFault),
}

impl From<rquickjs::Error> for Failure {
    fn from(error: rquickjs::Error) -> Self {
        Self::Engine(error)
    }
}

impl From<ScriptFault> for Failure {
    fn from(fault: ScriptFault) -> Self {
        Self::Fault(fault)
    }
}

impl Failure {
    /// Returns the fault, and takes the thrown error from the context where there is one. `file` is
    /// the script's name as it was given to the engine.
    pub fn into_fault(self, ctx: &Ctx<'_>, file: &str) -> ScriptFault {
        match self {
            Self::Engine(error) => of_caught(ctx, CaughtError::from_error(ctx, error), file),
            Self::Fault(fault) => fault,
        }
    }
}

fn of_caught<'js>(ctx: &Ctx<'js>, caught: CaughtError<'js>, file: &str) -> ScriptFault {
    match caught {
        CaughtError::Exception(exception) => of_exception(&exception, file),
        // The engine throws null where it has no memory left for an error object.
        CaughtError::Value(value) if value.is_null() || value.is_undefined() => out_of_memory(),
        CaughtError::Value(value) => {
            let text = Coerced::<String>::from_js(ctx, value)
                .map_or_else(|_| "a thrown value".to_owned(), |t| t.0);
            ScriptFault::new(FaultKind::Error, text)
        }
        // Rust-side conversions: a text that is not UTF-8, or memory that ran out there.
        CaughtError::Error(rquickjs::Error::Allocation) => out_of_memory(),
        CaughtError::Error(error) => ScriptFault::new(FaultKind::Result, error.to_string()),
    }
}

fn of_exception(exception: &Exception<'_>, file: &str) -> ScriptFault {
    let name: String = exception.as_object().get("name").unwrap_or_default();
    let message = exception.message().unwrap_or_default();
    if name == "InternalError" && message.contains("out of memory") {
        return out_of_memory();
    }
    let position = exception.stack().as_deref().and_then(|stack| position(stack, file));
    thrown(name, message, position)
}
