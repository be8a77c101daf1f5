//! Revisions of operation networks: what a new revision or a withdrawal does to requests, fields
//! and writers.

mod fields;

use std::{collections::BTreeSet, sync::Arc};

use asi_model::{
    DateTime, FieldKey, OperationNetworkId, RequestKey,
    difference::{FieldChange, FieldDifference, difference},
    messages::{AcknowledgementResult, GapCause, OperationNetworkMessage, Withdraw},
    network::OperationNetwork,
};
use fields::{add_field, change_field, end_withdrawn_consent, remove_field};

use super::{
    receive::{Answer, acknowledge},
    rules::apply_rules_in,
};
use crate::{
    ChangeSet, ConnectorState, LogRecord, Network, Writer, consents,
    effects::{ConnectorEvent, TwinUpdate},
    endings,
    keep_alive_schedule::schedule_keep_alive,
    writes::NetworkRow,
};

/// Takes a network in a new revision, or a revision that is known already. `json` is the message as
/// it is stored.
pub fn receive_network(
    state: &mut ConnectorState,
    message: OperationNetworkMessage,
    json: String,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    let id = message.operation_network.operation_network_id.clone();
    let (revision, correlation_id) = (message.revision, message.message_id.clone());
    let is_new = is_newer(state, &id, revision);
    if is_new {
        let known = state.networks.get(&id);
        let has_skipped = known.is_some_and(|known| known.revision.saturating_add(1) < revision);
        let former = known.and_then(|known| known.message.clone());
        let former = former.as_deref().map(|former| &former.operation_network);
        let message = Arc::new(message);
        apply(state, &mut changes, former, &message, now);
        if has_skipped {
            consents::confirm(state, &mut changes, &message.operation_network, now);
        }
        let row = NetworkRow {
            operation_network_id: id.clone(),
            revision,
            message: Some(json),
            received_at: now,
        };
        changes.writes.networks.push(row);
        changes.effects.twin.push(TwinUpdate::Apply(id.clone()));
        changes.effects.events.push(ConnectorEvent::Inbox(id.clone()));
        changes.effects.log.push(LogRecord::NetworkReceived { network: id.clone(), revision });
    }
    let network = Some((id.clone(), revision));
    let answer = Answer { correlation_id, network, result: result_of(is_new), faults: Vec::new() };
    acknowledge(state, &mut changes, answer, now);
    if is_new {
        let count = apply_rules_in(state, &mut changes, Some(&id), now);
        if count > 0 {
            changes.effects.log.push(LogRecord::RulesDecided { network: id, field_count: count });
        }
    }
    changes
}

/// Withdraws a network; its revision stays as a tombstone, so that an older revision that arrives
/// late has no effect.
pub fn receive_withdrawal(
    state: &mut ConnectorState,
    message: Withdraw,
    now: DateTime,
) -> ChangeSet {
    let mut changes = ChangeSet::default();
    let (id, revision) = (message.operation_network_id, message.revision);
    let is_new = is_newer(state, &id, revision);
    if is_new {
        if let Some(former) = state.networks.get(&id).and_then(|known| known.message.clone()) {
            withdraw(state, &mut changes, &former.operation_network, now);
        }
        state.networks.put(id.clone(), Network::new(revision, None, now));
        changes.writes.networks.push(NetworkRow {
            operation_network_id: id.clone(),
            revision,
            message: None,
            received_at: now,
        });
        changes.effects.events.push(ConnectorEvent::Inbox(id.clone()));
        changes.effects.log.push(LogRecord::NetworkWithdrawn { network: id.clone(), revision });
    }
    let answer = Answer {
        correlation_id: message.message_id,
        network: Some((id, revision)),
        result: result_of(is_new),
        faults: Vec::new(),
    };
    acknowledge(state, &mut changes, answer, now);
    changes
}

fn is_newer(state: &ConnectorState, id: &OperationNetworkId, revision: u64) -> bool {
    state.networks.get(id).is_none_or(|known| revision > known.revision)
}

