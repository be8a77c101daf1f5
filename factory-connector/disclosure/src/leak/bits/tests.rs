//! Bounds compared with what a gate lets out: every value of a small type, under every status.

use std::{collections::BTreeSet, sync::Arc};

use asi_model::{
    BuiltInType, DataValue, DateTime, Scalar, StatusCode, Variant, network::ReportField,
};
use serde_json::{Value, json};

use super::{bits_per_value, number_of_values, source_time_bits};
use crate::{DisclosurePolicy, Gate, GateState, status_codes::COMMON};

fn field(field_type: BuiltInType) -> ReportField {
    let field = json!({ "name": "x", "type": field_type.id(), "valueRank": -1 });
    serde_json::from_value(field).expect("a field")
}

/// Returns every value and status that a gate releases of these candidates, each by itself.
fn released(
    policy: &DisclosurePolicy,
    field_type: BuiltInType,
    candidates: impl Iterator<Item = (Variant, StatusCode)>,
) -> BTreeSet<String> {
    let policy = Arc::new(policy.clone());
    let now = DateTime::from_unix_micros(1_800_000_000_000_000);
    candidates
        .filter_map(|(value, status)| {
            let state = GateState::default();
            let mut gate = Gate::new(Arc::clone(&policy), field_type, state, now);
            gate.on(now, DataValue { value, status, ..DataValue::default() });
            let shown = gate.disclosed()?;
            Some(format!("{:?} {:?}", shown.value, shown.status))
        })
        .collect()
}

/// Codes of each severity, those of the small set, and others with bits of all kinds.
fn statuses() -> Vec<StatusCode> {
    let causes = [0x0096_0000, 0x00A2_0483, 0x4094_0000, 0x408F_0C00, 0x808C_0000, 0x8089_FFFF];
    let others = (0..16_u32).map(|code| code.wrapping_mul(0x9E37_79B9));
    COMMON.iter().copied().chain(causes.into_iter().chain(others).map(StatusCode)).collect()
}

/// Policies that coarsen numbers in each way, each with the three resolutions of status codes one after another.
fn policies(is_integer: bool) -> Vec<DisclosurePolicy> {
    let parts = [
        json!({}),
        json!({ "roundingStep": 2 }),
        json!({ "roundingStep": 7 }),
        json!({ "roundingStep": 100 }),
        json!({ "bands": [0] }),
        json!({ "bands": [-100, -3, 0, 17, 90] }),
        json!({ "significantDigits": 1 }),
        json!({ "significantDigits": 2 }),
        json!({ "roundingStep": 25, "significantDigits": 1 }),
    ];
    let finer = json!({ "roundingStep": 0.25, "significantDigits": 1 });
    let parts = parts.into_iter().chain((!is_integer).then_some(finer));
    let with_codes = |part: Value| {
        ["FULL", "COMMON", "SEVERITY"].map(|codes| {
            let mut policy = part.clone();
            policy["statusCodes"] = codes.into();
            serde_json::from_value(policy).expect("a policy")
        })
    };
    parts.flat_map(with_codes).collect()
}

/// Compares the number of different things that leave with the bound.
fn is_within(policy: &DisclosurePolicy, field_type: BuiltInType, count: usize) {
    let field = field(field_type);
    let bound = bits_per_value(&field, policy).expect("a bound") - source_time_bits(policy);
    let bits = f64::from(u32::try_from(count).expect("few")).log2();
    let name = field_type.name();
    assert!(bits <= bound + 1e-9, "{name}: {bits} bits leave, at most {bound}, by {policy:?}");
}

#[test]
fn no_value_of_a_small_type_tells_more_than_its_bound() {
    let statuses = statuses();
    for field_type in [BuiltInType::Boolean, BuiltInType::Byte, BuiltInType::SByte] {
        let values: Vec<Variant> = match field_type {
            BuiltInType::Boolean => vec![Variant::from(false), Variant::from(true)],
            _ => (-128..256)
                .filter_map(|whole| Scalar::from_i128(whole, field_type))
                .map(Variant::Scalar)
                .collect(),
        };
        // A value of another type and none at all are symbols, too.
        let others = [Variant::Null, Variant::from("another type")];
        for policy in policies(true) {
            let policy = policy.fitted_to(field_type, false);
            let values = values.iter().chain(&others);
            let candidates = values
                .flat_map(|value| statuses.iter().map(move |status| (value.clone(), *status)));
            let seen = released(&policy, field_type, candidates);
            assert!(seen.len() > 2, "something leaves by {policy:?}");
            is_within(&policy, field_type, seen.len());
        }
    }
}

#[test]
fn no_value_of_sixteen_bits_tells_more_than_its_bound() {
    for field_type in [BuiltInType::Int16, BuiltInType::UInt16] {
        let values = || {
            let wholes = -32_768..65_536_i128;
            wholes.filter_map(|whole| Scalar::from_i128(whole, field_type)).map(Variant::Scalar)
        };
        for policy in policies(true).iter().step_by(3) {
            let policy = policy.fitted_to(field_type, false);
            let good = values().map(|value| (value, StatusCode::GOOD));
            let seen = released(&policy, field_type, good).len();
            let bound = number_of_values(&field(field_type), &policy).expect("a bound");
            let seen = f64::from(u32::try_from(seen).expect("few"));
            assert!(seen <= bound, "{}: {seen} values, {bound}, {policy:?}", field_type.name());
        }
    }
}

/// Every first digits of every decade, with zeros, infinities, "not a number" and its bits.
#[test]
fn no_floating_point_number_tells_more_than_its_bound() {
    for field_type in [BuiltInType::Double, BuiltInType::Float] {
        let mut numbers = vec![0.0, -0.0, f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
        numbers.extend([f64::MIN_POSITIVE, 5e-324, f64::MAX, f64::MIN, f64::from(f32::MAX)]);
        numbers.push(f64::from_bits(f64::NAN.to_bits() | 17));
        for exponent in -324..309 {
            let texts = (10..100).map(|digits| format!("{}e{}", digits, exponent - 1));
            let parsed = texts.filter_map(|text| text.parse::<f64>().ok());
            numbers.extend(parsed.flat_map(|number| [number, -number]));
        }
        #[allow(clippy::cast_possible_truncation)]
        let variant = |number: f64| match field_type {
            BuiltInType::Double => Variant::from(number),
            _ => Variant::from(number as f32),
        };
        for policy in policies(false).iter().step_by(3) {
            let bounded = !policy.bands.is_empty() || policy.significant_digits.is_some();
            if !bounded {
                continue;
            }
            let good = numbers.iter().map(|number| (variant(*number), StatusCode::GOOD));
            let seen = released(policy, field_type, good).len();
            let bound = number_of_values(&field(field_type), policy).expect("a bound");
            let seen = f64::from(u32::try_from(seen).expect("few"));
            assert!(seen <= bound, "{}: {seen} values, {bound}, {policy:?}", field_type.name());
        }
    }
}
