//! Fields whose values come from a source.

use asi_model::{FieldKey, messages::ValueSource};

use crate::{ConnectorState, FieldDecision};

/// Returns the fields that get no values any more once a source is gone: those that are disclosed
/// and whose mapping reads it, in the order of their keys.
#[must_use]
pub fn fields_of_source(state: &ConnectorState, source_id: &str) -> Vec<FieldKey> {
    let reads = |decision: &FieldDecision| {
        let mut inputs = decision.mapping.iter().flat_map(|mapping| &mapping.inputs);
        decision.is_open_for(ValueSource::Mapping)
            && inputs.any(|input| input.source_id.as_str() == source_id)
    };
    let fields = state.fields.iter().filter(|field| reads(field.decision()));
    let mut keys: Vec<FieldKey> = fields.map(|field| field.key().clone()).collect();
    keys.sort();
    keys
}
