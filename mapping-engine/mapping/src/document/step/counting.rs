//! Steps that count: increments of a counter and their sum.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::number::Number;

/// Increment of a counter since its last value. The first value yields nothing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Increment {
    /// Number of values that the counter has before it starts again at zero (65536 for a UInt16);
    /// it does not wrap where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulus: Option<Number>,
    /// Meaning of a decrease that is no wrap.
    #[serde(default)]
    pub on_decrease: OnDecrease,
}

/// Meaning of a counter's decrease that is no wrap.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema, ToSchema,
)]
#[serde(rename_all = "camelCase")]
pub enum OnDecrease {
    /// The counter was reset to zero and has counted to its value since.
    #[default]
    Reset,
    /// The counter was set; nothing was counted.
    Set,
    /// Counts downwards too: the increment is negative.
    Subtract,
}

/// The sum of a counter's increments, across wraps, resets and restarts of machine and connector.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Counter {
    /// Kind of counting; by the type of the value where absent: increments of numbers, rising edges
    /// of Booleans.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts: Option<CounterInput>,
    /// Sum before the first value.
    #[serde(default = "zero")]
    pub start: Number,
    /// Modulus as in `increment`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulus: Option<Number>,
    /// Treatment of a decrease as in `increment`.
    #[serde(default)]
    pub on_decrease: OnDecrease,
    /// An input that sets the sum back to `start` when it becomes true (or not zero).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reset_by: Option<String>,
}

/// Kind of counting of a `counter`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum CounterInput {
    /// The increments of a number.
    Increments,
    /// Changes of the value to true (or not zero).
    RisingEdges,
    /// Every value that arrives.
    Values,
}

const fn zero() -> Number {
    Number::ZERO
}
