//! Dependencies between fields of a request: a policy may withhold a field while another field is
//! in a certain state.

use std::collections::{BTreeSet, HashMap};

use asi_model::{DataValue, FieldKey, FieldName};
use disclosure::DisclosurePolicy;

use super::Field;

/// Fields by the states that their gates look at, in both directions.
#[derive(Debug, Default)]
pub(super) struct Dependents {
    /// Dependent fields, by the field on whose state they depend.
    of: HashMap<FieldKey, BTreeSet<FieldKey>>,
    /// Fields that are depended on, by the dependent field: its conditions are replaced without a
    /// scan of all others.
    on: HashMap<FieldKey, Vec<FieldKey>>,
}

impl Dependents {
    pub(super) fn of(&self, key: &FieldKey) -> Vec<FieldKey> {
        self.of.get(key).into_iter().flatten().cloned().collect()
    }

    pub(super) fn has(&self, key: &FieldKey) -> bool {
        self.of.contains_key(key)
    }

    pub(super) fn set(&mut self, key: &FieldKey, others: BTreeSet<FieldKey>) {
        self.remove(key);
        for other in &others {
            self.of.entry(other.clone()).or_default().insert(key.clone());
        }
        if !others.is_empty() {
            self.on.insert(key.clone(), others.into_iter().collect());
        }
    }

    pub(super) fn remove(&mut self, key: &FieldKey) {
        for other in self.on.remove(key).unwrap_or_default() {
            if let Some(dependents) = self.of.get_mut(&other) {
                dependents.remove(key);
                if dependents.is_empty() {
                    self.of.remove(&other);
                }
            }
        }
    }
}

/// Returns whether the state of `field`, called `name`, withholds values under a policy; `None`
/// where the state is unknown.
pub(crate) fn is_withheld_by(
    field: &Field,
    name: &FieldName,
    policy: &DisclosurePolicy,
) -> Option<bool> {
    let value = field.newest().filter(|_| field.decision().is_mapped())?;
    is_withheld_in(value, name, policy)
}

/// Returns whether a value of the field called `name` withholds values under a policy; `None` where
/// that cannot be determined.
pub(crate) fn is_withheld_in(
    value: &DataValue,
    name: &FieldName,
    policy: &DisclosurePolicy,
) -> Option<bool> {
    let mut is_any = false;
    for condition in
        policy.withhold_while.iter().filter(|condition| condition.field.as_ref() == Some(name))
    {
        is_any |= condition.is_met_by(value)?;
    }
    Some(is_any)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::field;

    #[test]
    fn replaced_and_removed_conditions_leave_nothing_behind() {
        let mut dependents = Dependents::default();
        let (made, note, state) = (field("made"), field("note"), field("state"));
        dependents.set(&made, [note.clone(), state.clone()].into());
        dependents.set(&note, [state.clone()].into());
        assert_eq!(dependents.of(&state), [made.clone(), note.clone()]);
        dependents.set(&made, [note.clone()].into());
        assert_eq!(dependents.of(&state), std::slice::from_ref(&note));
        dependents.remove(&made);
        dependents.remove(&note);
        assert!(dependents.of.is_empty() && dependents.on.is_empty());
    }
}
