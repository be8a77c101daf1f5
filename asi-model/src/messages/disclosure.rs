//! Statements of the precision in which a value leaves its factory.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Coarsening of a value before it leaves, in words and numbers.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct DisclosureStatement {
    /// One sentence for people.
    pub description: String,
    /// Values are rounded to multiples of this, in the field's unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rounding_step: Option<f64>,
    /// Values have at most so many significant digits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub significant_digits: Option<u8>,
    /// One value per window of time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aggregate: Option<AggregateStatement>,
    /// At most one value per this many milliseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub minimum_interval_ms: Option<u64>,
    /// At most so many values per period; all of these hold.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rate_limit_list: Vec<RateStatement>,
    /// Times are rounded down to multiples of this many milliseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_step_ms: Option<u64>,
    /// Values leave this many milliseconds late.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delay_ms: Option<u64>,
    /// Values are these bounds: of each the greatest not above it, in the field's unit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub band_list: Vec<f64>,
    /// Values leave within these hours only; all of them hold.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hours_list: Vec<HoursStatement>,
    /// True where no value leaves in certain states; the states themselves are not disclosed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_withheld_in_states: bool,
    /// Resolution of status codes; when absent, a small fixed set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub status_codes: Option<StatusResolution>,
}

/// Resolution in which status codes leave their factory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum StatusResolution {
    /// Every status code as it is.
    Full,
    /// One of Good, Uncertain and Bad.
    Severity,
}

/// Hours of the plant's clock.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct HoursStatement {
    /// The days, `MONDAY` to `SUNDAY`.
    pub day_list: Vec<String>,
    /// The first minute, `HH:MM`.
    pub from: String,
    /// The first minute no more, `HH:MM`.
    pub until: String,
    /// Offset of the plant's clock from UTC, in minutes; positive to the east.
    #[serde(default)]
    pub utc_offset_minutes: i16,
}

/// Aggregate of the values of a window.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct AggregateStatement {
    /// The aggregate in words: the last value, the maximum, the minimum, the sum, the mean over
    /// time.
    pub function: String,
    /// Length of a window in milliseconds; windows are multiples of it since 1970.
    pub window_ms: u64,
}

/// At most so many values within any period of this length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct RateStatement {
    /// Most values within the period.
    pub values: u32,
    /// The period in milliseconds.
    pub period_ms: u64,
}
