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
    /// the longer window applies, and the function that reveals less of a single value.
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
            || (former.strictest(self) == former.strictest(former)
                && is_on_grid_of(former, self)
                && is_aggregated_as(former, self))
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

/// Returns true where values of `former` are made by the function that `policy` demands: a last value is no
/// mean, however long its window is.
fn is_aggregated_as(former: &DisclosurePolicy, policy: &DisclosurePolicy) -> bool {
    let function = |policy: &DisclosurePolicy| policy.aggregate.map(|aggregate| aggregate.function);
    function(policy).is_none_or(|own| function(former) == Some(own))
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
    let (Some(left), Some(right)) = (left, right) else { return left.or(right) };
    Some(WindowAggregate {
        function: left.function.max(right.function),
        window_ms: left.window_ms.max(right.window_ms),
    })
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
mod tests;
