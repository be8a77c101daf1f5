//! Ends of disclosures: what was disclosed of fields before a change and is not any more after it.

use std::collections::BTreeSet;

use asi_model::{DateTime, FieldKey};

use crate::{
    ChangeSet, ConnectorState, Field, FormerDisclosure, former_disclosures::HOUR, queries::use_of,
};

/// Returns what is disclosed of these fields, and of those that their states withhold: these rest on
/// the same variables.
pub(crate) fn disclosed<'k>(
    state: &ConnectorState,
    keys: impl Iterator<Item = &'k FieldKey>,
    now: DateTime,
) -> Vec<FormerDisclosure> {
    let mut concerned: BTreeSet<FieldKey> = BTreeSet::new();
    for key in keys.filter(|key| is_mapped(state, key)) {
        concerned.extend(state.fields.dependents_of(key));
        concerned.insert(key.clone());
    }
    let fields = concerned.iter().filter_map(|key| state.field(key));
    fields.filter_map(|field| disclosure_of(state, field, now)).collect()
}

/// Notes what ended of the disclosures from before a change, and forgets what ended long ago.
pub(crate) fn note(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    before: Vec<FormerDisclosure>,
    now: DateTime,
) {
    if before.is_empty() {
        return;
    }
    for former in before {
        let field = state.fields.by_id(former.used.field);
        let present = field.and_then(|field| disclosure_of(state, field, now));
        if present.is_none_or(|present| !present.is_of_same(&former)) {
            changes.writes.fields.former.push(state.former.note(former));
        }
    }
    let period = state.policies.longest_period().max(HOUR);
    changes.writes.fields.forgotten.extend(state.former.forget(period, now));
}

fn is_mapped(state: &ConnectorState, key: &FieldKey) -> bool {
    state.field(key).is_some_and(|field| field.decision().is_mapped())
}

fn disclosure_of(state: &ConnectorState, field: &Field, now: DateTime) -> Option<FormerDisclosure> {
    Some(FormerDisclosure {
        key: field.key().clone(),
        semantic: field.definition().semantic.clone(),
        used: use_of(state, field)?,
        ended_at: now,
    })
}
