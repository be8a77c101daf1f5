//! Effect of each part of a policy on one value, which the engineer sees before the consent.

use asi_model::{BuiltInType, DataValue, DateTime};
use serde::Serialize;

use super::{
    DisclosurePolicy, Statement, StatementPart, coarsening::coarsen, statement::describe_period,
};

/// A part of a policy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum EffectKind {
    /// Withheld in certain states.
    Withheld,
    /// One value per window.
    Aggregated,
    /// The greatest bound not above the value.
    Banded,
    /// The nearest multiple.
    Rounded,
    /// Few significant digits.
    Digits,
    /// Status codes in another resolution than the usual one.
    StatusCodes,
    /// Times in steps.
    TimeStep,
    /// Released with a delay.
    Delayed,
    /// At most one value per interval.
    Interval,
    /// Most values per period.
    Rate,
    /// Within certain hours.
    Hours,
}

/// Effect of one part of a policy.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Effect {
    pub kind: EffectKind,
    /// Sentence in English.
    pub text: String,
    /// The same as codes with parameters.
    pub parts: Vec<StatementPart>,
    /// True when it changes this value or its times, or withholds it at present.
    pub is_felt: bool,
}

/// Returns the effects of a policy on a candidate at a time, in the order of application.
/// `is_withheld`: the policy withholds the present state.
#[must_use]
pub fn effects(
    policy: &DisclosurePolicy,
    field_type: BuiltInType,
    candidate: &DataValue,
    is_withheld: bool,
    now: DateTime,
) -> Vec<Effect> {
    let alone = |part: DisclosurePolicy| coarsen(&part, field_type, candidate.clone()).value;
    let without = alone(DisclosurePolicy::default());
    let open = DisclosurePolicy::default;
    let mut effects = Vec::new();
    let mut add = |kind, part: DisclosurePolicy, is_felt: bool| {
        if !part.is_open() {
            let Statement { statement, statement_parts } = Statement::of(&part, None);
            effects.push(Effect { kind, text: statement, parts: statement_parts, is_felt });
        }
    };
    let withheld = DisclosurePolicy { withhold_while: policy.withhold_while.clone(), ..open() };
    add(EffectKind::Withheld, withheld, is_withheld);
    add(EffectKind::Aggregated, DisclosurePolicy { aggregate: policy.aggregate, ..open() }, true);
    for (kind, part) in [
        (EffectKind::Banded, DisclosurePolicy { bands: policy.bands.clone(), ..open() }),
        (EffectKind::Rounded, DisclosurePolicy { rounding_step: policy.rounding_step, ..open() }),
        (
            EffectKind::Digits,
            DisclosurePolicy { significant_digits: policy.significant_digits, ..open() },
        ),
        (EffectKind::StatusCodes, DisclosurePolicy { status_codes: policy.status_codes, ..open() }),
        (EffectKind::TimeStep, DisclosurePolicy { time_step_ms: policy.time_step_ms, ..open() }),
    ] {
        let is_felt = alone(part.clone()) != without;
        add(kind, part, is_felt);
    }
    add(EffectKind::Delayed, DisclosurePolicy { delay_ms: policy.delay_ms, ..open() }, true);
    add(
        EffectKind::Interval,
        DisclosurePolicy { minimum_interval_ms: policy.minimum_interval_ms, ..open() },
        false,
    );
    add(
        EffectKind::Rate,
        DisclosurePolicy { rate_limits: policy.rate_limits.clone(), ..open() },
        false,
    );
    let hours = DisclosurePolicy {
        working_hours: policy.working_hours.clone(),
        further_hours: policy.further_hours.clone(),
        ..open()
    };
    let is_closed = hours.first_slot(now) != Some(now);
    add(EffectKind::Hours, hours, is_closed);
    effects
}

/// Returns the most values per hour that a policy releases; `None` when only the publishing interval
/// limits them.
#[must_use]
pub fn values_per_hour_max(policy: &DisclosurePolicy) -> Option<f64> {
    const HOUR_MS: f64 = 3_600_000.0;
    #[allow(clippy::cast_precision_loss)]
    let per = |ms: u64| HOUR_MS / ms.max(1) as f64;
    let slots = [
        policy.minimum_interval_ms,
        policy.time_step_ms,
        policy.aggregate.map(|aggregate| aggregate.window_ms),
    ];
    let rates =
        policy.rate_limits.iter().map(|limit| f64::from(limit.values) * per(limit.period_ms));
    slots.into_iter().flatten().map(per).chain(rates).reduce(f64::min)
}

/// Returns the resolution of the times of values and of their releases, in milliseconds; zero when
/// changes are released at once.
#[must_use]
pub fn time_resolution_ms(policy: &DisclosurePolicy) -> u64 {
    // A minimum interval and rates limit the number of releases, not the resolution of their times.
    let window = policy.aggregate.map_or(0, |aggregate| aggregate.window_ms);
    policy.time_step_ms.unwrap_or(0).max(window)
}

/// Formats a period with its unit.
#[must_use]
pub fn period_in_words(ms: u64) -> String {
    describe_period(ms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_show_the_parts_that_apply() {
        let policy: DisclosurePolicy = serde_json::from_str(
            r#"{"roundingStep":10,"significantDigits":2,"minimumIntervalMs":60000,"withholdWhile":[{"states":[0]}]}"#,
        )
        .expect("a policy");
        let now = DateTime::from_unix_micros(1_800_000_000_000_000);
        let found: Vec<(EffectKind, bool)> =
            effects(&policy, BuiltInType::Int32, &DataValue::good(17_i32, now), false, now)
                .into_iter()
                .map(|effect| (effect.kind, effect.is_felt))
                .collect();
        use EffectKind as K;
        assert_eq!(
            found,
            [(K::Withheld, false), (K::Rounded, true), (K::Digits, false), (K::Interval, false)]
        );
        assert_eq!(
            effects(
                &DisclosurePolicy::default(),
                BuiltInType::Int32,
                &DataValue::default(),
                false,
                now
            ),
            []
        );
    }

    #[test]
    fn the_tightest_limit_determines_the_values_per_hour() {
        for (json, expected) in [
            ("{}", None),
            (r#"{"minimumIntervalMs":60000}"#, Some(60.0)),
            (
                r#"{"minimumIntervalMs":60000,"rateLimits":[{"values":3,"periodMs":3600000}]}"#,
                Some(3.0),
            ),
            (r#"{"aggregate":{"function":"MEAN","windowMs":1800000}}"#, Some(2.0)),
        ] {
            let policy: DisclosurePolicy = serde_json::from_str(json).expect("a policy");
            assert_eq!(values_per_hour_max(&policy), expected, "{json}");
        }
    }
}
