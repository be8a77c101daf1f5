//! Statements of retention: values that were emptied and entries that were removed, by which rule.

use asi_model::DateTime;
use serde::{Deserialize, Serialize};

use super::SequenceRange;

/// Most ranges in one statement, so that an entry stays readable at once.
const RANGES_MAX: usize = 10_000;

/// Rule by which values are emptied or entries removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum RetentionRule {
    /// Values are emptied after the configured number of days.
    ValueDays,
    /// Entries are removed after the configured number of days; an anchor stands for them.
    EntryDays,
    /// Found so when the first version that states retention was started: a former version emptied
    /// values or removed entries and did not state when and by which rule.
    FormerVersion,
}

/// Statement in a chain about what retention took from it. What is missing without one is a fault.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RetentionStatement {
    pub rule: RetentionRule,
    /// Configured number of days; none for what was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub days: Option<u32>,
    /// Time before which reports and entries are affected.
    pub before: DateTime,
    /// Reports whose values were emptied.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub emptied: Vec<SequenceRange>,
    /// Number of the last entry of the chain that was removed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub removed_through: Option<u64>,
}

impl RetentionStatement {
    /// Makes statements about emptied values, as many as their ranges need.
    #[must_use]
    pub fn of_values(
        rule: RetentionRule,
        days: Option<u32>,
        before: DateTime,
        emptied: &[SequenceRange],
    ) -> Vec<Self> {
        let of = |ranges: &[SequenceRange]| Self {
            rule,
            days,
            before,
            emptied: ranges.to_vec(),
            removed_through: None,
        };
        emptied.chunks(RANGES_MAX).map(of).collect()
    }
}
