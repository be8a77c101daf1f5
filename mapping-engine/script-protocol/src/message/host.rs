//! Messages of the host.

use std::sync::Arc;

use super::{ScriptId, ScriptLimits, Spoken};
use crate::codec::{DecodeError, MessageDecoder, MessageEncoder};

/// Frames that the host writes to a worker.
#[derive(Debug, Clone, PartialEq)]
pub enum HostMessage {
    /// The first message: the protocol's version and what scripts may use. Answered by `Welcome`.
    Hello {
        /// The host's [`crate::PROTOCOL_VERSION`].
        version: u16,
        /// Limits of scripts and of the worker.
        limits: ScriptLimits,
    },
    /// Loads a script, in place of the one with the same id. Answered by `Loaded`.
    Load(Load),
    /// Forgets a script. Not answered.
    Unload(ScriptId),
    /// Calls, in this order. Answered by `Results` or `Overrun`.
    Batch(Vec<Call>),
}

/// A script.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Id that the host chose.
    pub script: ScriptId,
    /// Name in errors, as `frame-4711.js`.
    pub name: Arc<str>,
    pub source: Arc<str>,
    /// The names under `ctx.inputs`.
    pub inputs: Vec<Arc<str>>,
    /// `ctx.state` as JSON, from a former run.
    pub state: Option<Arc<str>>,
    /// The values of inputs that are known already.
    pub values: Vec<InputValue>,
}

/// A value under `ctx.inputs`.
#[derive(Debug, Clone, PartialEq)]
pub struct InputValue {
    /// Position among the script's inputs.
    pub input: u16,
    /// Value with status and time.
    pub spoken: Spoken,
}

/// One call of a script.
#[derive(Debug, Clone, PartialEq)]
pub struct Call {
    pub script: ScriptId,
    /// Argument of the call.
    pub value: CallValue,
    /// Inputs that changed since its last call.
    pub inputs: Vec<InputValue>,
}

/// Argument of a call.
#[derive(Debug, Clone, PartialEq)]
pub enum CallValue {
    /// The value of the input at this position, as it is after the call's changes.
    Input(u16),
    /// A value of its own.
    Own(Spoken),
}

impl HostMessage {
    /// The body of a frame.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut to = MessageEncoder::new();
        match self {
            Self::Hello { version, limits } => {
                to.u8(0);
                to.u16(*version);
                limits.encode(&mut to);
            }
            Self::Load(load) => {
                to.u8(1);
                load.encode(&mut to);
            }
            Self::Unload(script) => {
                to.u8(2);
                to.u32(script.0);
            }
            Self::Batch(calls) => return Self::encode_batch(calls),
        }
        to.into_bytes()
    }

    /// The body of a frame with a [`Self::Batch`] of calls that stay where they are.
    #[must_use]
    pub fn encode_batch(calls: &[Call]) -> Vec<u8> {
        let mut to = MessageEncoder::new();
        to.u8(3);
        to.count(calls.len());
        calls.iter().for_each(|call| call.encode(&mut to));
        to.into_bytes()
    }

    /// Reads the body of a frame.
    ///
    /// # Errors
    /// [`DecodeError`] for bytes that are no message.
    pub fn decode(body: &[u8]) -> Result<Self, DecodeError> {
        let mut from = MessageDecoder::new(body);
        let message = match from.u8()? {
            0 => Self::Hello { version: from.u16()?, limits: ScriptLimits::decode(&mut from)? },
            1 => Self::Load(Load::decode(&mut from)?),
            2 => Self::Unload(ScriptId(from.u32()?)),
            3 => Self::Batch(from.sequence(Call::decode)?),
            tag => return Err(DecodeError::UnknownTag { what: "a host's message", tag }),
        };
        from.finish()?;
        Ok(message)
    }
}

impl Load {
    /// Stores the newest values of inputs, in place of their former ones.
    pub fn set_values(&mut self, inputs: &[InputValue]) {
        for input in inputs {
            match self.values.iter_mut().find(|known| known.input == input.input) {
                Some(known) => known.spoken.clone_from(&input.spoken),
                None => self.values.push(input.clone()),
            }
        }
    }

    fn encode(&self, to: &mut MessageEncoder) {
        to.u32(self.script.0);
        to.text(&self.name);
        to.text(&self.source);
        to.count(self.inputs.len());
        self.inputs.iter().for_each(|name| to.text(name));
        to.option(self.state.as_deref(), MessageEncoder::text);
        to.count(self.values.len());
        self.values.iter().for_each(|value| value.encode(to));
    }

    fn decode(from: &mut MessageDecoder<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            script: ScriptId(from.u32()?),
            name: from.text()?,
            source: from.text()?,
            inputs: from.sequence(MessageDecoder::text)?,
            state: from.option(MessageDecoder::text)?,
            values: from.sequence(InputValue::decode)?,
        })
    }
}

impl InputValue {
    fn encode(&self, to: &mut MessageEncoder) {
        to.u16(self.input);
        self.spoken.encode(to);
    }

    fn decode(from: &mut MessageDecoder<'_>) -> Result<Self, DecodeError> {
        Ok(Self { input: from.u16()?, spoken: Spoken::decode(from)? })
    }
}

impl Call {
    /// Approximate bytes of the call in a frame.
    #[must_use]
    pub fn size(&self) -> usize {
        let mut to = MessageEncoder::new();
        self.encode(&mut to);
        to.len()
    }

    fn encode(&self, to: &mut MessageEncoder) {
        to.u32(self.script.0);
        match &self.value {
            CallValue::Input(index) => {
                to.u8(0);
                to.u16(*index);
            }
            CallValue::Own(spoken) => {
                to.u8(1);
                spoken.encode(to);
            }
        }
        to.count(self.inputs.len());
        self.inputs.iter().for_each(|input| input.encode(to));
    }

    fn decode(from: &mut MessageDecoder<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            script: ScriptId(from.u32()?),
            value: match from.u8()? {
                0 => CallValue::Input(from.u16()?),
                1 => CallValue::Own(Spoken::decode(from)?),
                tag => return Err(DecodeError::UnknownTag { what: "a call's value", tag }),
            },
            inputs: from.sequence(InputValue::decode)?,
        })
    }
}
