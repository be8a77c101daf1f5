//! Parts of a statement, as codes with parameters.

use serde::Serialize;

use crate::{
    AggregateFunction, DisclosurePolicy, RateLimit, RoundingStep, StatusCodes, WindowAggregate,
    WorkingHours,
};

/// Part of a policy as published to the partner: a code with parameters, for texts in another
/// language.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(tag = "code", rename_all = "SCREAMING_SNAKE_CASE")]
pub enum StatementPart {
    /// Every change, unchanged: the only part of an open policy.
    Unchanged,
    /// One value per window.
    Aggregated {
        function: AggregateFunction,
        /// The window's length in milliseconds.
        #[serde(rename = "windowMs")]
        window_ms: u64,
    },
    /// The nearest multiple of a step.
    Rounded {
        step: RoundingStep,
        /// The field's unit.
        unit: Option<String>,
    },
    /// The greatest bound not above the value.
    Banded {
        /// The bounds, ascending.
        bounds: Vec<f64>,
        /// The field's unit.
        unit: Option<String>,
    },
    /// Few significant digits.
    Digits { digits: u8 },
    /// At most one value per interval.
    Interval {
        /// The interval in milliseconds.
        #[serde(rename = "periodMs")]
        period_ms: u64,
    },
    /// Most values per period.
    Rate {
        values: u32,
        /// The period in milliseconds.
        #[serde(rename = "periodMs")]
        period_ms: u64,
    },
    /// Times in steps.
    TimeStep {
        /// The step in milliseconds.
        #[serde(rename = "periodMs")]
        period_ms: u64,
    },
    /// Released with a delay.
    Delayed {
        /// The delay in milliseconds.
        #[serde(rename = "periodMs")]
        period_ms: u64,
    },
    /// Values within certain hours alone.
    Hours { hours: WorkingHours },
    /// Withheld in certain states, which are not published.
    Withheld,
    /// Status codes in another resolution than the usual one.
    StatusCodes { resolution: StatusCodes },
}

impl StatementPart {
    /// Returns the parts of a policy in the order of their application; `unit` is the field's.
    #[must_use]
    pub fn all_of(policy: &DisclosurePolicy, unit: Option<&str>) -> Vec<Self> {
        let unit = || unit.map(str::to_owned);
        let mut parts = Vec::new();
        let aggregated = |of: WindowAggregate| Self::Aggregated {
            function: of.function,
            window_ms: of.window_ms,
        };
        parts.extend(policy.aggregate.map(aggregated));
        parts.extend(policy.rounding_step.map(|step| Self::Rounded { step, unit: unit() }));
        if !policy.bands.is_empty() {
            parts.push(Self::Banded { bounds: policy.bands.clone(), unit: unit() });
        }
        parts.extend(policy.significant_digits.map(|digits| Self::Digits { digits }));
        parts.extend(policy.minimum_interval_ms.map(|period_ms| Self::Interval { period_ms }));
        let rate =
            |limit: &RateLimit| Self::Rate { values: limit.values, period_ms: limit.period_ms };
        parts.extend(policy.rate_limits.iter().map(rate));
        parts.extend(policy.time_step_ms.map(|period_ms| Self::TimeStep { period_ms }));
        parts.extend(policy.delay_ms.map(|period_ms| Self::Delayed { period_ms }));
        parts.extend(policy.hours().map(|hours| Self::Hours { hours: hours.clone() }));
        if !policy.withhold_while.is_empty() {
            parts.push(Self::Withheld);
        }
        if !policy.status_codes.is_common() {
            parts.push(Self::StatusCodes { resolution: policy.status_codes });
        }
        if parts.is_empty() {
            parts.push(Self::Unchanged);
        }
        parts
    }
}
