//! Mapped fields by the variables that their mappings read.

use std::{
    collections::{BTreeSet, hash_map::RandomState},
    hash::BuildHasher,
};

use asi_model::messages::ValueSource;
use disclosure::VariableKey;
use mapping::MappingInput;

use super::Field;

/// Pairs of the hash of a variable and the number of a mapped field that reads it. They take 16 bytes
/// a variable, where keys with the ids of nodes would take as much as the mappings.
#[derive(Debug, Default)]
pub(super) struct VariableIndex {
    hasher: RandomState,
    readers: BTreeSet<(u64, i64)>,
}

impl VariableIndex {
    /// Returns the numbers of the fields that read a variable, and of those of another variable with
    /// the same hash, if there should be one: the caller asks [`reads`].
    pub(super) fn readers(&self, variable: &VariableKey) -> impl Iterator<Item = i64> {
        let hash = self.hasher.hash_one((&variable.source_id, &variable.node_id));
        self.readers.range((hash, i64::MIN)..=(hash, i64::MAX)).map(|(_, id)| *id)
    }

    /// Notes what the mapping of the field's decision reads.
    pub(super) fn note(&mut self, field: &Field) {
        for input in inputs(field) {
            let hash = self.hasher.hash_one((&input.source_id, &input.node_id));
            self.readers.insert((hash, field.id()));
        }
    }

    /// Forgets what the mapping of the field's decision reads.
    pub(super) fn forget(&mut self, field: &Field) {
        for input in inputs(field) {
            let hash = self.hasher.hash_one((&input.source_id, &input.node_id));
            self.readers.remove(&(hash, field.id()));
        }
    }
}

/// Returns true where the mapping of the field's decision reads a variable.
pub(super) fn reads(field: &Field, variable: &VariableKey) -> bool {
    inputs(field)
        .any(|input| input.source_id == variable.source_id && input.node_id == variable.node_id)
}

fn inputs(field: &Field) -> impl Iterator<Item = &MappingInput> {
    let mapping = field.decision.mapping.as_deref();
    let mapping = mapping.filter(|_| field.decision.is_open_for(ValueSource::Mapping));
    mapping.into_iter().flat_map(|mapping| &mapping.inputs)
}
