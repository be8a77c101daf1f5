//! Applying documents, values and decisions, and telling those who listen.

use std::sync::Arc;

use asi_model::{
    DataValue as ModelValue, DateTime, FieldKey, OperationNetworkId, instance::FOLDER_ID,
    messages::MappingState,
};
use opcua_stack::opcua::{
    server::node_manager::MonitoredItemRef,
    types::{AttributeId, DataValue, DateTime as StackTime, StatusCode},
};

use super::{
    difference::{Difference, verb},
    interface::Interface,
    place::Place,
    provider::AsiProvider,
};
use crate::{
    document::{Applied, AsiDocument, FieldRecord},
    events::{AuditWrite, ModelChange, NodeChange},
    provider::NodeProvider as _,
};

/// The attributes of which a removed node's monitored items are told; Value comes first.
const ATTRIBUTES_TOLD: [AttributeId; 9] = [
    AttributeId::Value,
    AttributeId::NodeId,
    AttributeId::NodeClass,
    AttributeId::BrowseName,
    AttributeId::DisplayName,
    AttributeId::Description,
    AttributeId::DataType,
    AttributeId::AccessLevel,
    AttributeId::UserAccessLevel,
];

/// Most nodes whose subscribers are told under one lock.
const TOLD_AT_ONCE_MAX: usize = 10_000;

impl AsiProvider {
    /// Shows a document, as a new interface or in place of the one before.
    pub fn apply(&self, document: AsiDocument) -> Applied {
        let _order = self.publishing.lock();
        let id = document.message.operation_network.operation_network_id.clone();
        let revision = document.message.revision;
        let old = self.interface(id.as_str());
        let sequence =
            old.as_ref().map_or_else(|| self.state.read().last_sequence + 1, |old| old.sequence);
        let mut new = Interface::new(document, sequence, revision);
        let difference = match &old {
            Some(old) => self.difference(old, &new),
            None => self.all_added(&new),
        };
        if let Some(old) = &old {
            keep_versions(old, &mut new, &difference);
        }
        let new = Arc::new(new);
        self.store(id, &new, old.is_none());
        self.tell(&difference, Some(&new));
        if old.is_none() {
            self.tell_folder();
        }
        self.report(&difference, old.is_none().then_some(verb::REFERENCE_ADDED), Some(&new));
        Applied {
            nodes_added: difference.nodes_added,
            nodes_removed: difference.nodes_removed,
            nodes_changed: difference.nodes_changed,
        }
    }

    fn store(&self, id: OperationNetworkId, new: &Arc<Interface>, is_new: bool) {
        let mut state = self.state.write();
        if is_new {
            state.last_sequence = new.sequence;
            state.by_sequence.insert(new.sequence, id.clone());
            state.version = next_version(state.version);
        }
        state.by_id.insert(id, Arc::clone(new));
    }

    /// Takes an interface away.
    pub fn remove_interface(&self, id: &OperationNetworkId) -> bool {
        let _order = self.publishing.lock();
        let removed = {
            let mut state = self.state.write();
            let removed = state.by_id.remove(id);
            if let Some(interface) = &removed {
                state.by_sequence.remove(&interface.sequence);
                state.version = next_version(state.version);
                if state.by_id.capacity() > 4 * state.by_id.len() + 64 {
                    state.by_id.shrink_to_fit();
                }
            }
            removed
        };
        let Some(interface) = removed else { return false };
        let difference = self.all_removed(&interface);
        self.tell(&difference, None);
        self.tell_folder();
        self.report(&difference, Some(verb::REFERENCE_DELETED), None);
        true
    }

    /// Shows newly disclosed values in the order given. Returns how many were shown.
    pub fn publish_values(&self, values: Vec<(FieldKey, ModelValue)>) -> usize {
        let _order = self.publishing.lock();
        let mut shown = 0;
        let mut told = Vec::with_capacity(values.len());
        for (key, value) in values {
            let Some(interface) = self.interface(key.request.operation_network_id.as_str()) else {
                continue;
            };
            let Some(field) = interface.find_key(&key) else { continue };
            let visible = {
                let mut records = interface.records.write();
                let record = &mut records[field as usize];
                if record.mapping_state != MappingState::Mapped {
                    continue;
                }
                record.value = value;
                self.shown(record)
            };
            shown += 1;
            told.push((interface.identifier(Place::Field(field)), visible));
            self.push_state(&interface, field, &mut told);
        }
        self.notify(&told);
        shown
    }

    /// Shows a decision. False where the field does not exist.
    pub fn publish_decision(&self, key: &FieldKey, record: FieldRecord) -> bool {
        let _order = self.publishing.lock();
        let Some(interface) = self.interface(key.request.operation_network_id.as_str()) else {
            return false;
        };
        let Some(field) = interface.find_key(key) else { return false };
        let place = Place::Field(field);
        let identifier = interface.identifier(place);
        let before = self.variables(&interface, place, &identifier);
        let old = std::mem::replace(&mut interface.records.write()[field as usize], record.clone());
        let mut told: Vec<(String, DataValue)> = self
            .variables(&interface, place, &identifier)
            .into_iter()
            .zip(before)
            .filter(|(now, before)| now != before)
            .map(|(now, _)| now)
            .collect();
        self.push_state(&interface, field, &mut told);
        self.notify(&told);
        if (old.mapping_state, old.value_source) != (record.mapping_state, record.value_source) {
            let user = record.decided_by.as_deref().unwrap_or_default();
            self.events.report_write(|| AuditWrite {
                node_id: self.id(format!("{identifier}#MappingState")),
                user: user.to_owned(),
                status: StatusCode::Good,
                old_value: (old.mapping_state as i32).into(),
                new_value: (record.mapping_state as i32).into(),
                message: format!("The field {} was decided.", key.field_name),
            });
        }
        true
    }

