//! Signed statements of all heads, so that not even the newest entries can be cut off unnoticed.

use asi_model::{DateTime, FactoryId, OrganisationId};
use serde::{Deserialize, Serialize};

use super::Heads;

/// What a checkpoint states.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Checkpoint {
    /// Whose ledger.
    pub factory_id: FactoryId,
    /// Its place, from 1 without gaps.
    pub number: u64,
    /// When.
    pub recorded_at: DateTime,
    /// The heads of all chains.
    pub heads: Vec<CheckpointHead>,
}

/// The head of one chain.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CheckpointHead {
    /// Whose chain.
    #[schema(value_type = String)]
    pub recipient: OrganisationId,
    /// The number of its last entry.
    pub number: u64,
    /// The hash of its last entry, hexadecimal.
    pub hash: String,
}

impl Checkpoint {
    /// A checkpoint over the heads as they stand.
    #[must_use]
    pub fn new(factory_id: FactoryId, number: u64, recorded_at: DateTime, heads: &Heads) -> Self {
        let heads = heads.iter().map(|(recipient, head)| CheckpointHead {
            recipient: recipient.clone(),
            number: head.number,
            hash: hex::encode(head.hash),
        });
        Self { factory_id, number, recorded_at, heads: heads.collect() }
    }

    /// The text that is signed and stored.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("a checkpoint has text keys only")
    }
}
