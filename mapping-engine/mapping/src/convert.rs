//! Conversion of one built-in type to another, exactly or with a stated loss.

mod integer;

use std::sync::Arc;

use asi_model::{
    BuiltInType, DateTime, Scalar, StatusCode, Variant,
    values::{Array, LocalizedText, QualifiedName},
};
use base64::Engine as _;

use crate::{fault::Fault, number::Number};
pub use integer::{Overflow, Rounding, range, round, to_integer};

/// Converts a scalar, or every element of an array.
///
/// # Errors
/// [`Fault`] `BadTypeMismatch` where the types have nothing to do with each other,
/// `BadDecodingError` where a text is not a value of the type, `BadOutOfRange` where a number does
/// not fit.
pub fn convert(
    value: &Variant,
    to: BuiltInType,
    rounding: Rounding,
    overflow: Overflow,
) -> Result<Variant, Fault> {
    match value {
        Variant::Null => Ok(Variant::Null),
        Variant::Scalar(scalar) => {
            convert_scalar(scalar, to, rounding, overflow).map(Variant::Scalar)
        }
        Variant::Array(array) => {
            let elements = array
                .elements
                .iter()
                .map(|element| convert_scalar(element, to, rounding, overflow));
            Ok(Variant::Array(Arc::new(Array {
                element_type: to,
                elements: elements.collect::<Result<_, _>>()?,
                dimensions: array.dimensions.clone(),
            })))
        }
    }
}

/// Converts one scalar. As [`convert`].
///
/// # Errors
/// As [`convert`].
pub fn convert_scalar(
    scalar: &Scalar,
    to: BuiltInType,
    rounding: Rounding,
    overflow: Overflow,
) -> Result<Scalar, Fault> {
    use BuiltInType as T;
    if scalar.built_in_type() == to {
        return Ok(scalar.clone());
    }
    let mismatch =
        || Fault::type_mismatch(format!("a {} does not convert to {to}", scalar.built_in_type()));
    match to {
        T::Boolean => to_boolean(scalar).ok_or_else(mismatch)?.map(Scalar::Boolean),
        T::Float | T::Double => {
            to_number(scalar).ok_or_else(mismatch)?.and_then(|n| to_real(n, to, overflow))
        }
        integer if integer.is_integer() => to_number(scalar)
            .ok_or_else(mismatch)?
            .and_then(|n| to_integer(n, to, rounding, overflow)),
        T::String => {
            to_text(scalar).map(|text| Scalar::String(Some(text.into()))).ok_or_else(mismatch)
        }
        T::XmlElement => {
            scalar.as_str().map(|text| Scalar::XmlElement(Some(text.into()))).ok_or_else(mismatch)
        }
        T::LocalizedText => to_text(scalar)
            .map(|text| {
                Scalar::LocalizedText(Box::new(LocalizedText {
                    locale: None,
                    text: Some(text.into()),
                }))
            })
            .ok_or_else(mismatch),
        T::QualifiedName => scalar
            .as_str()
            .map(|text| {
                Scalar::QualifiedName(Box::new(QualifiedName {
                    name: Some(text.into()),
                    ..Default::default()
                }))
            })
            .ok_or_else(mismatch),
        T::DateTime => to_date_time(scalar, overflow).ok_or_else(mismatch)?,
        T::Guid => parse_text(
            scalar,
            to,
            |text| uuid::Uuid::parse_str(text).ok().map(Scalar::Guid),
            mismatch,
        ),
        T::NodeId => parse_text(
            scalar,
            to,
            |text| text.parse().ok().map(|id| Scalar::NodeId(Box::new(id))),
            mismatch,
        ),
        T::ByteString => parse_text(
            scalar,
            to,
            |text| {
                let bytes = base64::engine::general_purpose::STANDARD.decode(text).ok()?;
                Some(Scalar::ByteString(Some(bytes.into())))
            },
            mismatch,
        ),
        T::StatusCode => match to_number(scalar).ok_or_else(mismatch)?? {
            Number::Integer(code) => u32::try_from(code)
                .map(|code| Scalar::StatusCode(StatusCode(code)))
                .map_err(|_| Fault::out_of_range(format!("{code} is not a status code"))),
            Number::Real(_) => Err(mismatch()),
        },
        _ => Err(mismatch()),
    }
}

