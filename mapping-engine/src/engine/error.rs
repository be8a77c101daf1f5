//! Errors of the engine's commands.

use mapping::MappingDiagnostic;
use shop_floor::ShopFloorError;

use crate::dry_run::SAMPLES_MAX;

/// Failure of a command to the engine.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The mapping has errors; all that is to be said about it.
    #[error("the mapping has errors")]
    Rejected(Vec<MappingDiagnostic>),
    /// The engine has as many mappings as allowed.
    #[error("there are {0} mappings already, which is the limit")]
    TooManyMappings(usize),
    /// The workers hold as many scripts as they may.
    #[error("there are {0} scripts already, which is the limit: raise script.workers")]
    TooManyScripts(usize),
    /// More samples than a dry run takes.
    #[error("a dry run takes at most {SAMPLES_MAX} samples")]
    TooManySamples,
    /// The inputs cannot be monitored.
    #[error("the inputs cannot be monitored")]
    Inputs(#[source] ShopFloorError),
    /// The engine has ended.
    #[error("the mapping engine has ended")]
    Stopped,
}
