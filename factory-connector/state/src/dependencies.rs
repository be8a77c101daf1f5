//! Dependencies between fields: states of one field in which another field is withheld.

use std::sync::Arc;

use asi_model::{DateTime, FieldKey, FieldName, messages::ValueSource};

use crate::{
    ConnectorState, fields::is_withheld_by, gates::through_gate, queries::fields_named_by,
};

/// Restores the dependencies at the start. States that machines sent are unknown now; states that
/// people and OPC UA clients wrote still hold, since only this connector accepts them.
pub(crate) fn restore(state: &mut ConnectorState, now: DateTime) {
    let depends = |field: &&crate::Field| fields_named_by(field.gate.policy()).next().is_some();
    let keys: Vec<FieldKey> =
        state.fields.iter().filter(depends).map(|field| field.key.clone()).collect();
    for key in keys {
        for other in set(state, &key) {
            let is_from_machine =
                state.fields.get(&key.request.field(other.clone())).is_none_or(|field| {
                    !field.decision.is_mapped() || field.decision.is_open_for(ValueSource::Mapping)
                });
            if let Some(mut field) = state.fields.get_mut(&key).filter(|_| is_from_machine) {
                field.gate.on_state(now, &other, None);
                field.note_deadlines();
            }
        }
    }
}

/// Sets the fields whose states a field's policy looks at, and lets its gate know these states.
pub(crate) fn update(state: &mut ConnectorState, key: &FieldKey, now: DateTime) {
    for other in set(state, key) {
        let Some(field) = state.fields.get(key) else { return };
        let policy = Arc::clone(field.gate.policy());
        let watched = state.fields.get(&key.request.field(other.clone()));
        let is_withheld = watched.and_then(|field| is_withheld_by(field, &other, &policy));
        if let Some(mut field) = state.fields.get_mut(key) {
            field.gate.on_state(now, &other, is_withheld);
        }
    }
    if let Some(mut field) = state.fields.get_mut(key) {
        field.mark_dirty();
    }
}

fn set(state: &mut ConnectorState, key: &FieldKey) -> Vec<FieldName> {
    let Some(field) = state.fields.get(key) else { return Vec::new() };
    let mut others: Vec<FieldName> = fields_named_by(field.gate.policy()).cloned().collect();
    others.sort();
    others.dedup();
    state.fields.depend_on(key, others.iter().cloned());
    others
}

/// Lets the gates that look at a field know its state: it has another value, or none any more.
pub(crate) fn notify(state: &mut ConnectorState, key: &FieldKey, now: DateTime) {
    for dependent in state.fields.dependents_of(key) {
        let Some(policy) =
            state.fields.get(&dependent).map(|field| Arc::clone(field.gate.policy()))
        else {
            continue;
        };
        let is_withheld =
            state.fields.get(key).and_then(|field| is_withheld_by(field, &key.field_name, &policy));
        let Some(mut field) = state.fields.get_mut(&dependent) else { continue };
        if field.gate.on_state(now, &key.field_name, is_withheld) {
            let id = field.id;
            through_gate(state, id, now, |_| ());
        }
    }
}
