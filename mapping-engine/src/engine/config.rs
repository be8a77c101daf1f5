//! Limits of the engine.

use serde::{Deserialize, Serialize};

use super::history::HistoryConfig;
use crate::script::config::ScriptConfig;

/// Limits of the engine and of its parts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", default, deny_unknown_fields)]
pub struct MappingEngineConfig {
    /// Most mappings, shadow mappings included.
    pub mappings_max: usize,
    /// Most candidates that wait for the consumer before no more changes are taken.
    pub waiting_candidates_max: usize,
    /// Most batches of candidates in the channel to the consumer.
    pub waiting_batches_max: usize,
    /// Recorded values that dry runs use.
    pub history: HistoryConfig,
    /// Script workers and the budget of a script.
    pub script: ScriptConfig,
}

impl Default for MappingEngineConfig {
    fn default() -> Self {
        Self {
            mappings_max: 200_000,
            waiting_candidates_max: 65_536,
            waiting_batches_max: 64,
            history: HistoryConfig::default(),
            script: ScriptConfig::default(),
        }
    }
}
