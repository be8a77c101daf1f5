//! Messages of the worker.

use std::{sync::Arc, time::Duration};

use super::{ScriptFault, ScriptId};
use crate::{
    Sandbox,
    codec::{DecodeError, MessageDecoder, MessageEncoder},
    value::ScriptValue,
};

/// Frames that a worker writes to its host.
#[derive(Debug, Clone, PartialEq)]
pub enum WorkerMessage {
    /// Ready. Answers `Hello`.
    Welcome {
        /// The worker's [`crate::PROTOCOL_VERSION`].
        version: u16,
        /// Name and version of the engine.
        engine: Arc<str>,
        /// Walls around the worker.
        sandbox: Sandbox,
    },
    /// Answers `Load` after the script was compiled and run once.
    Loaded {
        script: ScriptId,
        /// Fault, where it did not load.
        fault: Option<ScriptFault>,
    },
    /// Answers `Batch`: a result for each call, in order. Fewer than calls when the batch took too
    /// long: the rest was not run.
    Results(Vec<CallResult>),
    /// Answers `Batch` in place of `Results`, and is the worker's last word: the call after these
    /// results could not be ended.
    Overrun(Vec<CallResult>),
    /// Answers `Load` in place of `Loaded`, and is the worker's last word: loading could not be
    /// ended.
    LoadOverrun(ScriptId),
}

/// A value with its status and time.
#[derive(Debug, Clone, PartialEq)]
pub struct Spoken {
    /// Value of a script's types.
    pub value: ScriptValue,
    /// OPC UA status code; 0 is Good.
    pub status: u32,
    /// Source time, in milliseconds since 1970.
    pub source_time_ms: Option<f64>,
}

/// Yield or fault of a script's call, with its state and time.
#[derive(Debug, Clone, PartialEq)]
pub struct CallResult {
    /// Yielded value or fault.
    pub outcome: Result<Yielded, ScriptFault>,
    /// `ctx.state` as JSON, where it changed.
    pub state: Option<Arc<str>>,
    /// Time by the wall clock.
    pub spent: Duration,
}

/// Value of a call that did not fail.
#[derive(Debug, Clone, PartialEq)]
pub enum Yielded {
    /// `undefined`: nothing to say.
    Nothing,
    /// A value, with a status worse than that of its inputs if the script said so.
    Value {
        /// Value of a script's types.
        value: ScriptValue,
        /// OPC UA status code; 0 where the script said nothing.
        status: u32,
    },
}

impl WorkerMessage {
    /// The body of a frame.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut to = MessageEncoder::new();
        match self {
            Self::Welcome { version, engine, sandbox } => {
                to.u8(0);
                to.u16(*version);
                to.text(engine);
                sandbox.encode(&mut to);
            }
            Self::Loaded { script, fault } => {
                to.u8(1);
                to.u32(script.0);
                to.option(fault.as_ref(), |to, fault| fault.encode(to));
            }
            Self::Results(results) => {
                to.u8(2);
                encode_results(&mut to, results);
            }
            Self::Overrun(results) => {
                to.u8(3);
                encode_results(&mut to, results);
            }
            Self::LoadOverrun(script) => {
                to.u8(4);
                to.u32(script.0);
            }
        }
        to.into_bytes()
    }

    /// Reads the body of a frame.
    ///
    /// # Errors
    /// [`DecodeError`] for bytes that are no message.
    pub fn decode(body: &[u8]) -> Result<Self, DecodeError> {
        let mut from = MessageDecoder::new(body);
        let message = match from.u8()? {
            0 => Self::Welcome {
                version: from.u16()?,
                engine: from.text()?,
                sandbox: Sandbox::decode(&mut from)?,
            },
            1 => Self::Loaded {
                script: ScriptId(from.u32()?),
                fault: from.option(ScriptFault::decode)?,
            },
            2 => Self::Results(from.sequence(CallResult::decode)?),
            3 => Self::Overrun(from.sequence(CallResult::decode)?),
            4 => Self::LoadOverrun(ScriptId(from.u32()?)),
            tag => return Err(DecodeError::UnknownTag { what: "a worker's message", tag }),
        };
        from.finish()?;
        Ok(message)
    }
}

fn encode_results(to: &mut MessageEncoder, results: &[CallResult]) {
    to.count(results.len());
    results.iter().for_each(|result| result.encode(to));
}

impl Spoken {
    pub(super) fn encode(&self, to: &mut MessageEncoder) {
        self.value.encode(to);
        to.u32(self.status);
        to.option(self.source_time_ms, MessageEncoder::f64);
    }

    pub(super) fn decode(from: &mut MessageDecoder<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            value: ScriptValue::decode(from)?,
            status: from.u32()?,
            source_time_ms: from.option(MessageDecoder::f64)?,
        })
    }
}

impl CallResult {
    fn encode(&self, to: &mut MessageEncoder) {
        match &self.outcome {
            Ok(Yielded::Nothing) => to.u8(0),
            Ok(Yielded::Value { value, status }) => {
                to.u8(1);
                value.encode(to);
                to.u32(*status);
            }
            Err(fault) => {
                to.u8(2);
                fault.encode(to);
            }
        }
        to.option(self.state.as_deref(), MessageEncoder::text);
        to.u32(u32::try_from(self.spent.as_micros()).unwrap_or(u32::MAX));
    }

    fn decode(from: &mut MessageDecoder<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            outcome: match from.u8()? {
                0 => Ok(Yielded::Nothing),
                1 => Ok(Yielded::Value { value: ScriptValue::decode(from)?, status: from.u32()? }),
                2 => Err(ScriptFault::decode(from)?),
                tag => return Err(DecodeError::UnknownTag { what: "a result", tag }),
            },
            state: from.option(MessageDecoder::text)?,
            spent: Duration::from_micros(from.u32()?.into()),
        })
    }
}
