//! Values to scripts and back.

use std::sync::Arc;

use asi_model::{
    BuiltInType, DataValue, DateTime, Scalar, StatusCode, Variant,
    values::{Array, ExtensionBody},
};
use mapping::{Fault, FaultKind, convert};
use script_protocol::{ScriptValue, Spoken, Yielded};

/// Deepest structure that a script sees; deeper members are `null`.
const DEPTH_MAX: usize = 12;

/// A value with status and time as a script sees it.
pub(crate) fn spoken(value: &DataValue) -> Spoken {
    Spoken {
        value: to_script(&value.value, 0),
        status: value.status.0,
        source_time_ms: value.source_timestamp.map(millis),
    }
}

/// Milliseconds since 1970 with as much of the fraction as a double keeps.
#[allow(clippy::cast_precision_loss)]
fn millis(time: DateTime) -> f64 {
    let micros = time.unix_micros();
    micros.div_euclid(1000) as f64 + micros.rem_euclid(1000) as f64 / 1000.0
}

fn to_script(value: &Variant, depth: usize) -> ScriptValue {
    match value {
        Variant::Null => ScriptValue::Null,
        Variant::Scalar(scalar) => scalar_to_script(scalar, depth),
        Variant::Array(array) if depth < DEPTH_MAX => ScriptValue::List(
            array.elements.iter().map(|element| scalar_to_script(element, depth + 1)).collect(),
        ),
        Variant::Array(_) => ScriptValue::Null,
    }
}

fn scalar_to_script(scalar: &Scalar, depth: usize) -> ScriptValue {
    match scalar {
        Scalar::Boolean(v) => ScriptValue::Boolean(*v),
        Scalar::Int64(v) => ScriptValue::Signed(*v),
        Scalar::UInt64(v) => ScriptValue::Unsigned(*v),
        Scalar::DateTime(v) => ScriptValue::Time(millis(*v)),
        Scalar::StatusCode(v) => ScriptValue::Number(v.0.into()),
        Scalar::String(text) | Scalar::XmlElement(text) => {
            text.as_ref().map_or(ScriptValue::Null, |text| ScriptValue::Text(Arc::clone(text)))
        }
        Scalar::ByteString(bytes) => {
            bytes.as_ref().map_or(ScriptValue::Null, |bytes| ScriptValue::Bytes(Arc::clone(bytes)))
        }
        Scalar::Variant(inner) if depth < DEPTH_MAX => to_script(inner, depth + 1),
        Scalar::DataValue(inner) if depth < DEPTH_MAX => to_script(&inner.value, depth + 1),
        Scalar::ExtensionObject(object) if depth < DEPTH_MAX => match &object.body {
            ExtensionBody::Structure(structure) => {
                let members = structure.fields.iter();
                let members =
                    members.map(|(name, value)| (Arc::clone(name), to_script(value, depth + 1)));
                ScriptValue::Record(members.collect())
            }
            _ => ScriptValue::Null,
        },
        other => match other.as_f64() {
            Some(number) => ScriptValue::Number(number),
            None => convert::to_text(other)
                .map_or(ScriptValue::Null, |text| ScriptValue::Text(text.into())),
        },
    }
}

/// Returns value and status of a script's result; `None` where it returned `undefined`.
///
/// # Errors
/// As [`from_script`].
pub(crate) fn yielded(yielded: Yielded) -> Result<Option<(Variant, StatusCode)>, Fault> {
    match yielded {
        Yielded::Nothing => Ok(None),
        Yielded::Value { value, status } => Ok(Some((from_script(value)?, StatusCode(status)))),
    }
}

/// Returns a script's value as a built-in type.
///
/// # Errors
/// A [`Fault`] for what OPC UA has no built-in type for: objects, and arrays of mixed kinds.
pub(crate) fn from_script(value: ScriptValue) -> Result<Variant, Fault> {
    let ScriptValue::List(list) = value else {
        return scalar_from_script(value).map(|s| s.map_or(Variant::Null, Into::into));
    };
    let wrong = || {
        wrong("an array must have elements of one kind: numbers, BigInts, texts, Booleans or Dates")
    };
    let mut elements = Vec::with_capacity(list.len());
    for element in list {
        elements.push(scalar_from_script(element)?.ok_or_else(wrong)?);
    }
    let element_type = match elements.first().map(Scalar::built_in_type) {
        None => BuiltInType::Double,
        // BigInts below and above 2^63 mix.
        Some(BuiltInType::Int64 | BuiltInType::UInt64)
            if elements.iter().any(|element| matches!(element, Scalar::UInt64(_))) =>
        {
            for element in &mut elements {
                *element =
                    convert::convert_exactly(element, BuiltInType::UInt64).ok_or_else(wrong)?;
            }
            BuiltInType::UInt64
        }
        Some(first) => first,
    };
    if elements.iter().any(|element| element.built_in_type() != element_type) {
        return Err(wrong());
    }
    Ok(Variant::Array(Array { element_type, elements, dimensions: None }.into()))
}

fn wrong(message: &'static str) -> Fault {
    Fault::new(FaultKind::ScriptResult, StatusCode::BAD_TYPE_MISMATCH, message)
}

fn scalar_from_script(value: ScriptValue) -> Result<Option<Scalar>, Fault> {
    Ok(Some(match value {
        ScriptValue::Null => return Ok(None),
        ScriptValue::Boolean(v) => Scalar::Boolean(v),
        ScriptValue::Number(v) => Scalar::Double(v),
        ScriptValue::Signed(v) => Scalar::Int64(v),
        ScriptValue::Unsigned(v) => Scalar::UInt64(v),
        ScriptValue::Text(v) => Scalar::String(Some(v)),
        #[allow(clippy::cast_possible_truncation)]
        ScriptValue::Time(v) => {
            Scalar::DateTime(DateTime::from_unix_micros((v * 1000.0).round() as i64))
        }
        ScriptValue::Bytes(v) => Scalar::ByteString(Some(v)),
        ScriptValue::List(_) => return Err(wrong("an array must not contain arrays")),
        ScriptValue::Record(_) => {
            return Err(wrong(
                "an object is not a value: return a number, text, Boolean, BigInt, Date or array",
            ));
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn arrays_of_one_kind_return() {
        let list = |values: Vec<ScriptValue>| from_script(ScriptValue::List(values));
        let mixed =
            list(vec![ScriptValue::Signed(1), ScriptValue::Unsigned(u64::MAX)]).expect("one kind");
        assert_eq!(mixed.built_in_type(), Some(BuiltInType::UInt64));
        assert!(list(vec![ScriptValue::Signed(-1), ScriptValue::Unsigned(u64::MAX)]).is_err());
        assert!(list(vec![ScriptValue::Number(1.0), ScriptValue::Text("x".into())]).is_err());
        assert!(list(vec![ScriptValue::Null]).is_err());
        assert!(from_script(ScriptValue::Record(vec![])).is_err());
    }

    proptest! {
        #[test]
        fn sixty_four_bits_survive(signed in any::<i64>(), unsigned in any::<u64>()) {
            for value in [Variant::from(signed), Variant::from(unsigned)] {
                prop_assert_eq!(from_script(to_script(&value, 0)), Ok(value));
            }
        }
    }
}
