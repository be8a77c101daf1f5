//! Statements of retention in an access log: what was removed, by which rule, when.

use asi_model::{DateTime, FactoryId};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::AccessEntry;

/// Rule by which the oldest entries are removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum AccessRetentionRule {
    /// Age: recorded before the time that the statement names.
    Age,
    /// The log had more entries than are kept.
    Count,
    /// Found so: a former version removed them and did not state when and by which rule.
    FormerVersion,
}

/// Statement in a log about what retention removed from it. What is missing without one is a fault.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct AccessRetention {
    pub rule: AccessRetentionRule,
    /// Time before which entries were removed; of `AGE` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub before: Option<DateTime>,
    /// Number of entries that are kept; of `COUNT` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kept: Option<u64>,
    /// Number of the last entry that was removed, with all before it.
    pub removed_through: u64,
}

/// The entry of a statement, whose canonical text is a leaf of the tree.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct AccessRetentionEntry {
    pub factory_id: FactoryId,
    /// Number in the log, from 1 without gaps.
    pub number: u64,
    pub recorded_at: DateTime,
    pub retention: AccessRetention,
}

impl AccessRetentionEntry {
    /// Returns the canonical text that is hashed and stored.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("an entry has text keys only")
    }

    /// Returns whether the statement is about entries before it, and about the past.
    pub(crate) fn is_possible(&self) -> bool {
        let AccessRetention { before, removed_through, .. } = self.retention;
        removed_through < self.number && before.is_none_or(|before| before <= self.recorded_at)
    }
}

/// Entry of either kind.
#[derive(Deserialize)]
#[serde(untagged)]
pub(crate) enum AccessRecord {
    Retention(AccessRetentionEntry),
    Access(AccessEntry),
}

impl AccessRecord {
    /// Returns the factory and the number that the entry says it has.
    pub(crate) const fn place(&self) -> (&FactoryId, u64) {
        match self {
            Self::Retention(entry) => (&entry.factory_id, entry.number),
            Self::Access(entry) => (&entry.factory_id, entry.number),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_of_statements_never_changes() {
        let entry = AccessRetentionEntry {
            factory_id: "F".parse().expect("an id"),
            number: 9,
            recorded_at: "2026-11-21T10:01:00Z".parse().expect("a time"),
            retention: AccessRetention {
                rule: AccessRetentionRule::Age,
                before: Some("2025-11-21T00:00:00Z".parse().expect("a time")),
                kept: None,
                removed_through: 7,
            },
        };
        let text = r#"{"factoryId":"F","number":9,"recordedAt":"2026-11-21T10:01:00Z","retention":{"rule":"AGE","before":"2025-11-21T00:00:00Z","removedThrough":7}}"#;
        assert_eq!(entry.canonical(), text);
        let read: AccessRecord = serde_json::from_str(text).expect("reads back");
        assert!(matches!(read, AccessRecord::Retention(read) if read == entry));
    }
}
