//! Data that the engine and its consumer exchange: mappings to publish, and the candidates they
//! yield.

use std::sync::Arc;

use asi_model::DataValue;

use crate::{document::Mapping, state::TransformState};

/// Key that the consumer gives the field of a mapping. It comes back with each of the mapping's
/// candidates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct TargetKey {
    /// Number of the field.
    pub field: i64,
    /// Number of the mapping's version, which tells its candidates from those of a former one.
    pub version: u32,
}

/// Value for the disclosure gate.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The field that may get the value.
    pub target: TargetKey,
    /// Value, status and times. Of the field's type, or without value and Bad.
    pub value: DataValue,
    /// State of the functions after this value; to be committed with it. `None` where there is no
    /// state, or a later candidate of the same batch carries it.
    pub state: Option<TransformState>,
}

/// Mapping to publish, with the state of a former run.
#[derive(Debug, Clone, PartialEq)]
pub struct PublishRequest {
    /// The mapping, shared with its owner.
    pub mapping: Arc<Mapping>,
    /// Comes back with each candidate.
    pub target: TargetKey,
    /// State of the functions after the last committed candidate.
    pub state: Option<TransformState>,
    /// The last candidate; it is the last usable value until the source gives a new one.
    pub last: Option<DataValue>,
    /// A shadow mapping runs on live values for its status only: it yields no candidates.
    pub is_shadow: bool,
    /// True where a mapping that runs already goes on, if it is this one with this target: its state is then newer
    /// than `state`. It yields nothing twice: the consumer keeps the candidates that it has not committed.
    pub goes_on: bool,
}

impl PublishRequest {
    /// Returns a request for a published mapping without former state.
    #[must_use]
    pub fn new(mapping: impl Into<Arc<Mapping>>, target: TargetKey) -> Self {
        Self {
            mapping: mapping.into(),
            target,
            state: None,
            last: None,
            is_shadow: false,
            goes_on: false,
        }
    }
}