/// Converts where nothing is lost: numbers that fit, texts that are the value.
#[must_use]
pub fn convert_exactly(scalar: &Scalar, to: BuiltInType) -> Option<Scalar> {
    convert_scalar(scalar, to, Rounding::Exact, Overflow::Fault).ok()
}

/// Returns the value at the end of a chain as one of the target's type. Numbers change between
/// numeric types where the value is exactly one of the wanted type (Double to Float rounds); texts
/// and localized texts change into each other. Everything else takes an explicit function.
///
/// # Errors
/// [`Fault`] with a sentence that names the function to add.
pub fn coerce(value: Variant, to: BuiltInType) -> Result<Variant, Fault> {
    let Some(from) = value.built_in_type() else { return Ok(Variant::Null) };
    if from == to {
        return Ok(value);
    }
    if !coerces(from, to) {
        return Err(Fault::type_mismatch(format!(
            "the chain yields a {from} but the field is a {to}: add a convert"
        )));
    }
    convert(&value, to, Rounding::Exact, Overflow::Fault)
}

/// Returns true where [`coerce`] may succeed between two types.
#[must_use]
pub fn coerces(from: BuiltInType, to: BuiltInType) -> bool {
    use BuiltInType as T;
    from == to
        || (from.is_numeric() && to.is_numeric())
        || matches!((from, to), (T::String, T::LocalizedText) | (T::LocalizedText, T::String))
}

/// Returns true where [`convert`] may succeed between two types.
#[must_use]
pub fn converts(from: BuiltInType, to: BuiltInType) -> bool {
    use BuiltInType as T;
    let simple = |t: T| t.is_numeric() || matches!(t, T::Boolean | T::String | T::DateTime);
    from == to
        || (simple(from)
            && simple(to)
            && !matches!((from, to), (T::Boolean, T::DateTime) | (T::DateTime, T::Boolean)))
        || match to {
            T::String | T::LocalizedText => !matches!(
                from,
                T::ExtensionObject
                    | T::DataValue
                    | T::Variant
                    | T::DiagnosticInfo
                    | T::ExpandedNodeId
            ),
            T::XmlElement | T::QualifiedName | T::Guid | T::NodeId | T::ByteString => {
                from == T::String
            }
            T::StatusCode => from.is_integer(),
            _ => from == T::StatusCode && to.is_integer(),
        }
}

/// The value as text: numbers in digits, times as RFC 3339, bytes in Base64. `None` for structures
/// and null texts.
#[must_use]
pub fn to_text(scalar: &Scalar) -> Option<String> {
    Some(match scalar {
        Scalar::Boolean(v) => v.to_string(),
        Scalar::Float(v) => v.to_string(),
        Scalar::Double(v) => v.to_string(),
        Scalar::String(text) | Scalar::XmlElement(text) => text.as_deref()?.to_owned(),
        Scalar::DateTime(v) => v.to_string(),
        Scalar::Guid(v) => v.hyphenated().to_string(),
        Scalar::ByteString(bytes) => {
            base64::engine::general_purpose::STANDARD.encode(bytes.as_deref()?)
        }
        Scalar::NodeId(v) => v.to_string(),
        Scalar::StatusCode(v) => v.symbol().map_or_else(|| format!("0x{:08X}", v.0), str::to_owned),
        Scalar::QualifiedName(v) => v.name.as_deref()?.to_owned(),
        Scalar::LocalizedText(v) => v.text.as_deref()?.to_owned(),
        other => other.as_i128()?.to_string(),
    })
}

/// Returns the truth of a Boolean, or of a number: not zero is true. `None` for anything else.
#[must_use]
pub fn is_true(scalar: &Scalar) -> Option<bool> {
    match scalar {
        Scalar::Boolean(v) => Some(*v),
        other => Number::of(other).map(|n| !n.is_zero()),
    }
}

