//! Dependencies between fields: states of one field in which another field is withheld.

use std::sync::Arc;

use asi_model::{DataValue, DateTime, FieldKey, FieldName, messages::ValueSource};

use crate::{
    ConnectorState, Field,
    fields::{is_withheld_by, is_withheld_in},
    gates::through_gate,
    queries::fields_named_by,
};

/// Restores the dependencies at the start. States that machines sent are unknown now; states that
/// people and OPC UA clients wrote still hold, since only this connector accepts them.
pub(crate) fn restore(state: &mut ConnectorState, now: DateTime) {
    let depends = |field: &&Field| fields_named_by(field.gate().policy()).next().is_some();
    let fields = state.fields.iter().filter(depends);
    let fields: Vec<(i64, FieldKey)> =
        fields.map(|field| (field.id(), field.key().clone())).collect();
    for (id, key) in fields {
        for other in set(state, &key) {
            let is_from_machine =
                state.fields.get(&key.request.field(other.clone())).is_none_or(|watched| {
                    let decision = watched.decision();
                    !decision.is_mapped() || decision.is_open_for(ValueSource::Mapping)
                });
            if is_from_machine {
                through_gate(state, id, now, |gate| gate.forget_state(now, &other));
            }
        }
    }
}

/// Sets the fields whose states a field's policy looks at, and lets its gate know these states.
pub(crate) fn update(state: &mut ConnectorState, key: &FieldKey, now: DateTime) {
    for other in set(state, key) {
        let Some(field) = state.fields.get(key) else { return };
        let (id, policy) = (field.id(), Arc::clone(field.gate().policy()));
        let watched = state.fields.get(&key.request.field(other.clone()));
        let is_withheld = watched.and_then(|field| is_withheld_by(field, &other, &policy));
        through_gate(state, id, now, |gate| gate.on_state(now, &other, is_withheld));
    }
}

fn set(state: &mut ConnectorState, key: &FieldKey) -> Vec<FieldName> {
    let Some(field) = state.fields.get(key) else { return Vec::new() };
    let mut others: Vec<FieldName> = fields_named_by(field.gate().policy()).cloned().collect();
    others.sort();
    others.dedup();
    state.fields.depend_on(key, others.iter().cloned());
    others
}

/// Returns true where a value of a field withholds any of the fields that look at its state.
pub(crate) fn is_withholding(state: &ConnectorState, key: &FieldKey, value: &DataValue) -> bool {
    state.fields.dependents_of(key).iter().any(|dependent| {
        state.fields.get(dependent).is_some_and(|field| {
            is_withheld_in(value, &key.field_name, field.gate().policy()) != Some(false)
        })
    })
}

/// Lets gates know a state that comes with other values, before these are judged: the state that
/// withholds, and (unless one of the same batch withholds) the first one that is known.
pub(crate) fn announce(
    state: &mut ConnectorState,
    key: &FieldKey,
    value: &DataValue,
    is_any_withholding: bool,
    now: DateTime,
) {
    let name = &key.field_name;
    for dependent in state.fields.dependents_of(key) {
        let Some(field) = state.fields.get(&dependent) else { continue };
        let is_withheld = is_withheld_in(value, name, field.gate().policy());
        let is_unknown = field.gate().known_state(name).is_none();
        if is_withheld != Some(false) || (!is_any_withholding && is_unknown) {
            let id = field.id();
            through_gate(state, id, now, |gate| gate.on_state(now, name, is_withheld));
        }
    }
}

/// Lets the gates that look at a field know its state: it has another value, or none any more.
pub(crate) fn notify(state: &mut ConnectorState, key: &FieldKey, now: DateTime) {
    let other = &key.field_name;
    for dependent in state.fields.dependents_of(key) {
        let Some(field) = state.fields.get(&dependent) else { continue };
        let policy = field.gate().policy();
        let watched = state.fields.get(key);
        let is_withheld = watched.and_then(|watched| is_withheld_by(watched, other, policy));
        // Most values of a watched field change nothing for the gates that look at it.
        if field.gate().known_state(other) != is_withheld {
            let id = field.id();
            through_gate(state, id, now, |gate| gate.on_state(now, other, is_withheld));
        }
    }
}
