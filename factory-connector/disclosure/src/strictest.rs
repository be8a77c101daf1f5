//! Strictest of several policies, and adaptation of a policy to a field.
//!
//! All recipients of a request get the same values. If their policies differ, the strictest applies
//! in each dimension: a released value is never finer, faster or earlier than any of them allows.

use asi_model::BuiltInType;

use super::{
    AggregateFunction, Decimal, DisclosurePolicy, RateLimit, RoundingStep, WindowAggregate,
    WithholdCondition, coarsening::holds_numbers,
};

impl DisclosurePolicy {
    /// Combines two policies to the strictest, dimension by dimension.
    ///
    /// The longer of two steps, intervals, windows and delays applies, and the smaller number of
    /// digits; all rate limits, hours and withheld states apply, and the coarser status codes: a policy
    /// that says nothing about them allows no finer ones. A longer step that is no multiple of the
    /// shorter one has other boundaries. Of two lists of bands the common
    /// bounds remain; beside a rounding step the bands that are at least as wide. Of two aggregates
    /// with the same window, the function that reveals less of a single value applies.
    #[must_use]
    pub fn strictest(&self, other: &Self) -> Self {
        let (bands, rounding_step) = strictest_values(self, other);
        Self {
            rounding_step,
            bands,
            significant_digits: least(self.significant_digits, other.significant_digits),
            aggregate: strictest_aggregate(self.aggregate, other.aggregate),
            minimum_interval_ms: self.minimum_interval_ms.max(other.minimum_interval_ms),
            rate_limits: strictest_rates(&self.rate_limits, &other.rate_limits),
            time_step_ms: self.time_step_ms.max(other.time_step_ms),
            delay_ms: self.delay_ms.max(other.delay_ms),
            working_hours: self.working_hours.clone().or_else(|| other.working_hours.clone()),
            further_hours: {
                let first = self.working_hours.as_ref().or(other.working_hours.as_ref());
                let mut further = Vec::new();
                for hours in self.hours().chain(other.hours()) {
                    if Some(hours) != first && !further.contains(hours) {
                        further.push(hours.clone());
                    }
                }
                further
            },
            withhold_while: {
                let mut conditions: Vec<WithholdCondition> = self.withhold_while.clone();
                let further = other
                    .withhold_while
                    .iter()
                    .filter(|condition| !self.withhold_while.contains(condition));
                conditions.extend(further.cloned());
                conditions
            },
            status_codes: self.status_codes.max(other.status_codes),
        }
    }

    /// Returns true where everything that a former policy let out satisfies this one, too: it is stricter
    /// in no dimension. Errs on the side of false.
    #[must_use]
    pub fn allows_all_of(&self, former: &Self) -> bool {
        // With itself: the combination has one form of what can be written in several.
        self == former
            || (former.strictest(self) == former.strictest(former) && is_on_grid_of(former, self))
    }

    /// Adapts this policy to a field of this type: parts that the type cannot have are removed, and
    /// whole numbers get steps and bounds that are at least as coarse.
    #[must_use]
    pub fn fitted_to(&self, field_type: BuiltInType, is_array: bool) -> Self {
        let mut fitted = self.clone();
        if !holds_numbers(field_type) {
            fitted.rounding_step = None;
            fitted.bands = Vec::new();
            fitted.significant_digits = None;
        }
        if field_type.is_integer() {
            fitted.rounding_step = self.rounding_step.and_then(whole_step);
            fitted.bands = self.bands.iter().map(|bound| bound.ceil().clamp(-9e15, 9e15)).collect();
            fitted.bands.dedup();
        }
        let fits =
            |condition: &WithholdCondition| condition.field.is_some() || condition.fits(field_type);
        fitted.withhold_while.retain(fits);
        if is_array || !field_type.is_numeric() {
            // These values have no aggregate. A single value of the window reveals more of the
            // value, but no more of the time.
            let last =
                |aggregate| WindowAggregate { function: AggregateFunction::Last, ..aggregate };
            fitted.aggregate = self.aggregate.map(last);
        }
        fitted
    }
}

/// Returns the next whole number from a step on; none when the step is at most one.
fn whole_step(step: RoundingStep) -> Option<RoundingStep> {
    let whole = step.to_integer().unwrap_or_else(|| {
        let fraction = step.decimal().to_f64().ceil();
        Decimal::from_f64(fraction).and_then(Decimal::to_integer).unwrap_or(i128::MAX)
    });
    if whole <= 1 { None } else { RoundingStep::new(Decimal::new(whole, 0)).ok() }
}