/// The outer `None` means that the types have nothing to do with each other.
fn to_boolean(scalar: &Scalar) -> Option<Result<bool, Fault>> {
    if let Some(text) = scalar.as_str() {
        return Some(match text.trim().to_ascii_lowercase().as_str() {
            "true" | "1" => Ok(true),
            "false" | "0" => Ok(false),
            _ => Err(Fault::decoding("the text is neither true nor false".to_owned())),
        });
    }
    is_true(scalar).map(Ok)
}

fn to_number(scalar: &Scalar) -> Option<Result<Number, Fault>> {
    match scalar {
        Scalar::String(Some(text)) => Some(
            text.trim().parse().map_err(|_| Fault::decoding("the text is not a number".to_owned())),
        ),
        Scalar::DateTime(time) => Some(Ok(Number::Integer(time.unix_millis().into()))),
        Scalar::StatusCode(code) => Some(Ok(Number::Integer(code.0.into()))),
        other => Number::of(other).map(Ok),
    }
}

fn to_date_time(scalar: &Scalar, overflow: Overflow) -> Option<Result<Scalar, Fault>> {
    if let Some(text) = scalar.as_str() {
        let time = text
            .trim()
            .parse()
            .map_err(|_| Fault::decoding("the text is not an RFC 3339 time".to_owned()));
        return Some(time.map(Scalar::DateTime));
    }
    let number = match scalar {
        Scalar::Boolean(_) => return None,
        other => Number::of(other)?,
    };
    let whole = to_integer(number, BuiltInType::Int64, Rounding::Nearest, overflow);
    Some(whole.map(|millis| {
        let millis = millis.as_i128().and_then(|v| i64::try_from(v).ok()).unwrap_or_default();
        Scalar::DateTime(DateTime::from_unix_micros(millis.saturating_mul(1000)))
    }))
}

fn parse_text(
    scalar: &Scalar,
    to: BuiltInType,
    parse: impl FnOnce(&str) -> Option<Scalar>,
    mismatch: impl FnOnce() -> Fault,
) -> Result<Scalar, Fault> {
    let text = scalar.as_str().ok_or_else(mismatch)?;
    parse(text.trim()).ok_or_else(|| Fault::decoding(format!("the text is not a {to}")))
}

