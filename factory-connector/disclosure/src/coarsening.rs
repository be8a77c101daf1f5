//! Coarsening of one value: rounding, banding, significant digits, status codes and time steps. A policy
//! holds within values that hold others, too - variants, values with a status and structures: a request for such
//! a type would otherwise be a way around it.

use std::sync::Arc;

use asi_model::{
    BuiltInType, DataValue, Scalar, StatusCode, Variant,
    values::{Array, DiagnosticInfo, ExtensionBody, ExtensionObject, StructureValue},
};

use super::{Decimal, DisclosurePolicy, RoundingStep, StatusCodes, decimal::divide_to_nearest};

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
        Scalar::StatusCode(status) => Scalar::StatusCode(policy.status_codes.coarsen(*status)),
        scalar if !scalar.built_in_type().is_numeric() => {
            coarsen_holding(policy, scalar).unwrap_or_else(|| scalar.clone())
        }
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

/// Types whose values are texts, bytes or ids: who makes them chooses all that they say.
const TEXTS: [BuiltInType; 8] = [
    BuiltInType::String,
    BuiltInType::ByteString,
    BuiltInType::XmlElement,
    BuiltInType::Guid,
    BuiltInType::NodeId,
    BuiltInType::ExpandedNodeId,
    BuiltInType::QualifiedName,
    BuiltInType::LocalizedText,
];

/// Types whose values hold values of other types.
const HOLDING: [BuiltInType; 4] = [
    BuiltInType::ExtensionObject,
    BuiltInType::DataValue,
    BuiltInType::Variant,
    BuiltInType::DiagnosticInfo,
];

/// Returns true where a field of this type can have parts of a policy that are about numbers: it is a number, or
/// its values hold some.
pub(super) fn holds_numbers(field_type: BuiltInType) -> bool {
    field_type.is_numeric() || HOLDING.contains(&field_type)
}

/// Returns true where a policy lets through only a part of a value, and not just fewer values.
fn coarsens_values(policy: &DisclosurePolicy) -> bool {
    policy.rounding_step.is_some()
        || !policy.bands.is_empty()
        || policy.significant_digits.is_some()
        || !policy.time_step().is_zero()
}

/// Coarsens what a value of a holding type holds; none for a value that holds nothing.
fn coarsen_holding(policy: &DisclosurePolicy, scalar: &Scalar) -> Option<Scalar> {
    Some(match scalar {
        Scalar::Variant(value) => Scalar::Variant(Box::new(coarsen_held(policy, value))),
        Scalar::DataValue(value) => Scalar::DataValue(Box::new(coarsen_data_value(policy, value))),
        Scalar::ExtensionObject(object) => Scalar::ExtensionObject(Box::new(ExtensionObject {
            type_id: object.type_id.clone(),
            body: coarsen_body(policy, &object.body),
        })),
        Scalar::DiagnosticInfo(info) => {
            Scalar::DiagnosticInfo(Box::new(coarsen_diagnostics(policy, info)))
        }
        _ => return None,
    })
}

/// Coarsens a held value. Its type is known only now: steps and bounds are adapted to it. A text can
/// say what a number or a time beside it must not, and is left out by a policy that coarsens.
fn coarsen_held(policy: &DisclosurePolicy, value: &Variant) -> Variant {
    match value.built_in_type() {
        Some(held) if TEXTS.contains(&held) && coarsens_values(policy) => Variant::Null,
        Some(held) if held.is_integer() => coarsen_variant(&policy.fitted_to(held, false), value),
        _ => coarsen_variant(policy, value),
    }
}

fn coarsen_data_value(policy: &DisclosurePolicy, value: &DataValue) -> DataValue {
    let is_bad = value.status.is_bad();
    DataValue {
        value: if is_bad { Variant::Null } else { coarsen_held(policy, &value.value) },
        status: policy.status_codes.coarsen(value.status),
        source_timestamp: value.source_timestamp.map(|time| time.floor_to(policy.time_step())),
        // As beside the value of a report: a server's time and a finer clock would reveal more.
        ..DataValue::default()
    }
}

/// Coarsens the content of a structure. What has no description cannot be coarsened, and is left out by a policy
/// that coarsens.
fn coarsen_body(policy: &DisclosurePolicy, body: &ExtensionBody) -> ExtensionBody {
    match body {
        ExtensionBody::Structure(structure) => {
            let fields = structure.fields.iter();
            let fields =
                fields.map(|(name, value)| (Arc::clone(name), coarsen_held(policy, value)));
            ExtensionBody::Structure(StructureValue { fields: fields.collect(), ..*structure })
        }
        ExtensionBody::Json(_) | ExtensionBody::Binary(_) | ExtensionBody::Xml(_)
            if coarsens_values(policy) =>
        {
            ExtensionBody::None
        }
        other => other.clone(),
    }
}

