//! The OPC UA JSON data encoding (OPC 10000-6 §5.4, deprecated forms in Annex H) of every built-in
//! type, both ways.
//!
//! Four forms are written ([`DataEncoding`]); all of them are read, told apart by their shape. What
//! deviates from the standard harmlessly is read with a [`Diagnostic`], unless [`Leniency::Strict`]
//! is asked for.

pub(crate) mod decode;
mod decode_array;
pub(crate) mod decode_scalar;
mod decode_structure;
pub(crate) mod encode;
mod encode_names;
mod encode_structure;
mod shape;

use std::{borrow::Cow, sync::Arc};

pub use decode::{DecodedValue, Decoder};
pub use encode::Encoder;

use crate::{
    json::{JsonError, Limits, Node, Tape},
    values::{DataValue, StatusCode, StructureType, Variant},
};

/// The forms in which values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DataEncoding {
    /// 1.04 reversible: `{"Type": 9, "Body": "1"}`.
    Reversible104,
    /// 1.04 non-reversible: the bare value. Locales, types and switch fields are lost.
    NonReversible104,
    /// 1.05 compact: `{"UaType": 9, "Value": "1"}`.
    Compact105,
    /// 1.05 verbose: as compact, with symbols and defaults for people.
    Verbose105,
}

impl DataEncoding {
    /// One of the two forms of 1.05.
    #[must_use]
    pub const fn is_105(self) -> bool {
        matches!(self, Self::Compact105 | Self::Verbose105)
    }
}

/// How deviations from the standard are met on input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Leniency {
    /// Harmless ones are taken, with a diagnostic.
    #[default]
    Lenient,
    /// They are errors.
    Strict,
}

/// Something noteworthy about an input that was taken nevertheless.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// JSON pointer to it.
    pub pointer: String,
    /// A sentence.
    pub message: String,
}

/// A value that cannot be taken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ValueError {
    /// The text is not JSON or breaks a limit.
    #[error("the value is not acceptable JSON")]
    Json(#[from] JsonError),
    /// The JSON is not a value of the type.
    #[error("{pointer}: {message}")]
    Mismatch {
        /// JSON pointer to what is wrong.
        pointer: String,
        /// What is wrong.
        message: String,
        /// The status that a field with this value gets.
        status: StatusCode,
    },
}

/// Where in a text a value is not what it should be; the pointer is only made when somebody wants
/// to read it.
#[derive(Debug)]
pub(crate) struct Mismatch<'t, 'a> {
    pub(crate) node: Node<'t, 'a>,
    pub(crate) message: Cow<'static, str>,
    pub(crate) status: StatusCode,
}

impl<'t, 'a> Mismatch<'t, 'a> {
    pub(crate) fn new(node: Node<'t, 'a>, message: impl Into<Cow<'static, str>>) -> Self {
        Self { node, message: message.into(), status: StatusCode::BAD_TYPE_MISMATCH }
    }

    pub(crate) fn out_of_range(node: Node<'t, 'a>, message: impl Into<Cow<'static, str>>) -> Self {
        Self { status: StatusCode::BAD_OUT_OF_RANGE, ..Self::new(node, message) }
    }

    pub(crate) fn into_error(self) -> ValueError {
        ValueError::Mismatch {
            pointer: self.node.pointer(),
            message: self.message.into_owned(),
            status: self.status,
        }
    }
}

/// Bounds on values and messages: 1 MiB, nesting of 100 (OPC 10000-6 §5.1.5), and one token per two
/// bytes at most.
pub const LIMITS: Limits =
    Limits { bytes_max: crate::messages::REQUEST_BYTES_MAX, depth_max: 100, tokens_max: 400_000 };

/// Writes a variant.
#[must_use]
pub fn encode_variant(value: &Variant, encoding: DataEncoding) -> Vec<u8> {
    let mut out = Vec::with_capacity(64);
    Encoder::new(encoding).variant(&mut out, value);
    out
}

/// Writes a value with status and times.
#[must_use]
pub fn encode_data_value(value: &DataValue, encoding: DataEncoding) -> Vec<u8> {
    let mut out = Vec::with_capacity(96);
    Encoder::new(encoding).data_value(&mut out, value);
    out
}

/// Reads a variant, data value or bare value in whichever form it is.
///
/// # Errors
/// [`ValueError`] where the text is not JSON, or not a value.
pub fn decode_value(
    bytes: &[u8],
    leniency: Leniency,
    types: &[StructureType],
    namespaces: &[Arc<str>],
) -> Result<(DecodedValue, Vec<Diagnostic>), ValueError> {
    let tape = Tape::read(bytes, LIMITS)?;
    let mut decoder = Decoder::new(leniency, types, namespaces);
    if let Some(pointer) = tape.duplicates().next() {
        let message = "the member occurs twice".to_owned();
        return Err(ValueError::Mismatch {
            pointer,
            message,
            status: StatusCode::BAD_DECODING_ERROR,
        });
    }
    let value = decoder.value(tape.root(), None).map_err(Mismatch::into_error)?;
    Ok((value, decoder.into_diagnostics()))
}

#[cfg(test)]
pub(crate) mod arbitrary;
#[cfg(test)]
mod tests;
