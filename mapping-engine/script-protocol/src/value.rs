//! Values as scripts see them.

use std::sync::Arc;

use crate::codec::{DecodeError, MessageDecoder, MessageEncoder};

/// Deepest nesting of lists and records.
pub const DEPTH_MAX: usize = 16;

/// A value on its way into a script or out of it: what the value types of JavaScript can say, and
/// no more.
#[derive(Debug, Clone, PartialEq)]
pub enum ScriptValue {
    /// `null`, for null values and opaque structures.
    Null,
    /// `true` or `false`.
    Boolean(bool),
    /// A number: all integers up to 32 bits, Float and Double.
    Number(f64),
    /// A BigInt that fits 64 bits with sign.
    Signed(i64),
    /// A BigInt that fits 64 bits without sign.
    Unsigned(u64),
    /// A text in UTF-8.
    Text(Arc<str>),
    /// A `Date`, in milliseconds since 1970; the fraction survives into the script only as far as
    /// `Date` keeps it.
    Time(f64),
    /// A `Uint8Array`, a ByteString of OPC UA.
    Bytes(Arc<[u8]>),
    /// An array of any values.
    List(Vec<ScriptValue>),
    /// An object's own members, in order.
    Record(Vec<(Arc<str>, ScriptValue)>),
}

impl ScriptValue {
    /// Appends the value.
    pub fn encode(&self, to: &mut MessageEncoder) {
        match self {
            Self::Null => to.u8(0),
            Self::Boolean(v) => {
                to.u8(1);
                to.u8((*v).into());
            }
            Self::Number(v) => {
                to.u8(2);
                to.f64(*v);
            }
            Self::Signed(v) => {
                to.u8(3);
                to.i64(*v);
            }
            Self::Unsigned(v) => {
                to.u8(4);
                to.u64(*v);
            }
            Self::Text(v) => {
                to.u8(5);
                to.text(v);
            }
            Self::Time(v) => {
                to.u8(6);
                to.f64(*v);
            }
            Self::Bytes(v) => {
                to.u8(7);
                to.bytes(v);
            }
            Self::List(values) => {
                to.u8(8);
                to.count(values.len());
                values.iter().for_each(|value| value.encode(to));
            }
            Self::Record(members) => {
                to.u8(9);
                to.count(members.len());
                for (name, value) in members {
                    to.text(name);
                    value.encode(to);
                }
            }
        }
    }

    /// Takes a value.
    ///
    /// # Errors
    /// [`DecodeError`] for bytes that are none, and beyond [`DEPTH_MAX`].
    pub fn decode(from: &mut MessageDecoder<'_>) -> Result<Self, DecodeError> {
        Self::decode_nested(from, 0)
    }

    fn decode_nested(from: &mut MessageDecoder<'_>, depth: usize) -> Result<Self, DecodeError> {
        if depth > DEPTH_MAX {
            return Err(DecodeError::TooDeep(DEPTH_MAX));
        }
        Ok(match from.u8()? {
            0 => Self::Null,
            1 => match from.u8()? {
                0 => Self::Boolean(false),
                1 => Self::Boolean(true),
                tag => return Err(DecodeError::UnknownTag { what: "a Boolean", tag }),
            },
            2 => Self::Number(from.f64()?),
            3 => Self::Signed(from.i64()?),
            4 => Self::Unsigned(from.u64()?),
            5 => Self::Text(from.text()?),
            6 => Self::Time(from.f64()?),
            7 => Self::Bytes(from.bytes()?.into()),
            8 => Self::List(from.sequence(|from| Self::decode_nested(from, depth + 1))?),
            9 => Self::Record(
                from.sequence(|from| Ok((from.text()?, Self::decode_nested(from, depth + 1)?)))?,
            ),
            tag => return Err(DecodeError::UnknownTag { what: "a value", tag }),
        })
    }
}
