//! Steps that combine inputs: merging rules and scripts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// One value from several inputs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Merge {
    /// The names of the inputs, in their order of precedence; all where empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<String>,
    /// Rule by which the inputs become one value.
    pub rule: MergeRule,
    /// Separator between the texts of `join`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub separator: Option<String>,
}

/// Rule by which several inputs become one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum MergeRule {
    /// The one with the newest source time.
    Newest,
    /// The first whose status is Good; else the first that is Uncertain.
    FirstGood,
    /// The smallest number.
    Minimum,
    /// The greatest number.
    Maximum,
    /// The sum; exact for integers.
    Sum,
    /// The arithmetic mean, as Double.
    Mean,
    /// True where all are true.
    All,
    /// True where any is true.
    Any,
    /// Their texts one after the other.
    Join,
    /// An array of them, all of one type.
    Array,
}

/// A JavaScript function `(value, ctx) => ...`, run in a worker process.
///
/// `ctx.state` is kept between calls (at most 4 KiB as JSON) and survives restarts; variables
/// outside the function do not. `ctx.inputs.<name>` has `value`, `status` and `sourceTimestamp`,
/// `ctx.status` and `ctx.sourceTimestamp` are those of `value`. 64-bit integers are BigInt.
/// `undefined` yields nothing, `null` no value.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Script {
    /// The source text.
    #[schema(max_length = 65536)]
    pub source: String,
}
