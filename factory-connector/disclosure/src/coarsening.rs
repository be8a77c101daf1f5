//! Coarsening of one value: rounding, banding, significant digits, status codes and time steps.

use std::sync::Arc;

use asi_model::{BuiltInType, DataValue, Scalar, StatusCode, Variant, values::Array};

use super::{Decimal, DisclosurePolicy, RoundingStep, decimal::divide_to_nearest};

/// A coarsened candidate; `is_coarsened` when it differs from the candidate.
pub(super) struct Coarsened {
    pub(super) value: DataValue,
    pub(super) is_coarsened: bool,
}

/// Coarsens a candidate for a field of a type. A value of another type than the field's is never
/// released: a rounding step may not apply to its digits. A Bad value has only its status, in the
/// resolution of the policy.
pub(super) fn coarsen(
    policy: &DisclosurePolicy,
    field_type: BuiltInType,
    candidate: DataValue,
) -> Coarsened {
    let (value, status) = if candidate.status.is_bad() {
        (Variant::Null, candidate.status)
    } else if candidate.value.built_in_type().is_some_and(|found| found != field_type) {
        (Variant::Null, StatusCode::BAD_TYPE_MISMATCH)
    } else {
        (coarsen_variant(policy, &candidate.value), candidate.status)
    };
    let status = policy.status_codes.coarsen(status);
    let source_timestamp = candidate.source_timestamp.map(|time| time.floor_to(policy.time_step()));
    let is_coarsened = value != candidate.value
        || status != candidate.status
        || source_timestamp != candidate.source_timestamp;
    // Only the source's time is released. A server's time or a finer clock would reveal more.
    let value = DataValue { value, status, source_timestamp, ..DataValue::default() };
    Coarsened { value, is_coarsened }
}

fn coarsen_variant(policy: &DisclosurePolicy, value: &Variant) -> Variant {
    match value {
        Variant::Null => Variant::Null,
        Variant::Scalar(scalar) => Variant::Scalar(coarsen_scalar(policy, scalar)),
        Variant::Array(array) => Variant::Array(Arc::new(Array {
            element_type: array.element_type,
            elements: array
                .elements
                .iter()
                .map(|element| coarsen_scalar(policy, element))
                .collect(),
            dimensions: array.dimensions.clone(),
        })),
    }
}

fn coarsen_scalar(policy: &DisclosurePolicy, scalar: &Scalar) -> Scalar {
    match scalar {
        Scalar::DateTime(time) => Scalar::DateTime(time.floor_to(policy.time_step())),
        scalar if !scalar.built_in_type().is_numeric() => scalar.clone(),
        // The maker of a value chooses the bits of "not a number".
        Scalar::Double(value) if value.is_nan() => Scalar::Double(f64::NAN),
        Scalar::Float(value) if value.is_nan() => Scalar::Float(f32::NAN),
        scalar => {
            let coarse = if policy.bands.is_empty() {
                policy.rounding_step.map_or_else(|| scalar.clone(), |step| round(scalar, step))
            } else {
                band(scalar, &policy.bands)
            };
            // The digits are cut last: equal values stay equal.
            policy
                .significant_digits
                .map_or_else(|| coarse.clone(), |digits| cut_digits(&coarse, digits))
        }
    }
}

fn cut_digits(scalar: &Scalar, digits: u8) -> Scalar {
    match *scalar {
        Scalar::Double(value) => Scalar::Double(
            Decimal::from_f64(value).map_or(value, |decimal| decimal.with_digits(digits).to_f64()),
        ),
        Scalar::Float(value) => Scalar::Float(
            Decimal::from_f32(value).map_or(value, |decimal| decimal.with_digits(digits).to_f32()),
        ),
        _ => {
            let target = scalar.built_in_type();
            let exact = Decimal::new(scalar.as_i128().unwrap_or(0), 0);
            // Beyond the type's limits the next such number towards zero.
            [exact.with_digits(digits), exact.truncated_to(digits)]
                .into_iter()
                .find_map(|decimal| Scalar::from_i128(decimal.to_integer()?, target))
                .or_else(|| Scalar::from_i128(0, target))
                .expect("zero fits every integer type")
        }
    }
}

