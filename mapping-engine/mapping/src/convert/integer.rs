//! Numbers to integers: rounding, and the ranges of the integer types.

use asi_model::{BuiltInType, Scalar};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::{fault::Fault, number::Number};

/// Rounding of a fraction to an integer.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema, ToSchema,
)]
#[serde(rename_all = "camelCase")]
pub enum Rounding {
    /// To the nearest integer, halves away from zero.
    #[default]
    Nearest,
    /// To the nearest integer, halves to the even one.
    HalfEven,
    /// To the next lower integer.
    Down,
    /// To the next higher integer.
    Up,
    /// Digits after the point are cut off.
    TowardZero,
    /// A fraction is a fault.
    Exact,
}

/// Treatment of a number outside the wanted type's range.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema, ToSchema,
)]
#[serde(rename_all = "camelCase")]
pub enum Overflow {
    /// A fault: the candidate is BadOutOfRange.
    #[default]
    Fault,
    /// The nearest value of the type.
    Clamp,
}

/// A number as one of the integer types.
///
/// # Errors
/// [`Fault`] `BadOutOfRange` where it is NaN, has a fraction under [`Rounding::Exact`], or lies
/// outside the type under [`Overflow::Fault`].
pub fn to_integer(
    number: Number,
    to: BuiltInType,
    rounding: Rounding,
    overflow: Overflow,
) -> Result<Scalar, Fault> {
    let integer = match number {
        Number::Integer(v) => v,
        Number::Real(v) => round(v, rounding)?,
    };
    if let Some(scalar) = Scalar::from_i128(integer, to) {
        return Ok(scalar);
    }
    let (low, high) = range(to);
    match overflow {
        Overflow::Clamp => Scalar::from_i128(integer.clamp(low, high), to)
            .ok_or_else(|| Fault::type_mismatch(format!("{to} is not an integer type"))),
        Overflow::Fault => {
            Err(Fault::out_of_range(format!("the number is outside of {to} ({low} to {high})")))
        }
    }
}

/// A double as integer; saturates beyond `i128`, whose ends lie outside every OPC UA type.
///
/// # Errors
/// [`Fault`] for NaN, and for a fraction under [`Rounding::Exact`].
pub fn round(real: f64, rounding: Rounding) -> Result<i128, Fault> {
    if real.is_nan() {
        return Err(Fault::out_of_range("NaN is not an integer".to_owned()));
    }
    let whole = match rounding {
        Rounding::Nearest => real.round(),
        Rounding::HalfEven => real.round_ties_even(),
        Rounding::Down => real.floor(),
        Rounding::Up => real.ceil(),
        Rounding::TowardZero => real.trunc(),
        Rounding::Exact if real.is_finite() && real.fract() != 0.0 => {
            let how =
                "the number has a fraction but an integer is wanted: add a convert with a rounding";
            return Err(Fault::out_of_range(how.to_owned()));
        }
        Rounding::Exact => real,
    };
    #[allow(clippy::cast_possible_truncation)]
    Ok(whole as i128)
}

/// The least and greatest value of an integer type; (0, 0) for others.
#[must_use]
pub const fn range(integer: BuiltInType) -> (i128, i128) {
    use BuiltInType as T;
    match integer {
        T::SByte => (i8::MIN as i128, i8::MAX as i128),
        T::Byte => (0, u8::MAX as i128),
        T::Int16 => (i16::MIN as i128, i16::MAX as i128),
        T::UInt16 => (0, u16::MAX as i128),
        T::Int32 => (i32::MIN as i128, i32::MAX as i128),
        T::UInt32 => (0, u32::MAX as i128),
        T::Int64 => (i64::MIN as i128, i64::MAX as i128),
        T::UInt64 => (0, u64::MAX as i128),
        _ => (0, 0),
    }
}
