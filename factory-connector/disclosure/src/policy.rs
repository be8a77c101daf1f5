//! The disclosure policy of a field: what the engineer consented to.

use std::time::Duration;

use asi_model::{DataValue, DateTime};
use serde::{Deserialize, Serialize};

use super::{RateLimit, RoundingStep, WindowAggregate, WithholdCondition, WorkingHours};

/// How a field's values are coarsened before they leave. Empty: every change leaves as it is.
///
/// In this order: what comes in a withheld state is dropped, an aggregate is made of each window,
/// the number is banded or rounded and then cut to its significant digits; the result waits for its
/// delay, the intervals and rates, the time step and the working hours.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
pub struct DisclosurePolicy {
    /// Numbers are rounded to the nearest multiple of this, in the field's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<f64>)]
    pub rounding_step: Option<RoundingStep>,
    /// Numbers are replaced by the greatest of these bounds not above them (by the lowest, if below
    /// all); ascending.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<f64>,
    /// Numbers have at most so many significant digits, 1 to 15.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub significant_digits: Option<u8>,
    /// One value leaves per window, made of all that held within it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aggregate: Option<WindowAggregate>,
    /// At most one value leaves per this many milliseconds; the latest wins.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minimum_interval_ms: Option<u64>,
    /// At most so many values leave per period; all of these hold.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rate_limits: Vec<RateLimit>,
    /// Times are rounded down to multiples of this many milliseconds since 1970, and values leave
    /// on them only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_step_ms: Option<u64>,
    /// Every value leaves this many milliseconds late.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_ms: Option<u64>,
    /// Values leave within these hours only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub working_hours: Option<WorkingHours>,
    /// Values leave within each of these hours only, beside the working hours.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub further_hours: Vec<WorkingHours>,
    /// Nothing leaves while any of these is met, and what comes meanwhile never leaves.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub withhold_while: Vec<WithholdCondition>,
}

/// Longest interval, time step or delay: a year.
pub(super) const PERIOD_MS_MAX: u64 = 366 * 86_400_000;
/// Rounds in which a time step and several hours must agree on an instant.
const SLOT_ROUNDS_MAX: usize = 64;

impl DisclosurePolicy {
    /// True where nothing is coarsened.
    #[must_use]
    pub fn is_open(&self) -> bool {
        *self == Self::default()
    }

    /// True where values are coarsened at most: when they leave, and whether, is left to those who
    /// bring them.
    pub(super) fn is_immediate(&self) -> bool {
        self.aggregate.is_none()
            && self.rate_limits.is_empty()
            && self.withhold_while.is_empty()
            && !self.has_hours()
            && [self.minimum_interval(), self.time_step(), self.delay()]
                .iter()
                .all(Duration::is_zero)
    }

    /// The minimum interval, zero without one.
    #[must_use]
    pub fn minimum_interval(&self) -> Duration {
        Duration::from_millis(self.minimum_interval_ms.unwrap_or(0))
    }

    /// The time step, zero without one.
    #[must_use]
    pub fn time_step(&self) -> Duration {
        Duration::from_millis(self.time_step_ms.unwrap_or(0))
    }

    /// The delay, zero without one.
    #[must_use]
    pub fn delay(&self) -> Duration {
        Duration::from_millis(self.delay_ms.unwrap_or(0))
    }

    /// Values leave within certain hours only.
    pub(super) const fn has_hours(&self) -> bool {
        self.working_hours.is_some() || !self.further_hours.is_empty()
    }

    /// All hours, within each of which a value must lie to leave.
    pub(super) fn hours(&self) -> impl Iterator<Item = &WorkingHours> {
        self.working_hours.iter().chain(&self.further_hours)
    }

    /// The first instant from `at` on that is on the time step and within all hours; `None` where
    /// there is none.
    pub(super) fn first_slot(&self, at: DateTime) -> Option<DateTime> {
        self.first_slot_of(at, self.time_step())
    }

    pub(super) fn first_slot_of(&self, at: DateTime, step: Duration) -> Option<DateTime> {
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

    /// Whether a value is in a state in which nothing of its own field leaves; `None` where it does
    /// not say.
    pub(super) fn is_own_state_withheld(&self, value: &DataValue) -> Option<bool> {
        let mut own =
            self.withhold_while.iter().filter(|condition| condition.field.is_none()).peekable();
        own.peek()?;
        own.map(|condition| condition.is_met_by(value))
            .try_fold(false, |any, is_met| is_met.map(|is_met| any || is_met))
    }
}

/// Rounded up to a multiple of `step` since 1970; unchanged where the step is zero.
fn ceil_to(at: DateTime, step: Duration) -> DateTime {
    let floor = at.floor_to(step);
    if floor == at { at } else { floor.after(step) }
}
