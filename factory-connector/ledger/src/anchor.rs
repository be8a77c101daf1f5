//! What stands in the place of entries that retention removed.

use asi_model::{DateTime, FactoryId, OrganisationId};
use serde::{Deserialize, Serialize};

/// A signed statement about the beginning of a chain: it goes on from here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Anchor {
    /// Whose ledger.
    pub factory_id: FactoryId,
    /// Whose chain.
    pub recipient: OrganisationId,
    /// The number of the last entry that was removed.
    pub number: u64,
    /// Its hash, hexadecimal: the first entry that is left follows it.
    pub hash: String,
    /// When the last entry that was removed had been recorded.
    pub last_entry_at: DateTime,
    /// When they were removed.
    pub recorded_at: DateTime,
}

impl Anchor {
    /// The text that is signed and stored.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("an anchor has text keys only")
    }
}
