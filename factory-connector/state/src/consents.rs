//! Consents: each decision is stored, entered in the ledger and sent to the partner.

use std::collections::HashSet;

use asi_model::{
    DateTime, FieldKey,
    messages::{Decision, DecisionTarget, FactoryMessage, GapCause, MappingState, ValueSource},
    network::OperationNetwork,
};
use disclosure::DecisionBasis;
use ledger::{Event, basis_for_recipients};

use crate::{
    ChangeSet, ConnectorState,
    change_set::{EndedConsents, EndedWriter, Ending},
    dependencies,
    effects::EngineCommand,
    fields::{basis_json, policy_json},
    queries::effective_policy,
    writes::ConsentRow,
};

/// Records the decision about a field: in the store, in the ledger, for the partner, for the twin
/// and for open pages.
pub(crate) fn record(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    now: DateTime,
) {
    // Of this consent only: what follows from it later was not seen in the preview.
    let preview = state
        .fields
        .get_mut(key)
        .and_then(|mut field| field.change_decision(|decision| decision.basis.preview.take()));
    let Some(field) = state.fields.get(key) else { return };
    let decision = field.decision();
    let (_, policies) =
        effective_policy(state, field, &decision.policy, decision.basis.policy_id.as_ref());
    let mut basis = DecisionBasis { policies, preview, ..decision.basis.clone() };
    if basis.names_documents() {
        basis.salt = Some(hex::encode(state.ids.next_salt()));
    }
    let decided_at = decision.decided_at.unwrap_or(now);
    let policy = field.gate().policy();
    changes.writes.fields.consents.push(ConsentRow {
        field: key.to_string(),
        version: decision.version,
        mapping_state: decision.mapping_state,
        value_source: decision.value_source,
        policy: policy_json(policy),
        basis: basis_json(&basis),
        reason: decision.reason.clone(),
        decided_by: decision.decided_by.clone(),
        decided_at: now,
    });
    let event = Event::Consent {
        field: key.clone(),
        version: decision.version,
        mapping_state: decision.mapping_state,
        value_source: decision.value_source,
        policy: (**policy).clone(),
        decided_by: decision.decided_by.clone(),
        basis: Some(basis).filter(|basis| !basis.is_empty()).as_ref().map(basis_for_recipients),
    };
    changes.put_field(field);
    changes.count_decision(field);
    send_decision(state, changes, key, decided_at, now);
    let recipients = state.networks.recipients(&key.request);
    state.ledger.append(&mut changes.writes.ledger, recipients, now, None, &event);
    if let Some(mut field) = state.fields.get_mut(key) {
        field.mark_dirty();
    }
}

/// Tells the platform again what holds about the fields of a network, but for those of which the
/// change set tells it. Between two revisions that arrived here there may have been one that was
/// rejected: the platform took back what that one would have taken back.
pub(crate) fn confirm(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    network: &OperationNetwork,
    now: DateTime,
) {
    let stated: HashSet<&str> =
        changes.writes.fields.consents.iter().map(|consent| consent.field.as_str()).collect();
    let in_force = network.fields().filter_map(|(key, ..)| {
        let decision = state.fields.get(&key)?.decision();
        let decided_at = decision.decided_at?;
        let is_decided = decision.mapping_state != MappingState::Pending;
        (is_decided && !stated.contains(key.to_string().as_str())).then_some((key, decided_at))
    });
    let in_force: Vec<(FieldKey, DateTime)> = in_force.collect();
    for (key, decided_at) in in_force {
        send_decision(state, changes, &key, decided_at, now);
    }
}

/// Sends the decision about a field to the platform.
fn send_decision(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    decided_at: DateTime,
    now: DateTime,
) {
    let Some(field) = state.fields.get(key) else { return };
    let decision = field.decision();
    let message = Decision {
        message_id: state.ids.next_message_id(),
        factory_id: state.config.factory_id.clone(),
        target: DecisionTarget::Field {
            operation_network_id: key.request.operation_network_id.clone(),
            operation_id: key.request.operation_id.clone(),
            dynamic_data_request_id: key.request.dynamic_data_request_id.clone(),
            field_name: key.field_name.clone(),
        },
        mapping_state: decision.mapping_state,
        reason: decision.reason.clone(),
        decided_at,
        disclosure: field.statement().map(Box::new),
    };
    state.send(changes, &FactoryMessage::Decision(message), None, now);
}

/// States in a receipt that the consent to a mapped field ends. To be called while request and
/// writer are still as they were.
pub(crate) fn end(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    consent_version: u32,
    ending: Ending<'_>,
) {
    let Some(id) = state.writers.id_of(&key.request) else { return };
    let Some(writer) = state.writers.get(id) else { return };
    // A writer that ends twice is stated as it was at the first end.
    let known = changes.ended.iter().find_map(|ended| ended.writers.get(&id)).cloned();
    let ended = known.unwrap_or_else(|| EndedWriter {
        epoch: writer.epoch(),
        next_sequence: writer.next_sequence(),
        request: key.request.clone(),
        recipients: state.networks.recipients(&key.request).to_vec(),
    });
    if !changes.ended.last().is_some_and(|last| last.continues(ending)) {
        changes.ended.push(EndedConsents::new(state.ids.next_uuid(), ending));
    }
    if let Some(last) = changes.ended.last_mut() {
        last.push(key.clone(), consent_version, id, ended);
    }
}

/// Takes a decision back that the partner's revision no longer allows: the field is undecided, its
/// mapping is retained and suggested again.
pub(crate) fn reopen(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    reason: &str,
    now: DateTime,
) {
    let Some(field) = state.fields.get(key) else { return };
    let (was_mapped, writer, version) =
        (field.decision().is_mapped(), field.writer(), field.decision().version);
    if was_mapped {
        let ending = Ending {
            cause: GapCause::Revoked,
            reason: Some(reason),
            revoked_by: None,
            is_joint: false,
        };
        end(state, changes, key, version, ending);
        changes.purge(writer, GapCause::Revoked);
    }
    close(state, changes, key, reason, now);
}

/// Closes a field's gate and makes the field undecided, for a reason that the partner reads.
pub(crate) fn close(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    reason: &str,
    now: DateTime,
) {
    let Some(mut field) = state.fields.get_mut(key) else { return };
    if field.decision().is_open_for(ValueSource::Mapping) {
        changes.effects.engine.push(EngineCommand::Remove(field.mapping_id()));
    }
    field.close(now);
    field.change_decision(|decision| decision.reopen(reason, now));
    dependencies::notify(state, key, now);
    record(state, changes, key, now);
}

/// Stores the mapping in force as the field's next version, unless it is the newest already.
pub(crate) fn record_version(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    key: &FieldKey,
    (author, note): (Option<String>, Option<String>),
    now: DateTime,
) {
    let Some(mut field) = state.fields.get_mut(key) else { return };
    let Some((version, mapping)) = field.next_version() else { return };
    changes.writes.mappings.versions.push(crate::writes::VersionRow {
        field_id: field.id(),
        version,
        mapping: crate::fields::mapping_json(&mapping),
        author,
        note,
        published_at: now,
    });
}
