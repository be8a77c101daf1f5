use asi_model::{DataValue, DateTime, Scalar};
use proptest::prelude::*;

use super::*;
use crate::coarsening::coarsen;

fn range() -> std::ops::RangeInclusive<i64> {
    -260..=260
}

fn value_policies() -> impl Strategy<Value = DisclosurePolicy> {
    let bands = proptest::collection::btree_set(-20_i32..20, 1..6);
    prop_oneof![
        (proptest::option::of(1_u32..60), proptest::option::of(1_u8..4)).prop_map(
            |(step, significant_digits)| {
                let rounding_step = step.map(|step| f64::from(step).try_into().expect("positive"));
                DisclosurePolicy { rounding_step, significant_digits, ..Default::default() }
            }
        ),
        (bands, proptest::option::of(1_u8..4)).prop_map(|(bands, significant_digits)| {
            let bands = bands.into_iter().map(|bound| f64::from(bound * 10)).collect();
            DisclosurePolicy { bands, significant_digits, ..Default::default() }
        }),
    ]
}

fn aggregates() -> impl Strategy<Value = DisclosurePolicy> {
    use AggregateFunction::{Last, Maximum, Mean, Minimum, Sum};
    let function = proptest::sample::select(vec![Last, Maximum, Minimum, Sum, Mean]);
    proptest::option::of((function, 1_u64..5)).prop_map(|aggregate| {
        let aggregate =
            aggregate.map(|(function, window_ms)| WindowAggregate { function, window_ms });
        DisclosurePolicy { aggregate, ..Default::default() }
    })
}

fn shown(policy: &DisclosurePolicy, value: i64) -> i128 {
    let coarse = coarsen(policy, BuiltInType::Int64, DataValue::good(value, DateTime::MIN));
    coarse.value.value.as_scalar().and_then(Scalar::as_i128).expect("an integer")
}

/// Returns each shown value with the number of values that it stands for, without the ends of
/// the range.
fn widths(policy: &DisclosurePolicy) -> Vec<(i128, i64)> {
    let mut widths: Vec<(i128, i64)> = Vec::new();
    for value in range() {
        let shown = shown(policy, value);
        match widths.last_mut() {
            Some((last, width)) if *last == shown => *width += 1,
            _ => widths.push((shown, 1)),
        }
    }
    widths.remove(0);
    widths.pop();
    widths
}

fn significant(number: i128) -> usize {
    number.unsigned_abs().to_string().trim_end_matches('0').len()
}

proptest! {
    #[test]
    fn no_value_is_finer_than_either_allows(left in value_policies(), right in value_policies()) {
        let both = left.strictest(&right);
        for policy in [&left, &right] {
            if let Some(step) = policy.rounding_step.and_then(RoundingStep::to_integer) {
                for (shown, width) in widths(&both) {
                    // Ties are rounded away from zero, so zero contains neither of its two ends.
                    let width = width + i64::from(shown == 0);
                    prop_assert!(i128::from(width) >= step, "{shown} stands for {width} values, {step} is allowed");
                }
            }
            if let Some(digits) = policy.significant_digits {
                prop_assert!(range().all(|value| significant(shown(&both, value)) <= usize::from(digits)));
            }
            if !policy.bands.is_empty() {
                let only = DisclosurePolicy { bands: policy.bands.clone(), ..Default::default() };
                for value in range().skip(1) {
                    let is_same_band = shown(&only, value) == shown(&only, value - 1);
                    prop_assert!(!is_same_band || shown(&both, value) == shown(&both, value - 1));
                }
            }
        }
    }

    #[test]
    fn no_aggregate_reveals_more_than_either_allows(left in aggregates(), right in aggregates()) {
        let both = left.strictest(&right);
        prop_assert_eq!(&both, &right.strictest(&left));
        for policy in [&left, &right] {
            let Some(own) = policy.aggregate else { continue };
            let both = both.aggregate.expect("an aggregate");
            prop_assert!(both.window_ms >= own.window_ms && both.function >= own.function);
        }
    }

    #[test]
    fn the_order_does_not_matter(left in value_policies(), right in value_policies()) {
        let (both, other) = (left.strictest(&right), right.strictest(&left));
        // Without a common bound one band remains, whose single value has no information.
        if both.bands.len() != 1 {
            prop_assert_eq!(&both, &other);
        }
        prop_assert_eq!(&both.strictest(&both), &both);
        prop_assert_eq!(left.strictest(&DisclosurePolicy::default()), left);
    }
}

