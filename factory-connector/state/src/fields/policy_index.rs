//! Mapped fields by the named policy of their decision.

use std::collections::{BTreeSet, HashMap};

use disclosure::DocumentId;

use super::Field;

/// Numbers of the mapped fields under each named policy.
#[derive(Debug, Default)]
pub(super) struct PolicyIndex(HashMap<DocumentId, BTreeSet<i64>>);

impl PolicyIndex {
    pub(super) fn of(&self, id: &DocumentId) -> impl Iterator<Item = i64> {
        self.0.get(id).into_iter().flatten().copied()
    }

    /// Notes the policy that the field's decision names.
    pub(super) fn note(&mut self, field: &Field) {
        if let Some(id) = field.decision.named_policy() {
            self.0.entry(id.clone()).or_default().insert(field.id());
        }
    }

    /// Forgets the policy that the field's decision names.
    pub(super) fn forget(&mut self, field: &Field) {
        let Some(id) = field.decision.named_policy() else { return };
        let Some(fields) = self.0.get_mut(id) else { return };
        fields.remove(&field.id());
        if fields.is_empty() {
            self.0.remove(id);
        }
    }
}
