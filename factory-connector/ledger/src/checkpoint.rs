//! Checkpoints: signed statements of all heads, which reveal the removal of the newest entries.

use asi_model::{DateTime, FactoryId, OrganisationId};
use serde::{Deserialize, Serialize};

use super::Heads;

/// Content of a checkpoint.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct HeadsCheckpoint {
    pub factory_id: FactoryId,
    /// Number of the checkpoint, from 1 without gaps.
    pub number: u64,
    pub recorded_at: DateTime,
    pub heads: Vec<CheckpointHead>,
}

/// The head of one chain.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CheckpointHead {
    /// Organisation of the chain.
    pub recipient: OrganisationId,
    /// Number of its last entry.
    pub number: u64,
    /// Hash of its last entry, hexadecimal.
    pub hash: String,
}

impl HeadsCheckpoint {
    /// Creates a checkpoint over the present heads.
    #[must_use]
    pub fn new(factory_id: FactoryId, number: u64, recorded_at: DateTime, heads: &Heads) -> Self {
        let heads = heads.iter().map(|(recipient, head)| CheckpointHead {
            recipient: recipient.clone(),
            number: head.number,
            hash: hex::encode(head.hash),
        });
        Self { factory_id, number, recorded_at, heads: heads.collect() }
    }

    /// Returns the text that is signed and stored.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("a checkpoint has text keys only")
    }
}