#[test]
fn times_and_rates_are_combined() {
    let check = |left: &str, right: &str, both: &str| {
        let parse = |json: &str| serde_json::from_str::<DisclosurePolicy>(json).expect("a policy");
        assert_eq!(parse(left).strictest(&parse(right)), parse(both), "{left} and {right}");
    };
    check(
        r#"{"minimumIntervalMs":5,"delayMs":9}"#,
        r#"{"minimumIntervalMs":7,"timeStepMs":3}"#,
        r#"{"minimumIntervalMs":7,"timeStepMs":3,"delayMs":9}"#,
    );
    check(
        r#"{"rateLimits":[{"values":5,"periodMs":10},{"values":1,"periodMs":2}]}"#,
        r#"{"rateLimits":[{"values":4,"periodMs":20}]}"#,
        r#"{"rateLimits":[{"values":1,"periodMs":2},{"values":4,"periodMs":20}]}"#,
    );
    check(
        r#"{"aggregate":{"function":"MEAN","windowMs":10}}"#,
        r#"{"aggregate":{"function":"LAST","windowMs":20}}"#,
        r#"{"aggregate":{"function":"MEAN","windowMs":20}}"#,
    );
    // Saying nothing about status codes allows the common ones only.
    check(r#"{"statusCodes":"FULL"}"#, "{}", "{}");
    check(r#"{"statusCodes":"FULL"}"#, r#"{"statusCodes":"FULL"}"#, r#"{"statusCodes":"FULL"}"#);
    check("{}", r#"{"statusCodes":"SEVERITY"}"#, r#"{"statusCodes":"SEVERITY"}"#);
    let (day, night) = (
        r#"{"days":["MONDAY"],"from":"06:00","until":"14:00"}"#,
        r#"{"days":["MONDAY","SUNDAY"],"from":"12:00","until":"22:00","utcOffsetMinutes":60}"#,
    );
    check(
        &format!(r#"{{"workingHours":{day},"withholdWhile":[{{"states":[1]}}]}}"#),
        &format!(
            r#"{{"workingHours":{night},"withholdWhile":[{{"states":[1]}},{{"states":[2]}}]}}"#
        ),
        &format!(
            r#"{{"workingHours":{day},"furtherHours":[{night}],"withholdWhile":[{{"states":[1]}},{{"states":[2]}}]}}"#
        ),
    );
}

#[test]
fn a_policy_satisfies_what_is_no_stricter() {
    let check = |policy: &str, other: &str, expected: bool| {
        let parse = |json: &str| serde_json::from_str::<DisclosurePolicy>(json).expect("a policy");
        assert_eq!(parse(other).allows_all_of(&parse(policy)), expected, "{policy} and {other}");
    };
    check("{}", "{}", true);
    check(r#"{"roundingStep":10}"#, "{}", true);
    check("{}", r#"{"roundingStep":10}"#, false);
    check(r#"{"roundingStep":15}"#, r#"{"roundingStep":10}"#, false);
    check(r#"{"roundingStep":1.5}"#, r#"{"roundingStep":0.5}"#, true);
    check(r#"{"timeStepMs":90000}"#, r#"{"timeStepMs":60000}"#, false);
    check(r#"{"timeStepMs":120000}"#, r#"{"timeStepMs":60000}"#, true);
    let window = |ms: u32| format!(r#"{{"aggregate":{{"function":"LAST","windowMs":{ms}}}}}"#);
    check(&window(90_000), &window(60_000), false);
    check(&window(120_000), &window(60_000), true);
    let functions = ["LAST", "MAXIMUM", "MINIMUM", "SUM", "MEAN"];
    for former in functions {
        for function in functions {
            let of = |function: &str, ms: u32| {
                format!(r#"{{"aggregate":{{"function":"{function}","windowMs":{ms}}}}}"#)
            };
            check(&of(former, 120_000), &of(function, 60_000), former == function);
            check(&of(former, 60_000), "{}", true);
            check("{}", &of(function, 60_000), false);
        }
    }
    check(r#"{"roundingStep":10}"#, r#"{"roundingStep":10,"delayMs":5}"#, false);
    check(r#"{"roundingStep":100,"delayMs":9}"#, r#"{"roundingStep":10,"delayMs":9}"#, true);
    check(r#"{"bands":[0.0,50.0]}"#, r#"{"bands":[0.0,25.0,50.0]}"#, true);
    check(r#"{"bands":[0.0,25.0,50.0]}"#, r#"{"bands":[0.0,50.0]}"#, false);
    check(r#"{"statusCodes":"FULL"}"#, "{}", false);
    let rates = r#"{"rateLimits":[{"values":5,"periodMs":10},{"values":1,"periodMs":2}]}"#;
    check(rates, rates, true);
    check(rates, r#"{"rateLimits":[{"values":2,"periodMs":2}]}"#, true);
    check(rates, r#"{"rateLimits":[{"values":1,"periodMs":20}]}"#, false);
    let withheld = r#"{"withholdWhile":[{"states":[1]}]}"#;
    check(withheld, "{}", true);
    check("{}", withheld, false);
}

#[test]
fn a_policy_fits_every_kind_of_field() {
    let policy: DisclosurePolicy = serde_json::from_str(
        r#"{"roundingStep":0.5,"bands":[],"significantDigits":2,"aggregate":{"function":"MEAN","windowMs":10}}"#,
    )
    .expect("a policy");
    for id in 1..=25 {
        let field_type = BuiltInType::from_id(id).expect("a type");
        for is_array in [false, true] {
            assert_eq!(
                policy.fitted_to(field_type, is_array).faults(field_type, is_array),
                [],
                "{field_type}"
            );
        }
    }
    let coarse: DisclosurePolicy =
        serde_json::from_str(r#"{"roundingStep":2.5}"#).expect("a policy");
    let whole = coarse.fitted_to(BuiltInType::Int32, false);
    assert_eq!(whole.rounding_step.and_then(RoundingStep::to_integer), Some(3));
}
