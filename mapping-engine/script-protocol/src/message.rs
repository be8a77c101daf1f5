//! The messages.

mod host;
mod worker;

use std::{sync::Arc, time::Duration};

pub use host::{Call, CallValue, HostMessage, InputValue, Load};
pub use worker::{CallResult, Spoken, WorkerMessage, Yielded};

use crate::codec::{DecodeError, MessageDecoder, MessageEncoder};

/// A loaded script, by a number that its host chose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ScriptId(pub u32);

/// Longest `ctx.state` as JSON, in bytes.
pub const STATE_BYTES_MAX: usize = 4096;
/// Longest message of a fault, in bytes; longer ones are cut.
pub const FAULT_MESSAGE_BYTES_MAX: usize = 1024;

/// Limits of scripts and of their worker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScriptLimits {
    /// Memory of one script, in bytes.
    pub script_memory_bytes: u64,
    /// Stack of one script, in bytes.
    pub script_stack_bytes: u64,
    /// Computing time of one call.
    pub call_budget: Duration,
    /// After so much computing time within one call the worker ends itself, because nothing else
    /// ends the call.
    pub overrun_budget: Duration,
    /// After so much time the rest of a batch is given back.
    pub batch_budget: Duration,
    /// Address space of the worker, in bytes.
    pub address_space_bytes: u64,
}

impl ScriptLimits {
    fn encode(&self, to: &mut MessageEncoder) {
        let micros = |duration: Duration| u64::try_from(duration.as_micros()).unwrap_or(u64::MAX);
        to.u64(self.script_memory_bytes);
        to.u64(self.script_stack_bytes);
        to.u64(micros(self.call_budget));
        to.u64(micros(self.overrun_budget));
        to.u64(micros(self.batch_budget));
        to.u64(self.address_space_bytes);
    }

    fn decode(from: &mut MessageDecoder<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            script_memory_bytes: from.u64()?,
            script_stack_bytes: from.u64()?,
            call_budget: Duration::from_micros(from.u64()?),
            overrun_budget: Duration::from_micros(from.u64()?),
            batch_budget: Duration::from_micros(from.u64()?),
            address_space_bytes: from.u64()?,
        })
    }
}

/// Fault of a script that did not load, or of a call that did not yield.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScriptFault {
    /// Kind; the same for every engine.
    pub kind: FaultKind,
    /// The class of the error thrown, as `TypeError`; empty where it was none.
    pub name: Arc<str>,
    /// Message of the engine; texts differ between engines.
    pub message: Arc<str>,
    /// The line in the script, from 1.
    pub line: Option<u32>,
    /// The column in the script, from 1.
    pub column: Option<u32>,
}

/// Kinds of faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum FaultKind {
    /// The text is not JavaScript.
    Syntax = 0,
    /// An error was thrown.
    Error = 1,
    /// The call took longer than its budget.
    Timeout = 2,
    /// The script wanted more memory than its budget; it starts again from its state.
    OutOfMemory = 3,
    /// The result is not a value.
    Result = 4,
    /// No script has this id.
    NotLoaded = 5,
}

impl ScriptFault {
    /// A fault without position.
    #[must_use]
    pub fn new(kind: FaultKind, message: impl Into<Arc<str>>) -> Self {
        Self { kind, name: Arc::from(""), message: message.into(), line: None, column: None }
    }

    fn encode(&self, to: &mut MessageEncoder) {
        to.u8(self.kind as u8);
        to.text(cut(&self.name, 128));
        to.text(cut(&self.message, FAULT_MESSAGE_BYTES_MAX));
        to.option(self.line, MessageEncoder::u32);
        to.option(self.column, MessageEncoder::u32);
    }

    fn decode(from: &mut MessageDecoder<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            kind: match from.u8()? {
                0 => FaultKind::Syntax,
                1 => FaultKind::Error,
                2 => FaultKind::Timeout,
                3 => FaultKind::OutOfMemory,
                4 => FaultKind::Result,
                5 => FaultKind::NotLoaded,
                tag => return Err(DecodeError::UnknownTag { what: "a kind of fault", tag }),
            },
            name: from.text()?,
            message: from.text()?,
            line: from.option(MessageDecoder::u32)?,
            column: from.option(MessageDecoder::u32)?,
        })
    }
}

/// At most so many bytes of a text, without cutting a character in two.
fn cut(text: &str, bytes_max: usize) -> &str {
    &text[..text.floor_char_boundary(bytes_max)]
}

#[cfg(test)]
mod tests;