fn round(scalar: &Scalar, step: RoundingStep) -> Scalar {
    match *scalar {
        Scalar::Double(value) => Scalar::Double(
            Decimal::from_f64(value).map_or(value, |decimal| decimal.round_to(step).to_f64()),
        ),
        Scalar::Float(value) => Scalar::Float(
            Decimal::from_f32(value).map_or(value, |decimal| decimal.round_to(step).to_f32()),
        ),
        _ => match (scalar.as_i128(), step.to_integer()) {
            (Some(value), Some(step)) => round_integer(value, step, scalar.built_in_type()),
            // A policy with such a step is refused for integer fields; if one ever came here,
            // nothing may pass.
            _ => Scalar::from_i128(0, scalar.built_in_type()).unwrap_or_else(|| scalar.clone()),
        },
    }
}

/// The nearest multiple of the step that the type can hold: beyond its limits the next one towards
/// zero.
fn round_integer(value: i128, step: i128, target: BuiltInType) -> Scalar {
    let count = divide_to_nearest(value, step);
    let towards_zero = count - count.signum();
    Scalar::from_i128(count * step, target)
        .or_else(|| Scalar::from_i128(towards_zero * step, target))
        .or_else(|| Scalar::from_i128(0, target))
        .expect("zero fits every integer type")
}

#[allow(clippy::cast_possible_truncation)]
fn band(scalar: &Scalar, bounds: &[f64]) -> Scalar {
    let lowest = bounds.first().copied().unwrap_or(0.0);
    let below =
        |value: f64| bounds.iter().rev().find(|bound| **bound <= value).copied().unwrap_or(lowest);
    match *scalar {
        Scalar::Double(value) => Scalar::Double(below(value)),
        Scalar::Float(value) => Scalar::Float(below(value.into()) as f32),
        _ => {
            // Bounds of integer fields are whole numbers within 2^53, so that both conversions are
            // exact.
            let value = scalar.as_i128().unwrap_or(0);
            let bound =
                bounds.iter().rev().map(|bound| *bound as i128).find(|bound| *bound <= value);
            let bound = bound.unwrap_or(lowest as i128);
            let target = scalar.built_in_type();
            Scalar::from_i128(bound, target)
                .or_else(|| Scalar::from_i128(0, target))
                .expect("zero fits every integer type")
        }
    }
}

#[cfg(test)]
mod tests {
    use asi_model::DateTime;

    use super::*;

    fn check(policy: &str, value: impl Into<Variant>, expected: impl Into<Variant>) {
        let policy: DisclosurePolicy = serde_json::from_str(policy).expect("a policy");
        let value = value.into();
        let field_type = value.built_in_type().expect("a value");
        let coarse = coarsen(&policy, field_type, DataValue::good(value.clone(), DateTime::MIN));
        let expected = expected.into();
        assert_eq!(coarse.value.value, expected);
        assert_eq!(coarse.is_coarsened, value != expected);
    }

    #[test]
    fn values_are_coarsened_in_their_own_type() {
        check(r#"{"roundingStep":10}"#, 17_u64, 20_u64);
        check(r#"{"roundingStep":10}"#, 255_u8, 250_u8);
        check(r#"{"roundingStep":10}"#, -128_i8, -120_i8);
        check(r#"{"roundingStep":1000}"#, 200_u8, 0_u8);
        check(r#"{"roundingStep":2}"#, u64::MAX, u64::MAX - 1);
        check(r#"{"roundingStep":0.1}"#, 21.37_f64, 21.4_f64);
        check(r#"{"roundingStep":0.1}"#, 21.37_f32, 21.4_f32);
        check(r#"{"bands":[0,50,80]}"#, 79.9_f64, 50.0_f64);
        check(r#"{"bands":[0,50,80]}"#, -3_i32, 0_i32);
        check(r#"{"roundingStep":10}"#, "text", "text");
        check(r#"{"significantDigits":2}"#, 12_345_u64, 12_000_u64);
        check(r#"{"significantDigits":1}"#, 255_u8, 200_u8);
        check(r#"{"significantDigits":2}"#, -99.7_f64, -100.0_f64);
        check(r#"{"significantDigits":3}"#, 0.001_234_5_f64, 0.001_23_f64);
        check(r#"{"roundingStep":25,"significantDigits":1}"#, 70_i32, 80_i32);
        let time: DateTime = "2026-11-21T10:17:31Z".parse().expect("a time");
        let floor: DateTime = "2026-11-21T10:15:00Z".parse().expect("a time");
        check(r#"{"timeStepMs":900000}"#, time, floor);
    }

    #[test]
    fn a_value_of_another_type_is_never_released() {
        let coarse = coarsen(
            &DisclosurePolicy::default(),
            BuiltInType::Int32,
            DataValue::good("3.14", DateTime::MIN),
        );
        assert_eq!(
            (coarse.value.value, coarse.value.status),
            (Variant::Null, StatusCode::BAD_TYPE_MISMATCH)
        );
    }
}
