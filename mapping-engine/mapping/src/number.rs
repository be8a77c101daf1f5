//! Numbers as mappings compute with them: integers stay exact integers, everything else is a
//! double.
//!
//! OPC UA has 64-bit integers of both signs; a detour over `f64` damages them beyond 2^53. So
//! arithmetic is done on `i128` as long as both sides are integers and the result is one.

use std::{borrow::Cow, cmp::Ordering, fmt, str::FromStr};

use asi_model::{BuiltInType, Scalar};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use utoipa::openapi::{ObjectBuilder, RefOr, schema::SchemaType};

/// An exact integer or a double. In JSON a number; integers beyond 2^53 may be given as text.
#[derive(Debug, Clone, Copy)]
pub enum Number {
    /// An integer: everything from `Int64::MIN` to `UInt64::MAX` and intermediate results beyond.
    Integer(i128),
    /// A floating-point number; Float widens to it exactly.
    Real(f64),
}

impl Number {
    /// Integer 0.
    pub const ZERO: Self = Self::Integer(0);
    /// Integer 1.
    pub const ONE: Self = Self::Integer(1);

    /// The number of a numeric scalar or Boolean (false 0, true 1).
    #[must_use]
    pub fn of(scalar: &Scalar) -> Option<Self> {
        match scalar {
            Scalar::Float(v) => Some(Self::Real(f64::from(*v))),
            Scalar::Double(v) => Some(Self::Real(*v)),
            other => other.as_i128().map(Self::Integer),
        }
    }

    /// Converts to a double; integers beyond 2^53 lose digits.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub const fn as_f64(self) -> f64 {
        match (self, self.small()) {
            (_, Some(v)) => v as f64,
            (Self::Integer(v), None) => v as f64,
            (Self::Real(v), None) => v,
        }
    }

    /// An integer of 64 bits: nearly all are, and computing with 128 is done by software where it
    /// is not a sum.
    #[allow(clippy::cast_possible_truncation)]
    const fn small(self) -> Option<i64> {
        match self {
            Self::Integer(v) if v as i64 as i128 == v => Some(v as i64),
            _ => None,
        }
    }

    /// Converts to a scalar: Int64 or UInt64 where an integer fits, else Double.
    #[must_use]
    pub fn to_scalar(self) -> Scalar {
        match self {
            Self::Integer(v) => Scalar::from_i128(v, BuiltInType::Int64)
                .or_else(|| Scalar::from_i128(v, BuiltInType::UInt64))
                .unwrap_or_else(|| Scalar::Double(self.as_f64())),
            Self::Real(v) => Scalar::Double(v),
        }
    }

    /// True for zero.
    #[must_use]
    pub fn is_zero(self) -> bool {
        match self {
            Self::Integer(v) => v == 0,
            Self::Real(v) => v == 0.0,
        }
    }

    /// True unless it is a NaN or an infinity.
    #[must_use]
    pub const fn is_finite(self) -> bool {
        match self {
            Self::Integer(_) => true,
            Self::Real(v) => v.is_finite(),
        }
    }

    /// Sum; `None` on integer overflow.
    #[must_use]
    pub fn plus(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Integer(a), Self::Integer(b)) => a.checked_add(b).map(Self::Integer),
            (a, b) => Some(Self::Real(a.as_f64() + b.as_f64())),
        }
    }

    /// Difference; `None` on integer overflow.
    #[must_use]
    pub fn minus(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Integer(a), Self::Integer(b)) => a.checked_sub(b).map(Self::Integer),
            (a, b) => Some(Self::Real(a.as_f64() - b.as_f64())),
        }
    }

    /// Product; `None` on integer overflow.
    #[must_use]
    pub fn times(self, other: Self) -> Option<Self> {
        if let (Some(a), Some(b)) = (self.small(), other.small()) {
            return Some(Self::Integer(i128::from(a) * i128::from(b)));
        }
        match (self, other) {
            (Self::Integer(a), Self::Integer(b)) => a.checked_mul(b).map(Self::Integer),
            (a, b) => Some(Self::Real(a.as_f64() * b.as_f64())),
        }
    }

    /// Quotient: an integer where both sides are and it comes out even, else a double. `None` on
    /// division by zero.
    #[must_use]
    pub fn divided_by(self, other: Self) -> Option<Self> {
        if other.is_zero() {
            return None;
        }
        if let (Some(a), Some(b)) = (self.small(), other.small())
            && let (Some(quotient), Some(rest)) = (a.checked_div(b), a.checked_rem(b))
        {
            return Some(if rest == 0 {
                quotient.into()
            } else {
                Self::Real(self.as_f64() / other.as_f64())
            });
        }
        match (self, other) {
            (Self::Integer(a), Self::Integer(b)) if a.checked_rem(b) == Some(0) => {
                a.checked_div(b).map(Self::Integer)
            }
            (a, b) => Some(Self::Real(a.as_f64() / b.as_f64())),
        }
    }

    /// Distance from zero; `None` on integer overflow.
    #[must_use]
    pub fn magnitude(self) -> Option<Self> {
        match self {
            Self::Integer(v) => v.checked_abs().map(Self::Integer),
            Self::Real(v) => Some(Self::Real(v.abs())),
        }
    }
}

impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for Number {
    /// By value. An integer and a double compare exactly, without rounding the integer first.
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match (*self, *other) {
            (Self::Integer(a), Self::Integer(b)) => Some(a.cmp(&b)),
            (Self::Real(a), Self::Real(b)) => a.partial_cmp(&b),
            (Self::Integer(a), Self::Real(b)) => compare_mixed(a, b),
            (Self::Real(a), Self::Integer(b)) => compare_mixed(b, a).map(Ordering::reverse),
        }
    }
}

fn compare_mixed(integer: i128, real: f64) -> Option<Ordering> {
    if real.is_nan() {
        return None;
    }
    // The cast saturates, which keeps the order for everything outside i128.
    #[allow(clippy::cast_possible_truncation)]
    let whole = real.floor() as i128;
    Some(integer.cmp(&whole).then(if real.fract() == 0.0 {
        Ordering::Equal
    } else {
        Ordering::Less
    }))
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(v) => v.fmt(f),
            Self::Real(v) => v.fmt(f),
        }
    }
}

/// A text is not a number.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a decimal number is expected, but the text is something else")]
pub struct InvalidNumber;

impl FromStr for Number {
    type Err = InvalidNumber;

    /// Digits with an optional sign are an integer; anything else that `f64` reads and that is
    /// finite is a double.
    fn from_str(text: &str) -> Result<Self, InvalidNumber> {
        if let Ok(integer) = text.parse::<i128>() {
            return Ok(Self::Integer(integer));
        }
        match text.parse::<f64>() {
            Ok(real) if real.is_finite() => Ok(Self::Real(real)),
            _ => Err(InvalidNumber),
        }
    }
}

impl From<i64> for Number {
    fn from(value: i64) -> Self {
        Self::Integer(value.into())
    }
}

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        Self::Real(value)
    }
}

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Integer(v) => match (i64::try_from(v), u64::try_from(v)) {
                (Ok(v), _) => serializer.serialize_i64(v),
                (_, Ok(v)) => serializer.serialize_u64(v),
                _ => serializer.serialize_str(&v.to_string()),
            },
            Self::Real(v) => serializer.serialize_f64(v),
        }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl de::Visitor<'_> for Visitor {
            type Value = Number;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or an integer as text")
            }
            fn visit_i64<E: de::Error>(self, v: i64) -> Result<Number, E> {
                Ok(Number::Integer(v.into()))
            }
            fn visit_u64<E: de::Error>(self, v: u64) -> Result<Number, E> {
                Ok(Number::Integer(v.into()))
            }
            fn visit_f64<E: de::Error>(self, v: f64) -> Result<Number, E> {
                Ok(Number::Real(v))
            }
            fn visit_str<E: de::Error>(self, v: &str) -> Result<Number, E> {
                v.parse().map_err(|_| E::invalid_value(de::Unexpected::Str(v), &self))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

impl JsonSchema for Number {
    fn schema_name() -> Cow<'static, str> {
        "Number".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "description": "A number; integers beyond 2^53 as text.", "type": ["number", "string"] })
    }
}

impl utoipa::PartialSchema for Number {
    fn schema() -> RefOr<utoipa::openapi::Schema> {
        ObjectBuilder::new()
            .schema_type(SchemaType::from_iter([
                utoipa::openapi::Type::Number,
                utoipa::openapi::Type::String,
            ]))
            .description(Some("A number; integers beyond 2^53 as text."))
            .into()
    }
}

impl utoipa::ToSchema for Number {
    fn name() -> Cow<'static, str> {
        "Number".into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn integers_stay_exact() {
        let big = Number::Integer(i128::from(u64::MAX));
        assert_eq!(big.minus(Number::ONE), Some(Number::Integer(18_446_744_073_709_551_614)));
        assert_eq!(big.to_scalar(), Scalar::UInt64(u64::MAX));
        assert!(big < Number::Real(18_446_744_073_709_551_616.0));
        assert_eq!(Number::Integer(7).divided_by(Number::Integer(2)), Some(Number::Real(3.5)));
        assert_eq!(
            Number::Integer(8).divided_by(Number::Integer(2)).map(|n| n.to_string()),
            Some("4".into())
        );
        assert_eq!(Number::ONE.divided_by(Number::Real(0.0)), None);
        assert_eq!(Number::Integer(i128::MAX).plus(Number::ONE), None);
    }

    #[test]
    fn json_round_trips() {
        for (json, back) in [
            ("18446744073709551615", "18446744073709551615"),
            ("-3", "-3"),
            ("0.1", "0.1"),
            ("\"18446744073709551616\"", "\"18446744073709551616\""),
        ] {
            let number: Number = serde_json::from_str(json).expect("valid");
            assert_eq!(serde_json::to_string(&number).expect("serialisable"), back);
        }
        assert!(serde_json::from_str::<Number>("\"abc\"").is_err());
        assert!(serde_json::from_str::<Number>("true").is_err());
    }

    proptest! {
        #[test]
        fn mixed_order_is_the_order_of_the_exact_values(a in -1_000_000_i128..1_000_000, b in -1.0e6_f64..1.0e6) {
            let exact = (a as f64).partial_cmp(&b);
            prop_assert_eq!(Number::Integer(a).partial_cmp(&Number::Real(b)), exact);
            prop_assert_eq!(Number::Real(b).partial_cmp(&Number::Integer(a)), exact.map(Ordering::reverse));
        }
    }
}
