//! Updates: documents, values and decisions are stored and published to subscribers.

use std::{collections::HashMap, sync::Arc};

use asi_model::{FieldKey, OperationNetworkId, instance::FOLDER_ID, messages::MappingState};
use disclosure::Released;
use opcua_stack::opcua::{
    server::node_manager::MonitoredItemRef,
    types::{AttributeId, DataValue, StatusCode},
};

use super::{
    difference::{Difference, verb},
    interface::Interface,
    node_address::NodeAddress,
    provider::AsiProvider,
};
use crate::{
    clock,
    document::{AppliedDocument, AsiDocument, FieldRecord},
    events::{AuditWrite, ModelChange, NodeChange},
    provider::NodeProvider as _,
};

/// Attributes whose monitored items are notified when a node is removed; Value is the first.
const NOTIFIED_ATTRIBUTES: [AttributeId; 9] = [
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

/// Most nodes whose subscribers are notified under one lock. Reads and publishing of all sessions
/// wait for the lock.
const NOTIFIED_AT_ONCE_MAX: usize = 10_000;

impl AsiProvider {
    /// Shows a document, as a new interface or as the new state of an existing one.
    pub fn apply(&self, document: AsiDocument) -> AppliedDocument {
        let _order = self.publishing.lock();
        let id = document.message.operation_network.operation_network_id.clone();
        let revision = document.message.revision;
        let old = self.interface(id.as_str());
        let sequence =
            old.as_ref().map_or_else(|| self.interfaces.read().next_sequence(), |old| old.sequence);
        let mut new = Interface::new(document, sequence, revision);
        let difference = match &old {
            Some(old) => Difference::between(&self.values, old, &new),
            None => Difference::all_added(&new),
        };
        if let Some(old) = &old {
            carry_versions(old, &mut new, &difference);
        }
        let new = Arc::new(new);
        self.interfaces.write().put(id, &new);
        self.publish(&difference, Some(&new));
        if old.is_none() {
            self.publish_folder_version();
        }
        self.report(&difference, old.is_none().then_some(verb::REFERENCE_ADDED), Some(&new));
        AppliedDocument {
            nodes_added: difference.nodes_added,
            nodes_removed: difference.nodes_removed,
            nodes_changed: difference.nodes_changed,
        }
    }

    /// Removes an interface. False when it does not exist.
    pub fn remove_interface(&self, id: &OperationNetworkId) -> bool {
        let _order = self.publishing.lock();
        let Some(interface) = self.interfaces.write().remove(id) else { return false };
        let difference = Difference::all_removed(&interface);
        self.publish(&difference, None);
        self.publish_folder_version();
        self.report(&difference, Some(verb::REFERENCE_DELETED), None);
        true
    }

    /// Shows newly released values in the order given. Returns how many were shown.
    pub fn publish_values(&self, values: Vec<(FieldKey, Released)>) -> usize {
        let _order = self.publishing.lock();
        let mut shown = 0;
        let mut changed = Vec::with_capacity(values.len());
        for (key, value) in values {
            let Some(interface) = self.interface(key.request.operation_network_id.as_str()) else {
                continue;
            };
            let Some(field) = interface.find_key(&key) else { continue };
            let visible = {
                let mut records = interface.records.write();
                let record = &mut records[field as usize];
                // A decision that came meanwhile has closed the field; its value must not appear
                // again.
                if record.mapping_state != MappingState::Mapped {
                    continue;
                }
                record.value = Some(value);
                self.values.field(record)
            };
            shown += 1;
            changed.push((interface.identifier(NodeAddress::Field(field)), visible));
            push_state(&interface, field, &mut changed);
        }
        self.notify(&changed);
        shown
    }

    /// Shows a decision. False when the field does not exist.
    pub fn publish_decision(&self, key: &FieldKey, record: FieldRecord) -> bool {
        let _order = self.publishing.lock();
        let Some(interface) = self.interface(key.request.operation_network_id.as_str()) else {
            return false;
        };
        let Some(field) = interface.find_key(key) else { return false };
        let address = NodeAddress::Field(field);
        let identifier = interface.identifier(address);
        let before = self.values.variables(&interface, address, &identifier);
        let old = std::mem::replace(&mut interface.records.write()[field as usize], record.clone());
        let mut changed: Vec<(String, DataValue)> = self
            .values
            .variables(&interface, address, &identifier)
            .into_iter()
            .zip(before)
            .filter(|(now, before)| now != before)
            .map(|(now, _)| now)
            .collect();
        push_state(&interface, field, &mut changed);
        self.notify(&changed);
        if (old.mapping_state, old.value_source) != (record.mapping_state, record.value_source) {
            let user = record.decided_by.as_deref().unwrap_or_default();
            self.events.report_decision(|| AuditWrite {
                node_id: self.ids.instance(format!("{identifier}#MappingState")),
                user: user.to_owned(),
                status: StatusCode::Good,
                old_value: (old.mapping_state as i32).into(),
                new_value: (record.mapping_state as i32).into(),
                message: format!("The field {} was decided.", key.field_name),
            });
        }
        true
    }

    /// Publishes the present values to monitored items that were just registered. A value that an
    /// item has already is no change to it.
    pub(super) fn publish_present_values(&self, items: &[&MonitoredItemRef]) {
        let _order = self.publishing.lock();
        let mut notifier = self.subscriptions.data_notifier();
        // Read again here, so that a change during the registration of the item is not missed.
        for item in items.iter().filter(|item| item.attribute() == AttributeId::Value) {
            let present = self.value(item.node_id()).unwrap_or_else(|| DataValue {
                status: Some(StatusCode::BadNodeIdUnknown),
                ..DataValue::default()
            });
            let value = DataValue { server_timestamp: Some(clock::stack_now()), ..present };
            if let Some(mut registered) = notifier.notify_for(item.node_id(), AttributeId::Value) {
                registered.data_value_to_item(value, &item.handle());
            }
        }
    }

    /// Pushes values into the monitored items of these variables.
    fn notify(&self, values: &[(String, DataValue)]) {
        let now = clock::stack_now();
        // Chunks, because each notifier holds a lock that the publishing of all subscriptions needs.
        for chunk in values.chunks(NOTIFIED_AT_ONCE_MAX) {
            let mut notifier = self.subscriptions.data_notifier();
            for (identifier, value) in chunk {
                if let Some(mut items) = notifier
                    .notify_for((self.ids.instances, identifier.as_str()), AttributeId::Value)
                {
                    items.data_value(DataValue { server_timestamp: Some(now), ..value.clone() });
                }
            }
        }
    }

    /// Publishes removed and changed variables.
    fn publish(&self, difference: &Difference, new: Option<&Interface>) {
        let removed = DataValue {
            status: Some(StatusCode::BadNodeIdUnknown),
            server_timestamp: Some(clock::stack_now()),
            ..DataValue::default()
        };
        for objects in difference.removed.chunks(NOTIFIED_AT_ONCE_MAX) {
            self.notify_removed(objects, &NOTIFIED_ATTRIBUTES, &removed);
        }
        // Clients monitor only the value of a property.
        for parts in difference.removed_parts.chunks(NOTIFIED_AT_ONCE_MAX) {
            self.notify_removed(parts, &NOTIFIED_ATTRIBUTES[..1], &removed);
        }
        self.notify(&difference.changed);
        let Some(new) = new else { return };
        let versions: Vec<(String, DataValue)> = difference
            .changed_containers()
            .into_iter()
            .map(|id| format!("{id}#NodeVersion"))
            .map(|id| (id, DataValue::new_now(new.message.revision.to_string())))
            .collect();
        self.notify(&versions);
    }

    fn notify_removed(
        &self,
        identifiers: &[String],
        attributes: &[AttributeId],
        removed: &DataValue,
    ) {
        let mut notifier = self.subscriptions.data_notifier();
        for identifier in identifiers {
            for &attribute in attributes {
                if let Some(mut items) =
                    notifier.notify_for((self.ids.instances, identifier.as_str()), attribute)
                {
                    items.data_value(removed.clone());
                }
            }
        }
    }

    fn publish_folder_version(&self) {
        let version = self.interfaces.read().version().to_string();
        self.notify(&[(format!("{FOLDER_ID}#NodeVersion"), DataValue::new_now(version))]);
    }

    /// Reports model change and audit events, if a client subscribed to events.
    fn report(&self, difference: &Difference, folder: Option<u8>, new: Option<&Interface>) {
        if difference.affected.is_empty() || !self.events.has_subscribers() {
            return;
        }
        let mut changes: Vec<NodeChange> = difference
            .affected
            .iter()
            .map(|(identifier, affected)| NodeChange {
                node_id: self.ids.instance(identifier.clone()),
                type_id: affected.type_definition(self.ids),
                verbs: affected.verbs,
            })
            .collect();
        self.events.report_nodes(&changes, verb::NODE_ADDED, verb::NODE_DELETED);
        if let Some(verbs) = folder {
            let type_id = super::types::folder_type();
            changes.insert(
                0,
                NodeChange { node_id: self.ids.instance(FOLDER_ID.to_owned()), type_id, verbs },
            );
        }
        let message = match (folder, new) {
            (Some(_), Some(_)) => "An Activity Status Interface was added.",
            (Some(_), None) => "An Activity Status Interface was removed.",
            _ => "An Activity Status Interface was changed.",
        };
        self.events.report_model_change(ModelChange { changes, message });
    }
}

/// Adds the state of the operation if the field discloses it.
fn push_state(interface: &Interface, field: u32, changed: &mut Vec<(String, DataValue)>) {
    let operation = interface.slot(interface.field(field).0).operation;
    if interface.field(field).1.semantic == Some(asi_model::network::Semantic::OperationState)
        && interface.state_field(operation) == Some(field)
        && let address = NodeAddress::Operation(operation)
        && let Some(value) =
            interface.part(address, "State").and_then(|part| interface.part_value(address, part))
    {
        changed.push((format!("{}#State", interface.identifier(address)), value));
    }
}

/// Carries over the NodeVersions of nodes that a revision did not change.
fn carry_versions(old: &Interface, new: &mut Interface, difference: &Difference) {
    let changed = difference.changed_containers();
    let before: HashMap<String, NodeAddress> =
        old.addresses().into_iter().map(|address| (old.identifier(address), address)).collect();
    let unchanged: Vec<(NodeAddress, u64)> = new
        .addresses()
        .into_iter()
        .filter_map(|address| {
            let identifier = new.identifier(address);
            let earlier = before.get(&identifier)?;
            let version = old.version(*earlier);
            (!changed.contains(identifier.as_str()) && version != new.base_version)
                .then_some((address, version))
        })
        .collect();
    new.versions.extend(unchanged);
}