/// Returns true where the steps of `former` are multiples of those of `policy`: what is on the one's is on
/// the other's, too.
fn is_on_grid_of(former: &DisclosurePolicy, policy: &DisclosurePolicy) -> bool {
    let window = |policy: &DisclosurePolicy| policy.aggregate.map(|aggregate| aggregate.window_ms);
    let times = [(former.time_step_ms, policy.time_step_ms), (window(former), window(policy))];
    let is_multiple = |(former, own): (Option<u64>, Option<u64>)| {
        own.is_none_or(|own| former.unwrap_or_default().is_multiple_of(own.max(1)))
    };
    let (steps, own) = (former.rounding_step, policy.rounding_step);
    times.into_iter().all(is_multiple)
        && own
            .zip(steps)
            .is_none_or(|(own, former)| former.decimal().round_to(own) == former.decimal())
}

fn least<T: Ord>(left: Option<T>, right: Option<T>) -> Option<T> {
    match (left, right) {
        (Some(left), Some(right)) => Some(left.min(right)),
        (left, right) => left.or(right),
    }
}

fn strictest_values(
    left: &DisclosurePolicy,
    right: &DisclosurePolicy,
) -> (Vec<f64>, Option<RoundingStep>) {
    let step = [left.rounding_step, right.rounding_step]
        .into_iter()
        .flatten()
        .max_by(|left, right| left.decimal().to_f64().total_cmp(&right.decimal().to_f64()));
    let bands = match (left.bands.as_slice(), right.bands.as_slice()) {
        ([], []) => return (Vec::new(), step),
        ([], bands) | (bands, []) => bands.to_vec(),
        (left, right) => {
            let common: Vec<f64> =
                left.iter().filter(|bound| right.contains(bound)).copied().collect();
            // No common bound: one band for all values.
            if common.is_empty() { left[..1].to_vec() } else { common }
        }
    };
    let width = step.map_or(0.0, |step| step.decimal().to_f64());
    let mut remaining: Vec<f64> = Vec::with_capacity(bands.len());
    for bound in bands {
        if remaining.last().is_none_or(|last| bound - last >= width) {
            remaining.push(bound);
        }
    }
    (remaining, None)
}

fn strictest_aggregate(
    left: Option<WindowAggregate>,
    right: Option<WindowAggregate>,
) -> Option<WindowAggregate> {
    let order = |aggregate: &WindowAggregate| (aggregate.window_ms, aggregate.function);
    [left, right].into_iter().flatten().max_by_key(order)
}

/// Returns all limits except those that another one implies.
fn strictest_rates(left: &[RateLimit], right: &[RateLimit]) -> Vec<RateLimit> {
    let all: Vec<RateLimit> = left.iter().chain(right).copied().collect();
    let implies = |by: &RateLimit, limit: &RateLimit| {
        by != limit && by.values <= limit.values && by.period_ms >= limit.period_ms
    };
    let mut remaining: Vec<RateLimit> =
        all.iter().filter(|limit| !all.iter().any(|by| implies(by, limit))).copied().collect();
    remaining.sort_unstable();
    remaining.dedup();
    remaining
}

#[cfg(test)]
mod tests {
    use asi_model::{DataValue, DateTime, Scalar};
    use proptest::prelude::*;

    use super::{super::coarsening::coarsen, *};

    fn range() -> std::ops::RangeInclusive<i64> {
        -260..=260
    }

    fn value_policies() -> impl Strategy<Value = DisclosurePolicy> {
        let bands = proptest::collection::btree_set(-20_i32..20, 1..6);
        prop_oneof![
            (proptest::option::of(1_u32..60), proptest::option::of(1_u8..4)).prop_map(
                |(step, significant_digits)| {
                    let rounding_step =
                        step.map(|step| f64::from(step).try_into().expect("positive"));
                    DisclosurePolicy { rounding_step, significant_digits, ..Default::default() }
                }
            ),
            (bands, proptest::option::of(1_u8..4)).prop_map(|(bands, significant_digits)| {
                let bands = bands.into_iter().map(|bound| f64::from(bound * 10)).collect();
                DisclosurePolicy { bands, significant_digits, ..Default::default() }
            }),
        ]
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
            let parse =
                |json: &str| serde_json::from_str::<DisclosurePolicy>(json).expect("a policy");
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
            r#"{"aggregate":{"function":"LAST","windowMs":20}}"#,
        );
        // Saying nothing about status codes allows the common ones only.
        check(r#"{"statusCodes":"FULL"}"#, "{}", "{}");
        check(
            r#"{"statusCodes":"FULL"}"#,
            r#"{"statusCodes":"FULL"}"#,
            r#"{"statusCodes":"FULL"}"#,
        );
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
            let parse =
                |json: &str| serde_json::from_str::<DisclosurePolicy>(json).expect("a policy");
            assert_eq!(
                parse(other).allows_all_of(&parse(policy)),
                expected,
                "{policy} and {other}"
            );
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
}
