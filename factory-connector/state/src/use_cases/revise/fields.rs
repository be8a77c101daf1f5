//! Fields that a revision adds, changes or removes.

use asi_model::{
    DateTime, FieldKey,
    difference::{ConsentEffect, FieldDifference, MappingEffect},
    messages::{GapCause, MappingState},
};

use crate::{
    ChangeSet, ConnectorState, Field, Validity, change_set::Ending, consents, dependencies,
    effects::EngineCommand,
};

/// Reason that a partner reads when its revision asks for more than was consented to.
const REQUEST_CHANGED: &str = "The partner changed the request.";
/// Reason that the receipt states when a partner does not ask for a field any more.
const REQUEST_WITHDRAWN: &str = "The partner withdrew the request.";

/// Adds an undecided field.
pub(super) fn add_field(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    now: DateTime,
) {
    let definition = state.networks.definition(key).cloned();
    let (Some(definition), Some(writer)) = (definition, state.writers.id_of(&key.request)) else {
        return;
    };
    let validity = validity_of(state, key);
    let id_and_key = (state.fields.next_id(), key.clone());
    let field = Field::new(id_and_key, definition, validity, writer, now);
    changes.writes.fields.decided.insert(field.id(), field.row());
    state.fields.insert(field);
    if let Some(mut field) = state.fields.get_mut(key) {
        field.mark_dirty();
    }
}

/// Changes a field as its request now states it. Returns true where the data set of the request
/// changes.
pub(super) fn change_field(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    difference: &FieldDifference,
    now: DateTime,
) -> bool {
    let key = &difference.key;
    let Some(definition) = state.networks.definition(key).cloned() else { return false };
    let validity = validity_of(state, key);
    let Some(mut field) = state.fields.get_mut(key) else {
        add_field(state, changes, key, now);
        return false;
    };
    let was_mapped = field.decision().is_mapped();
    field.change_definition(definition, validity, now);
    if difference.mapping == MappingEffect::Suggested {
        field.set_transform(None);
    }
    if difference.consent == ConsentEffect::Kept {
        field.mark_dirty();
        changes.writes.fields.decided.insert(field.id(), field.row());
    } else if field.decision().mapping_state != MappingState::Pending {
        consents::reopen(state, changes, key, REQUEST_CHANGED, now);
    }
    was_mapped
}

/// Removes a field. Returns true where the data set of its request changes.
pub(super) fn remove_field(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    now: DateTime,
) -> bool {
    let Some(field) = state.fields.remove(key) else { return false };
    dependencies::notify(state, key, now);
    changes.writes.remove_field(field.id());
    let engine = &mut changes.effects.engine;
    if field.versions().shadow.is_some() {
        engine.push(EngineCommand::Remove(field.shadow_id()));
    }
    if field.decision().mapping.is_some() {
        engine.push(EngineCommand::Remove(field.mapping_id()));
    }
    field.decision().is_mapped()
}

/// Ends the consent to a mapped field that the partner does not ask for any more.
pub(super) fn end_withdrawn_consent(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
) {
    let decision = state.field(key).map(Field::decision);
    let Some(decision) = decision.filter(|decision| decision.is_mapped()) else { return };
    let version = decision.version;
    let ending = Ending {
        cause: GapCause::Withdrawn,
        reason: Some(REQUEST_WITHDRAWN),
        revoked_by: None,
        is_joint: false,
    };
    consents::end(state, changes, key, version, ending);
}

fn validity_of(state: &ConnectorState, key: &FieldKey) -> Validity {
    state.request(&key.request).map_or_else(Validity::default, |(_, request)| request.into())
}
