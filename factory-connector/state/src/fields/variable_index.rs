//! Mapped fields by the variables that their mappings read.

use std::collections::{BTreeSet, HashMap};

use asi_model::messages::ValueSource;
use disclosure::VariableKey;

use super::Field;

/// Numbers of the mapped fields that read each variable.
#[derive(Debug, Default)]
pub(super) struct VariableIndex(HashMap<VariableKey, BTreeSet<i64>>);

impl VariableIndex {
    pub(super) fn of(&self, variable: &VariableKey) -> impl Iterator<Item = i64> {
        self.0.get(variable).into_iter().flatten().copied()
    }

    /// Notes what the mapping of the field's decision reads.
    pub(super) fn note(&mut self, field: &Field) {
        for variable in variables(field) {
            self.0.entry(variable).or_default().insert(field.id());
        }
    }

    /// Forgets what the mapping of the field's decision reads.
    pub(super) fn forget(&mut self, field: &Field) {
        for variable in variables(field) {
            let Some(fields) = self.0.get_mut(&variable) else { continue };
            fields.remove(&field.id());
            if fields.is_empty() {
                self.0.remove(&variable);
            }
        }
    }
}

fn variables(field: &Field) -> impl Iterator<Item = VariableKey> {
    let mapping = field.decision.mapping.as_deref();
    let mapping = mapping.filter(|_| field.decision.is_open_for(ValueSource::Mapping));
    mapping.into_iter().flat_map(|mapping| &mapping.inputs).map(|input| VariableKey {
        source_id: input.source_id.clone(),
        node_id: input.node_id.clone(),
    })
}
