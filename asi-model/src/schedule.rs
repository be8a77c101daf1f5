//! The time frames of a network: earliest and latest times, slack and the critical path.
//!
//! One pass forward over the operations in dependency order gives the earliest times, one backward
//! the latest. Planned times are fixed: an operation starts and ends at its planned times; without
//! a plan it may last as long as it likes. Maximum gaps bind backwards, so that each of them may
//! need another pass forward. The number of passes is bounded, each takes time linear in operations
//! and relations.

mod earliest;
mod graph;
mod latest;
mod passes;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{ids::OperationId, network::IsoDuration, values::DateTime};

/// The result of the passes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Schedule {
    /// One entry per operation, in the network's order.
    pub operations: Vec<OperationTimes>,
    /// The operations whose delay delays the whole, in order of time. Empty where nothing is
    /// planned.
    pub critical_path: Vec<OperationId>,
    /// Bounds that cannot hold together.
    pub conflicts: Vec<Conflict>,
}

/// Time frame of an operation. Times are absent where neither it nor what it depends on is planned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct OperationTimes {
    pub operation_id: OperationId,
    /// Time before which it cannot start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub earliest_start: Option<DateTime>,
    /// Time before which it cannot be done.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub earliest_finish: Option<DateTime>,
    /// Time at which it must have begun, or the whole is late.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latest_start: Option<DateTime>,
    /// Time at which it must be done, or the whole is late.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latest_finish: Option<DateTime>,
    /// Longest delay of the operation that does not delay the whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slack: Option<IsoDuration>,
    /// True where there is no slack.
    pub is_critical: bool,
}

/// A bound that cannot hold together with the others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Conflict {
    pub origin: ConflictOrigin,
    /// A sentence that names the operations and times.
    pub message: String,
}

/// Position of a bound in the lists of the network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConflictOrigin {
    PlannedStart { operation: usize },
    PlannedEnd { operation: usize },
    Condition { relation: usize, condition: usize },
}

#[cfg(test)]
mod tests;
