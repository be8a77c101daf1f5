//! The OPC UA JSON data encoding (OPC 10000-6 §5.4, deprecated forms in Annex H) of every built-in
//! type, both ways.
//!
//! Four forms are written ([`DataEncoding`]); all of them are read, told apart by their shape. What
//! deviates from the standard harmlessly is read with a [`Diagnostic`], unless [`Leniency::Strict`]
//! is asked for.

pub(crate) mod decode;
mod decode_array;
mod decode_names;
pub(crate) mod decode_scalar;
mod decode_structure;
mod decoded_value;
mod diagnostics;
pub(crate) mod encode;
mod encode_names;
mod encode_structure;
mod mismatch;
mod shape;

use std::sync::Arc;

pub use decode::Decoder;
pub use decoded_value::DecodedValue;
pub use diagnostics::{Diagnostic, Leniency};
pub use encode::{DataEncoding, Encoder};
pub(crate) use mismatch::Mismatch;
pub use mismatch::ValueError;

use crate::{
    json::{Limits, Tape},
    values::{DataValue, StatusCode, StructureType, Variant},
};

/// Bounds on values and messages: 1 MiB, nesting of 100 (OPC 10000-6 §5.1.5), and one token per two
/// bytes at most.
pub const LIMITS: Limits =
    Limits { bytes_max: crate::messages::REQUEST_BYTES_MAX, depth_max: 100, tokens_max: 400_000 };

/// Returns a variant as JSON text in UTF-8 (OPC 10000-6 §5.4).
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

/// Reads a variant, data value or bare value in any form.
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
    Ok((value, decoder.diagnostics.into_list()))
}

#[cfg(test)]
pub(crate) mod arbitrary;
#[cfg(test)]
mod tests;