/// Coarsens diagnostics. Only their status codes are of a known kind: a policy that coarsens leaves out the rest.
fn coarsen_diagnostics(policy: &DisclosurePolicy, info: &DiagnosticInfo) -> DiagnosticInfo {
    let rest = if coarsens_values(policy) || policy.status_codes != StatusCodes::Full {
        DiagnosticInfo::default()
    } else {
        info.clone()
    };
    DiagnosticInfo {
        inner_status_code: info.inner_status_code.map(|code| policy.status_codes.coarsen(code)),
        inner_diagnostic_info: info
            .inner_diagnostic_info
            .as_ref()
            .map(|inner| Box::new(coarsen_diagnostics(policy, inner))),
        ..rest
    }
}

#[cfg(test)]
mod tests {
    use asi_model::{DateTime, NodeId};

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

    fn policy() -> DisclosurePolicy {
        serde_json::from_str(r#"{"roundingStep":2.5,"timeStepMs":60000}"#).expect("a policy")
    }

    fn time(text: &str) -> DateTime {
        text.parse().expect("a time")
    }

    fn structure(number: f64, count: i32, at: DateTime, value: DataValue) -> Scalar {
        let fields = [
            ("speed", Variant::from(number)),
            ("count", Variant::from(count)),
            ("at", Variant::Scalar(Scalar::DateTime(at))),
            ("value", Variant::Scalar(Scalar::DataValue(Box::new(value)))),
        ];
        let fields = fields.into_iter().map(|(name, value)| (Arc::from(name), value)).collect();
        let body = ExtensionBody::Structure(StructureValue { fields, ..Default::default() });
        Scalar::ExtensionObject(Box::new(ExtensionObject {
            type_id: NodeId::numeric("urn:machine", 3_000).into(),
            body,
        }))
    }

    #[test]
    fn a_policy_holds_at_any_depth() {
        let fine = DataValue {
            status: StatusCode(0x0096_0000),
            server_timestamp: Some(time("2026-11-25T06:10:11.123Z")),
            source_picoseconds: 17,
            ..DataValue::good(8.1_f64, time("2026-11-25T06:10:11.123Z"))
        };
        let coarse = DataValue::good(7.5_f64, time("2026-11-25T06:10:00Z"));
        let at = time("2026-11-25T06:10:59Z");
        let held = Scalar::Variant(Box::new(Variant::Scalar(structure(6.3, 7, at, fine))));
        let at = time("2026-11-25T06:10:00Z");
        let expected = Scalar::Variant(Box::new(Variant::Scalar(structure(7.5, 6, at, coarse))));
        assert_eq!(coarsen_scalar(&policy(), &held), expected);
    }

    #[test]
    fn a_bad_value_within_another_has_its_status_only() {
        let bad = DataValue {
            status: StatusCode::BAD_SENSOR_FAILURE,
            ..DataValue::good(8.1_f64, time("2026-11-25T06:10:00Z"))
        };
        let shown = coarsen_data_value(&DisclosurePolicy::default(), &bad);
        assert_eq!((shown.value, shown.status), (Variant::Null, StatusCode::BAD));
    }

    #[test]
    fn what_has_no_description_passes_only_policies_that_coarsen_nothing() {
        let opaque = ExtensionBody::Json(r#"{"at":"2026-11-25T06:10:11.123Z"}"#.into());
        assert_eq!(coarsen_body(&policy(), &opaque), ExtensionBody::None);
        assert_eq!(coarsen_body(&DisclosurePolicy::default(), &opaque), opaque);
    }

    #[test]
    fn held_texts_and_codes_reveal_no_more_than_numbers_may() {
        let held = |value: Variant| Scalar::Variant(Box::new(value));
        let text = held(Variant::from("17.34"));
        assert_eq!(coarsen_scalar(&policy(), &text), held(Variant::Null));
        let as_it_is = DisclosurePolicy::default();
        assert_eq!(coarsen_scalar(&as_it_is, &text), text);
        let code = |code: u32| Scalar::StatusCode(StatusCode(code));
        assert_eq!(coarsen_scalar(&as_it_is, &code(0x4000_1734)), code(0x4000_0000));
        let code = |inner: u32| held(Variant::Scalar(code(inner)));
        assert_eq!(coarsen_scalar(&as_it_is, &code(0x4000_1734)), code(0x4000_0000));
    }

    #[test]
    fn diagnostics_show_status_codes_only() {
        let info = DiagnosticInfo {
            symbolic_id: Some(17),
            additional_info: Some("17.34".into()),
            inner_status_code: Some(StatusCode(0x8000_1734)),
            ..DiagnosticInfo::default()
        };
        let expected = DiagnosticInfo {
            inner_status_code: Some(StatusCode::BAD),
            ..DiagnosticInfo::default()
        };
        assert_eq!(coarsen_diagnostics(&DisclosurePolicy::default(), &info), expected);
    }
}
