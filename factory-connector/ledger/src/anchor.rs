//! Anchor of a chain, in place of entries that retention removed.

use asi_model::{DateTime, FactoryId, OrganisationId};
use serde::{Deserialize, Serialize};

/// Signed statement about the beginning of a chain, from which it continues.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Anchor {
    pub factory_id: FactoryId,
    /// Organisation of the chain.
    pub recipient: OrganisationId,
    /// Number of the last entry that was removed.
    pub number: u64,
    /// Hash of that entry, hexadecimal; the first remaining entry follows it.
    pub hash: String,
    /// Leaves of the log up to that entry, as the hashes of the largest perfect subtrees, hexadecimal;
    /// empty where the log begins after it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub leaves: Vec<String>,
    /// Latest time at which that entry, or one before it, had been recorded.
    pub last_entry_at: DateTime,
    /// Time of the removal.
    pub recorded_at: DateTime,
}

impl Anchor {
    /// Returns the text that is signed and stored.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("an anchor has text keys only")
    }
}
