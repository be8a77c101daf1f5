//! Commands that handles send to the engine's task.

use std::sync::Arc;

use asi_model::DataValue;
use mapping::{Mapping, MappingId, MappingInput, TargetKey, TransformState, transform::Plan};
use tokio::sync::oneshot;

use super::{
    error::EngineError,
    recording::VariableRecording,
    status::MappingStatus,
    survey::{MappingHealth, MappingSurvey},
};
use crate::dry_run::DryRunSample;

/// MappingCommand with the sender of its reply.
#[derive(Debug)]
pub(super) enum MappingCommand {
    Put(Vec<Compiled>, oneshot::Sender<Vec<Result<(), EngineError>>>),
    Remove(MappingId, oneshot::Sender<bool>),
    Status(MappingId, oneshot::Sender<Option<MappingStatus>>),
    Survey(Option<MappingHealth>, usize, oneshot::Sender<MappingSurvey>),
    Reset(MappingId, oneshot::Sender<bool>),
    Recorded(Vec<MappingInput>, oneshot::Sender<Vec<DryRunSample>>),
    Recordings(usize, oneshot::Sender<Vec<VariableRecording>>),
}

/// [`mapping::PublishRequest`] whose mapping has no errors, with its plan.
#[derive(Debug)]
pub(super) struct Compiled {
    pub mapping: Arc<Mapping>,
    pub plan: Arc<Plan>,
    pub target: TargetKey,
    pub state: Option<TransformState>,
    pub last: Option<DataValue>,
    pub is_shadow: bool,
    pub goes_on: bool,
}
