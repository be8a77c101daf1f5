//! Values that expressions compute with.

use std::sync::Arc;

use asi_model::{Scalar, Variant};

use crate::{convert, fault::Fault, number::Number};

/// Operand or result of an expression.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Number(Number),
    Boolean(bool),
    Text(Arc<str>),
}

impl Value {
    /// Takes a value of the chain; times become milliseconds since 1970.
    ///
    /// # Errors
    /// A [`Fault`] for arrays, structures and nulls.
    pub fn of(value: &Variant) -> Result<Self, Fault> {
        let not_usable =
            || Fault::type_mismatch("an expression takes numbers, Booleans, texts and times only");
        let Variant::Scalar(scalar) = value else { return Err(not_usable()) };
        match scalar {
            Scalar::Boolean(v) => Ok(Self::Boolean(*v)),
            Scalar::DateTime(time) => Ok(Self::Number(Number::Integer(time.unix_millis().into()))),
            Scalar::String(Some(text)) => Ok(Self::Text(text.clone())),
            other => match Number::of(other) {
                Some(number) => Ok(Self::Number(number)),
                None => convert::to_text(other)
                    .map(|text| Self::Text(text.into()))
                    .ok_or_else(not_usable),
            },
        }
    }

    /// Returns the value for the chain; integers as Int64 or UInt64.
    pub fn into_variant(self) -> Variant {
        match self {
            Self::Number(number) => number.to_scalar().into(),
            Self::Boolean(v) => v.into(),
            Self::Text(text) => Scalar::String(Some(text)).into(),
        }
    }

    /// Returns the kind with its article, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Boolean(_) => "a Boolean",
            Self::Text(_) => "a text",
        }
    }
}

/// Kind of a value, as far as it is known before an expression runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ResultKind {
    Number,
    Boolean,
    Text,
}