const fn result_of(is_new: bool) -> AcknowledgementResult {
    if is_new { AcknowledgementResult::Accepted } else { AcknowledgementResult::Unchanged }
}

fn withdraw(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    network: &OperationNetwork,
    now: DateTime,
) {
    let id = &network.operation_network_id;
    let keys: Vec<FieldKey> = network.fields().map(|(key, ..)| key).collect();
    let before = endings::disclosed(state, keys.iter(), now);
    for (key, ..) in network.fields() {
        end_withdrawn_consent(state, changes, &key);
    }
    for (key, ..) in network.fields() {
        remove_field(state, changes, &key, now);
    }
    state.journals.remove(id);
    for (request, ..) in network.requests() {
        retire_writer(state, changes, &request, now);
    }
    changes.effects.twin.push(TwinUpdate::Remove(id.clone()));
    endings::note(state, changes, before, now);
}

/// Brings fields and writers from the former revision to the new one.
fn apply(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    former: Option<&OperationNetwork>,
    message: &Arc<OperationNetworkMessage>,
    now: DateTime,
) {
    let new = &message.operation_network;
    let empty = OperationNetwork {
        operation_network_id: new.operation_network_id.clone(),
        name: None,
        description: None,
        operation_list: Vec::new(),
        operation_relation_list: Vec::new(),
    };
    let difference = difference(former.unwrap_or(&empty), new);
    let before = endings::disclosed(state, difference.fields.iter().map(|field| &field.key), now);
    let is_removed = |change: FieldChange| change == FieldChange::Removed;
    for field in difference.fields.iter().filter(|field| is_removed(field.change)) {
        end_withdrawn_consent(state, changes, &field.key);
    }
    for request in &difference.requests.removed {
        retire_writer(state, changes, request, now);
    }
    let network = Network::new(message.revision, Some(Arc::clone(message)), now);
    state.networks.put(new.operation_network_id.clone(), network);
    for (request, ..) in new.requests() {
        assign_writer(state, changes, &request, now);
    }
    apply_fields(state, changes, difference.fields, now);
    endings::note(state, changes, before, now);
    for (request, ..) in new.requests() {
        if let Some(writer) = state.writers.id_of(&request) {
            schedule_keep_alive(state, writer);
        }
    }
}

fn apply_fields(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    fields: Vec<FieldDifference>,
    now: DateTime,
) {
    let mut to_refresh: BTreeSet<RequestKey> = BTreeSet::new();
    for field in fields {
        let is_data_set_changed = match field.change {
            FieldChange::Added => {
                add_field(state, changes, &field.key, now);
                false
            }
            FieldChange::Changed => change_field(state, changes, &field, now),
            FieldChange::Removed => {
                let was_mapped = remove_field(state, changes, &field.key, now);
                if let Some(writer) = state.writers.id_of(&field.key.request).filter(|_| was_mapped)
                {
                    // Waiting reports still carry the field's value.
                    changes.purge_unless_purged(writer, GapCause::Withdrawn);
                }
                was_mapped
            }
        };
        if is_data_set_changed {
            to_refresh.insert(field.key.request);
        }
    }
    let writers = to_refresh.iter().filter_map(|request| state.writers.id_of(request));
    changes.to_refresh.extend(writers.map(|writer| (writer, now)));
}

fn assign_writer(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    request: &RequestKey,
    now: DateTime,
) {
    match state.writers.assign(request, now) {
        Ok(Some(id)) => {
            let row = state.writers.get(id).map(Writer::row);
            changes.writes.writers.changed.extend(row.map(|row| (id, row)));
        }
        Ok(None) => {}
        Err(_) => {
            changes.effects.log.push(LogRecord::WriterMissing { request: request.clone() });
        }
    }
}

/// Retires a request's writer and takes its waiting reports back.
fn retire_writer(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    request: &RequestKey,
    now: DateTime,
) {
    let Some(id) = state.writers.retire(request, now) else { return };
    changes.purge(id, GapCause::Withdrawn);
    let row = state.writers.get(id).map(Writer::row);
    changes.writes.writers.changed.extend(row.map(|row| (id, row)));
}
