//! Strategies for a gate: any policy, and any sequence of events.

use asi_model::{Scalar, StatusCode, Variant, values::Array};
use proptest::prelude::*;

use super::*;
use crate::{
    RateLimit, StateValue, StatusCodes, Weekday, WindowAggregate, WithholdCondition, WorkingHours,
};

/// A Monday, 00:00 UTC.
pub(super) const START_MS: i64 = 1_799_625_600_000;
pub(super) const HOUR_MS: u64 = 3_600_000;

pub(super) fn at(ms: u64) -> DateTime {
    DateTime::from_unix_micros((START_MS + i64::try_from(ms).expect("small")) * 1_000)
}

pub(super) fn other() -> FieldName {
    "state".parse().expect("a name")
}

/// An event at a gate.
#[derive(Debug, Clone)]
pub(super) enum Step {
    Candidate(DataValue),
    State(Option<bool>),
    Wake,
    /// The connector stops and starts again from the stored state.
    Restart,
}

/// Any candidate of a mapping, a script, a person or an OPC UA client for a field of whole numbers.
fn candidates() -> impl Strategy<Value = DataValue> {
    let value = prop_oneof![
        8 => (-1000_i64..1000).prop_map(Variant::from),
        1 => any::<i64>().prop_map(Variant::from),
        1 => any::<f64>().prop_map(Variant::from),
        1 => Just(Variant::from("3.14159")),
        1 => Just(Variant::Null),
        1 => proptest::collection::vec(-1000_i64..1000, 0..4).prop_map(|elements| Variant::Array(Arc::new(Array {
            element_type: BuiltInType::Int64,
            elements: elements.into_iter().map(Scalar::Int64).collect(),
            dimensions: None,
        }))),
    ];
    let status = prop_oneof![
        8 => Just(StatusCode::GOOD),
        1 => Just(StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE),
        1 => Just(StatusCode::BAD_NO_DATA),
        1 => any::<u32>().prop_map(StatusCode),
    ];
    (value, status)
        .prop_map(|(value, status)| DataValue { status, ..DataValue::good(value, at(0)) })
}

pub(super) fn steps(pause_ms: u64) -> impl Strategy<Value = Vec<(u64, Step)>> {
    let step = prop_oneof![
        10 => candidates().prop_map(Step::Candidate),
        2 => proptest::option::of(any::<bool>()).prop_map(Step::State),
        2 => Just(Step::Wake),
        1 => Just(Step::Restart),
    ];
    proptest::collection::vec((0..pause_ms, step), 0..60)
}

fn status_codes() -> impl Strategy<Value = StatusCodes> {
    prop_oneof![Just(StatusCodes::Full), Just(StatusCodes::Common), Just(StatusCodes::Severity)]
}

pub(super) fn policies() -> impl Strategy<Value = DisclosurePolicy> {
    let period = || proptest::option::of(1_u64..5_000);
    let step = (1_u32..500).prop_map(|step| f64::from(step).try_into().expect("positive"));
    let rate =
        (1_u32..5, 1_u64..9_000).prop_map(|(values, period_ms)| RateLimit { values, period_ms });
    let function = prop_oneof![
        Just(AggregateFunction::Last),
        Just(AggregateFunction::Maximum),
        Just(AggregateFunction::Minimum),
        Just(AggregateFunction::Sum),
        Just(AggregateFunction::Mean),
    ];
    let aggregate = (function, 1_u64..5_000)
        .prop_map(|(function, window_ms)| WindowAggregate { function, window_ms });
    let condition =
        (any::<bool>(), -1000_i64..1000).prop_map(|(is_own, state)| WithholdCondition {
            field: (!is_own).then(other),
            states: vec![StateValue::Integer(state), StateValue::Integer(7)],
        });
    let hours = Just(WorkingHours {
        days: vec![Weekday::Monday, Weekday::Wednesday],
        from: "06:00".parse().expect("a time"),
        until: "14:30".parse().expect("a time"),
        utc_offset_minutes: 60,
    });
    (
        (proptest::option::of(step), any::<bool>(), proptest::option::of(1_u8..4)),
        (period(), period(), period()),
        proptest::collection::vec(rate, 0..3),
        proptest::option::of(aggregate),
        proptest::collection::vec(condition, 0..2),
        (proptest::option::weighted(0.2, hours), status_codes()),
    )
        .prop_map(
            |(
                (step, is_banded, significant_digits),
                times,
                rate_limits,
                aggregate,
                withhold_while,
                (hours, status_codes),
            )| {
                let mut policy = DisclosurePolicy {
                    significant_digits,
                    minimum_interval_ms: times.0,
                    time_step_ms: times.1,
                    delay_ms: times.2,
                    rate_limits,
                    aggregate,
                    withhold_while,
                    working_hours: hours,
                    status_codes,
                    ..Default::default()
                };
                if is_banded {
                    policy.bands = vec![-100.0, 0.0, 100.0];
                } else {
                    policy.rounding_step = step;
                }
                policy
            },
        )
}
