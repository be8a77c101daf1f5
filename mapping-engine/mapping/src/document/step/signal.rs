//! Steps over the course of a value: edges, limits, noise, rates and windows.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::{document::Literal, number::Number};

/// Lets a Boolean (or a number: not zero is true) pass only when it changes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Edge {
    /// Change that passes.
    pub direction: EdgeDirection,
}

/// A change of a Boolean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum EdgeDirection {
    /// From false to true.
    Rising,
    /// From true to false.
    Falling,
    /// From either to the other.
    Both,
}

/// Comparison of a number with a limit, with hysteresis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Threshold {
    /// At or above this it is above.
    pub limit: Number,
    /// Once above, it stays so until the number falls below this; the limit itself where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub release: Option<Number>,
    /// Value yielded above; `true` where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<Literal>,
    /// Value yielded below; `false` where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub below: Option<Literal>,
}

/// Lets a value pass once it has not changed for a while.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Debounce {
    /// Time that it must stay the same, in milliseconds.
    #[schema(minimum = 1)]
    pub quiet_ms: u64,
}

/// Holds changes back that are too small. Without parameters only repeats of the same value are
/// held back; values that are no numbers pass when they differ. A change of the status always
/// passes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Deadband {
    /// The change must be greater than this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub absolute: Option<Number>,
    /// The change must be greater than this share of the last value that passed, in percent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub percent: Option<f64>,
}

/// Change per time, by the source's times, as Double. The first value yields nothing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Rate {
    /// Time that the rate refers to.
    #[serde(default)]
    pub per: RatePeriod,
}

/// The time that a rate refers to.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema, ToSchema,
)]
#[serde(rename_all = "camelCase")]
#[allow(missing_docs)]
pub enum RatePeriod {
    #[default]
    Second,
    Minute,
    Hour,
    Day,
}

/// An aggregate over the last values (`samples`) or the last span of time (`durationMs`); exactly
/// one of the two. Over time it also changes when values leave the window. At most 4096 values are
/// kept; beyond, the oldest leave early.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Window {
    /// Function over the values in the window.
    pub aggregate: Aggregate,
    /// Number of values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 4096)]
    pub samples: Option<u32>,
    /// Span back from the newest value, in milliseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1)]
    pub duration_ms: Option<u64>,
}

/// Function over the values in a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum Aggregate {
    /// The smallest value.
    Minimum,
    /// The greatest value.
    Maximum,
    /// The arithmetic mean, as Double.
    Mean,
    /// The sum; exact for integers.
    Sum,
    /// Number of values.
    Count,
    /// The newest value.
    Last,
}