fn to_real(number: Number, to: BuiltInType, overflow: Overflow) -> Result<Scalar, Fault> {
    let real = number.as_f64();
    if to == BuiltInType::Double {
        return Ok(Scalar::Double(real));
    }
    // Rounding to the nearest Float is what a Float means.
    #[allow(clippy::cast_possible_truncation)]
    let float = real as f32;
    if float.is_finite() || !real.is_finite() {
        return Ok(Scalar::Float(float));
    }
    match overflow {
        Overflow::Clamp => Ok(Scalar::Float(if real > 0.0 { f32::MAX } else { f32::MIN })),
        Overflow::Fault => {
            Err(Fault::out_of_range("the number is beyond the range of Float".to_owned()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use BuiltInType as T;
    use proptest::prelude::*;

    fn check(from: impl Into<Scalar>, to: BuiltInType, expected: Option<Scalar>) {
        let from = from.into();
        let converted = convert_scalar(&from, to, Rounding::Nearest, Overflow::Fault).ok();
        assert_eq!(converted, expected, "{from:?} to {to}");
        assert!(
            expected.is_none() || converts(from.built_in_type(), to),
            "{from:?} to {to} is announced"
        );
    }

    #[test]
    fn conversions() {
        check(3.5, T::Int32, Some(Scalar::Int32(4)));
        check(-3.5, T::Int32, Some(Scalar::Int32(-4)));
        check(u64::MAX, T::Int64, None);
        check(u64::MAX, T::UInt64, Some(Scalar::UInt64(u64::MAX)));
        check(i64::MIN, T::String, Some("-9223372036854775808".into()));
        check("18446744073709551615", T::UInt64, Some(Scalar::UInt64(u64::MAX)));
        check(" 00123 ", T::Int32, Some(Scalar::Int32(123)));
        check("12 pcs", T::Int32, None);
        check("", T::Double, None);
        check("NaN", T::Double, None);
        check("TRUE", T::Boolean, Some(Scalar::Boolean(true)));
        check("yes", T::Boolean, None);
        check(2_i32, T::Boolean, Some(Scalar::Boolean(true)));
        check(true, T::Byte, Some(Scalar::Byte(1)));
        check(f64::NAN, T::Int32, None);
        check(1.0e300, T::Float, None);
        check(0.1_f32, T::String, Some("0.1".into()));
        check(
            "2019-04-18T06:00:00Z",
            T::DateTime,
            Some(Scalar::DateTime(DateTime::from_unix_micros(1_555_567_200_000_000))),
        );
        check(
            1_555_567_200_000_i64,
            T::DateTime,
            Some(Scalar::DateTime(DateTime::from_unix_micros(1_555_567_200_000_000))),
        );
        check(true, T::DateTime, None);
        check(StatusCode::BAD_TIMEOUT, T::UInt32, Some(Scalar::UInt32(0x800A_0000)));
        check("AQID", T::ByteString, Some(Scalar::ByteString(Some(Arc::from([1_u8, 2, 3])))));
    }

    #[test]
    fn overflow_clamps_on_wish() {
        for (value, to, expected) in [
            (300.0, T::Byte, Scalar::Byte(255)),
            (-1.0, T::UInt64, Scalar::UInt64(0)),
            (f64::INFINITY, T::Int64, Scalar::Int64(i64::MAX)),
            (-1e300, T::Float, Scalar::Float(f32::MIN)),
        ] {
            let clamped =
                convert_scalar(&Scalar::Double(value), to, Rounding::Nearest, Overflow::Clamp);
            assert_eq!(clamped.ok(), Some(expected));
        }
    }

    #[test]
    fn the_end_of_the_chain_loses_nothing() {
        assert_eq!(coerce(3.0.into(), T::UInt64).ok(), Some(Variant::from(3_u64)));
        assert!(coerce(3.5.into(), T::UInt64).is_err());
        assert!(coerce((-1_i32).into(), T::UInt64).is_err());
        assert!(coerce("00123".into(), T::Int32).is_err());
        assert_eq!(coerce("00123".into(), T::String).ok(), Some(Variant::from("00123")));
        assert!(coerce(1_i32.into(), T::Boolean).is_err());
    }

    proptest! {
        #[test]
        fn integers_survive_text_and_back(value in any::<i64>()) {
            let text = convert_scalar(&Scalar::Int64(value), T::String, Rounding::Exact, Overflow::Fault).expect("text");
            prop_assert_eq!(convert_exactly(&text, T::Int64), Some(Scalar::Int64(value)));
        }

        #[test]
        fn doubles_survive_text_and_back(value in any::<f64>().prop_filter("finite", |v| v.is_finite())) {
            let text = convert_scalar(&Scalar::Double(value), T::String, Rounding::Exact, Overflow::Fault).expect("text");
            prop_assert_eq!(convert_exactly(&text, T::Double), Some(Scalar::Double(value)));
        }

        #[test]
        fn integer_conversion_is_the_arithmetic_one(value in any::<i64>(), to in 2_u64..=9) {
            let to = BuiltInType::from_id(to).expect("an integer type");
            let (low, high) = range(to);
            let fits = (low..=high).contains(&i128::from(value));
            let converted = convert_scalar(&Scalar::Int64(value), to, Rounding::Exact, Overflow::Fault);
            prop_assert_eq!(converted.ok().and_then(|s| s.as_i128()), fits.then(|| value.into()));
        }

        #[test]
        fn rounding_stays_within_one(value in -1.0e12_f64..1.0e12) {
            for rounding in [Rounding::Nearest, Rounding::HalfEven, Rounding::Down, Rounding::Up, Rounding::TowardZero] {
                let whole = round(value, rounding).expect("finite") as f64;
                let bound = if matches!(rounding, Rounding::Nearest | Rounding::HalfEven) { 0.5 } else { 1.0 };
                prop_assert!((whole - value).abs() <= bound);
            }
        }
    }
}
