//! Scripts, which run in worker processes.
//!
//! A worker is started when the first script needs it, gets its limits, and is killed and restarted
//! when it breaks them. [`worker::ScriptWorker`] hides this: callers get a result for every call,
//! and the fault of a call that ended the worker is that call's fault only.

pub(crate) mod breaker;
pub(crate) mod config;
mod process;
pub(crate) mod status;
pub(crate) mod values;
pub(crate) mod worker;
pub(crate) mod worker_queue;

use std::{sync::Arc, time::Duration};

use asi_model::StatusCode;
use mapping::{Fault, FaultKind};
use script_protocol::{FaultKind as Kind, ScriptFault};

/// Outcome of one call.
#[derive(Debug, Clone)]
pub(crate) struct ScriptOutcome {
    pub result: Result<script_protocol::Yielded, Fault>,
    /// `ctx.state` where it changed.
    pub state: Option<Arc<str>>,
    pub spent: Duration,
    /// The call took the worker down.
    pub is_fatal: bool,
}

impl ScriptOutcome {
    fn failed(fault: Fault, is_fatal: bool) -> Self {
        Self { result: Err(fault), state: None, spent: Duration::ZERO, is_fatal }
    }
}

/// Returns a script's fault with its OPC UA status.
pub(crate) fn fault_of(fault: ScriptFault) -> Fault {
    let (kind, status) = match fault.kind {
        Kind::Syntax => (FaultKind::ScriptSyntax, StatusCode::BAD_CONFIGURATION_ERROR),
        Kind::Error => (FaultKind::ScriptError, StatusCode::BAD_UNEXPECTED_ERROR),
        Kind::Timeout => (FaultKind::ScriptTimeout, StatusCode::BAD_TIMEOUT),
        Kind::OutOfMemory => (FaultKind::ScriptOutOfMemory, StatusCode::BAD_RESOURCE_UNAVAILABLE),
        Kind::Result => (FaultKind::ScriptResult, StatusCode::BAD_TYPE_MISMATCH),
        Kind::NotLoaded => (FaultKind::WorkerUnavailable, StatusCode::BAD_OUT_OF_SERVICE),
    };
    let message = if fault.name.is_empty() {
        fault.message
    } else {
        format!("{}: {}", fault.name, fault.message).into()
    };
    Fault { status, kind, message, line: fault.line, column: fault.column }
}

/// The fault of everything that a worker which does not start cannot do.
pub(crate) fn unavailable(message: impl Into<Arc<str>>) -> Fault {
    Fault::new(FaultKind::WorkerUnavailable, StatusCode::BAD_OUT_OF_SERVICE, message)
}
