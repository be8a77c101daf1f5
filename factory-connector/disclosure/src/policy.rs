//! Disclosure policy of a field, to which the engineer consents.

use std::time::Duration;

use asi_model::{DataValue, DateTime};
use serde::{Deserialize, Serialize};

use super::{
    RateLimit, RoundingStep, StatusCodes, WindowAggregate, WithholdCondition, WorkingHours,
};

/// Coarsening of a field's values before they are released. Empty: every change is released
/// unchanged.
///
/// In this order: values in a withheld state are dropped, each window is aggregated, the number is
/// banded or rounded and then cut to its significant digits, and the status code is coarsened; the
/// result waits for its delay, the intervals and rates, the time step and the working hours.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
pub struct DisclosurePolicy {
    /// Numbers are rounded to the nearest multiple of this, in the field's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rounding_step: Option<RoundingStep>,
    /// Numbers are replaced by the greatest of these bounds not above them (by the lowest, if below
    /// all); ascending.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<f64>,
    /// Most significant digits of numbers, 1 to 15.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub significant_digits: Option<u8>,
    /// One value is released per window, aggregated over it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aggregate: Option<WindowAggregate>,
    /// Shortest time between two released values, in milliseconds; the latest value wins.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minimum_interval_ms: Option<u64>,
    /// Most released values per period; all of these limits apply.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rate_limits: Vec<RateLimit>,
    /// Times are rounded down to multiples of this many milliseconds since 1970, and values are
    /// released only at these times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_step_ms: Option<u64>,
    /// Delay of every value, in milliseconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_ms: Option<u64>,
    /// Values are released only within these hours.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub working_hours: Option<WorkingHours>,
    /// Values are released only within all of these hours, too.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub further_hours: Vec<WorkingHours>,
    /// No value is released while one of these conditions is met; candidates of that time never are.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub withhold_while: Vec<WithholdCondition>,
    /// Resolution of status codes; a small fixed set when absent.
    #[serde(skip_serializing_if = "StatusCodes::is_common")]
    pub status_codes: StatusCodes,
}

/// Longest interval, time step or delay: a year.
pub(super) const PERIOD_MS_MAX: u64 = 366 * 86_400_000;
/// Shortest and longest time after a step at which a value counts as released on it: a tenth of the
/// step within these bounds.
const LATENESS_MIN: Duration = Duration::from_millis(100);
const LATENESS_MAX: Duration = Duration::from_secs(5);
/// Rounds in which a time step and several hours must agree on an instant.
const SLOT_ROUNDS_MAX: usize = 64;

impl DisclosurePolicy {
    /// Returns true when nothing is coarsened.
    #[must_use]
    pub fn is_open(&self) -> bool {
        *self == Self::default()
    }

    /// Returns true when the policy only coarsens values and never delays or withholds them.
    pub(super) fn is_immediate(&self) -> bool {
        self.aggregate.is_none()
            && self.rate_limits.is_empty()
            && self.withhold_while.is_empty()
            && !self.has_hours()
            && [self.minimum_interval(), self.time_step(), self.delay()]
                .iter()
                .all(Duration::is_zero)
    }

    /// Returns the minimum interval, zero without one.
    #[must_use]
    pub fn minimum_interval(&self) -> Duration {
        Duration::from_millis(self.minimum_interval_ms.unwrap_or(0))
    }

    /// Returns the time step, zero without one.
    #[must_use]
    pub fn time_step(&self) -> Duration {
        Duration::from_millis(self.time_step_ms.unwrap_or(0))
    }

    /// Returns the longest of the periods within which the policy lets only so many values out:
    /// interval, rates, time step and window; zero without any.
    #[must_use]
    pub fn longest_period(&self) -> Duration {
        let rates = self.rate_limits.iter().map(|limit| Duration::from_millis(limit.period_ms));
        let window = self.aggregate.map_or(Duration::ZERO, WindowAggregate::window);
        let others = [self.minimum_interval(), self.time_step(), window];
        rates.chain(others).max().unwrap_or_default()
    }

    /// Returns the delay, zero without one.
    #[must_use]
    pub fn delay(&self) -> Duration {
        Duration::from_millis(self.delay_ms.unwrap_or(0))
    }

    /// Returns true when values are released only within certain hours.
    pub(super) const fn has_hours(&self) -> bool {
        self.working_hours.is_some() || !self.further_hours.is_empty()
    }

    /// Returns all hours; a value is released only within each of them.
    pub(super) fn hours(&self) -> impl Iterator<Item = &WorkingHours> {
        self.working_hours.iter().chain(&self.further_hours)
    }

    /// Returns the first instant from `at` on that is on the time step and within all hours; `None`
    /// when there is none.
    pub(super) fn first_slot(&self, at: DateTime) -> Option<DateTime> {
        self.first_slot_of(at, self.time_step())
    }

    /// Returns the first instant from `at` on at which a window ends, later by the delay; `at` without
    /// windows. An aggregate that something holds up is released at the end of another window: at any
    /// other time its release would tell how long that took.
    pub(super) fn end_of_window(&self, at: DateTime) -> DateTime {
        let Some(window) = self.aggregate.map(WindowAggregate::window) else { return at };
        if window.is_zero() {
            return at;
        }
        let phase = Duration::from_nanos(
            u64::try_from(self.delay().as_nanos() % window.as_nanos()).unwrap_or_default(),
        );
        let ticks = i64::try_from(phase.as_nanos() / 100).unwrap_or_default();
        ceil_to(DateTime::from_ticks(at.ticks() - ticks), window).after(phase)
    }

    /// Returns `at` where a value may be released then, on the time step up to a lateness that
    /// timers have, and within all hours; otherwise the next slot; `None` when there is none.
    pub(super) fn first_punctual(&self, at: DateTime) -> Option<DateTime> {
        let step = self.time_step();
        let lateness = (step / 10).clamp(LATENESS_MIN, LATENESS_MAX);
        let is_late = !step.is_zero() && at.since(at.floor_to(step)) > lateness;
        if is_late { self.first_slot(at) } else { self.first_slot_of(at, Duration::ZERO) }
    }

    fn first_slot_of(&self, at: DateTime, step: Duration) -> Option<DateTime> {
        let mut at = ceil_to(at, step);
        for _ in 0..SLOT_ROUNDS_MAX {
            let before = at;
            for hours in self.hours() {
                at = hours.first_open(at)?;
            }
            at = ceil_to(at, step);
            if at == before {
                return Some(at);
            }
        }
        None
    }

    /// Returns whether a value is in a withheld state of its own field; `None` when that cannot be
    /// determined.
    pub(super) fn is_own_state_withheld(&self, value: &DataValue) -> Option<bool> {
        let mut own =
            self.withhold_while.iter().filter(|condition| condition.field.is_none()).peekable();
        own.peek()?;
        own.map(|condition| condition.is_met_by(value))
            .try_fold(false, |any, is_met| is_met.map(|is_met| any || is_met))
    }
}

/// Rounds up to a multiple of `step` since 1970; unchanged when the step is zero.
fn ceil_to(at: DateTime, step: Duration) -> DateTime {
    let floor = at.floor_to(step);
    if floor == at { at } else { floor.after(step) }
}