    /// A field that says its operation's state also changes the operation.
    fn push_state(&self, interface: &Interface, field: u32, told: &mut Vec<(String, DataValue)>) {
        let operation = interface.slot(interface.field(field).0).operation;
        if interface.field(field).1.semantic == Some(asi_model::network::Semantic::OperationState)
            && interface.state_field(operation) == Some(field)
            && let place = Place::Operation(operation)
            && let Some(value) =
                interface.part(place, "State").and_then(|part| interface.part_value(place, part))
        {
            told.push((format!("{}#State", interface.identifier(place)), value));
        }
    }

    /// Tells items that were just registered the present values; what they were told already is no
    /// change to them.
    pub(super) fn tell_present_values(&self, items: &[&MonitoredItemRef]) {
        let _order = self.publishing.lock();
        let mut notifier = self.subscriptions.data_notifier();
        for item in items.iter().filter(|item| item.attribute() == AttributeId::Value) {
            let present = self.value(item.node_id()).unwrap_or_else(|| DataValue {
                status: Some(StatusCode::BadNodeIdUnknown),
                ..DataValue::default()
            });
            let value = DataValue { server_timestamp: Some(StackTime::now()), ..present };
            if let Some(mut registered) = notifier.notify_for(item.node_id(), AttributeId::Value) {
                registered.data_value_to_item(value, &item.handle());
            }
        }
    }

    /// Pushes values into the monitored items of these variables.
    fn notify(&self, values: &[(String, DataValue)]) {
        let now = StackTime::now();
        // Each notifier holds a lock that publishing needs.
        for chunk in values.chunks(TOLD_AT_ONCE_MAX) {
            let mut notifier = self.subscriptions.data_notifier();
            for (identifier, value) in chunk {
                if let Some(mut items) =
                    notifier.notify_for((self.instances, identifier.as_str()), AttributeId::Value)
                {
                    items.data_value(DataValue { server_timestamp: Some(now), ..value.clone() });
                }
            }
        }
    }

    fn tell(&self, difference: &Difference, new: Option<&Interface>) {
        let gone = DataValue {
            status: Some(StatusCode::BadNodeIdUnknown),
            server_timestamp: Some(StackTime::now()),
            ..DataValue::default()
        };
        for objects in difference.gone.chunks(TOLD_AT_ONCE_MAX) {
            self.tell_gone(objects, &ATTRIBUTES_TOLD, &gone);
        }
        // Of a property only the value is worth monitoring.
        for parts in difference.gone_parts.chunks(TOLD_AT_ONCE_MAX) {
            self.tell_gone(parts, &ATTRIBUTES_TOLD[..1], &gone);
        }
        self.notify(&difference.changed);
        let Some(new) = new else { return };
        let versions: Vec<(String, DataValue)> = Self::changed_containers(difference)
            .into_iter()
            .map(|id| format!("{id}#NodeVersion"))
            .map(|id| (id, DataValue::new_now(new.message.revision.to_string())))
            .collect();
        self.notify(&versions);
    }

    fn tell_gone(&self, identifiers: &[String], attributes: &[AttributeId], gone: &DataValue) {
        let mut notifier = self.subscriptions.data_notifier();
        for identifier in identifiers {
            for &attribute in attributes {
                if let Some(mut items) =
                    notifier.notify_for((self.instances, identifier.as_str()), attribute)
                {
                    items.data_value(gone.clone());
                }
            }
        }
    }

    fn tell_folder(&self) {
        let version = self.state.read().version.to_string();
        self.notify(&[(format!("{FOLDER_ID}#NodeVersion"), DataValue::new_now(version))]);
    }

    /// Reports model change and audit events, if anybody listens.
    fn report(&self, difference: &Difference, folder: Option<u8>, new: Option<&Interface>) {
        if difference.affected.is_empty() || !self.events.is_listened_to() {
            return;
        }
        let mut changes: Vec<NodeChange> = difference
            .affected
            .iter()
            .map(|(identifier, affected)| NodeChange {
                node_id: self.id(identifier.clone()),
                type_id: self.affected_type(*affected),
                verbs: affected.verbs,
            })
            .collect();
        self.events.report_nodes(&changes, verb::NODE_ADDED, verb::NODE_DELETED);
        if let Some(verbs) = folder {
            let type_id = super::types::folder_type();
            changes
                .insert(0, NodeChange { node_id: self.id(FOLDER_ID.to_owned()), type_id, verbs });
        }
        let what = match (folder, new) {
            (Some(_), Some(_)) => "An Activity Status Interface was added.",
            (Some(_), None) => "An Activity Status Interface was removed.",
            _ => "An Activity Status Interface was changed.",
        };
        self.events.report_model_change(ModelChange { changes, message: what });
    }
}

/// NodeVersions of what a revision did not touch stay.
fn keep_versions(old: &Interface, new: &mut Interface, difference: &Difference) {
    let changed = AsiProvider::changed_containers(difference);
    let before: std::collections::HashMap<String, Place> =
        old.places().into_iter().map(|place| (old.identifier(place), place)).collect();
    let kept: Vec<(Place, u64)> = new
        .places()
        .into_iter()
        .filter_map(|place| {
            let identifier = new.identifier(place);
            let earlier = before.get(&identifier)?;
            let version = old.version(*earlier);
            (!changed.contains(identifier.as_str()) && version != new.base_version)
                .then_some((place, version))
        })
        .collect();
    new.versions.extend(kept);
}

/// A version that is higher than the one before, over restarts too.
fn next_version(version: u64) -> u64 {
    let now = DateTime::from(std::time::SystemTime::now());
    (version + 1).max(u64::from(now.version_time()))
}
