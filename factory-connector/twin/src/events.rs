//! Events of the Server object: changes of the model, and an audit trail for standard tools.

mod security;
mod sessions;

pub(crate) use security::SessionAudit;

use std::sync::Arc;

use opcua_stack::opcua::{
    crypto::random,
    nodes::Event,
    server::{EventField, ServerHandle, SubscriptionCache},
    types::{
        AddNodesItem, AttributeId, DateTime, DeleteNodesItem, ExtensionObject, LocalizedText,
        ModelChangeStructureDataType, NodeId, NumericRange, ObjectId, ObjectTypeId, QualifiedName,
        StatusCode, UAString, Variant,
    },
};
use sessions::Sessions;

use crate::access::Role;

/// Severity of events about changes.
const SEVERITY_NORMAL: u16 = 100;
/// Severity of audit events about refusals.
const SEVERITY_REFUSED: u16 = 500;
/// Most nodes listed in one audit event; the model change event lists all.
const NODES_PER_AUDIT_EVENT_MAX: usize = 1000;
/// Bytes of an event's id.
const EVENT_ID_BYTES: usize = 16;

/// Reports events to the subscribers of the Server object.
pub(crate) struct EventReporter {
    subscriptions: Arc<SubscriptionCache>,
    sessions: Sessions,
    server_uri: String,
}

/// A written value or a decision.
pub(crate) struct AuditWrite {
    pub node_id: NodeId,
    pub user: String,
    pub status: StatusCode,
    pub old_value: Variant,
    pub new_value: Variant,
    pub message: String,
}

/// One affected node of a model change.
#[derive(Debug, Clone)]
pub(crate) struct NodeChange {
    pub node_id: NodeId,
    /// The type definition; null if it is not of the ASI types.
    pub type_id: NodeId,
    pub verbs: u8,
}

/// A change of the address space.
pub(crate) struct ModelChange {
    pub changes: Vec<NodeChange>,
    pub message: &'static str,
}

impl EventReporter {
    /// Creates a reporter of the server with this ApplicationUri.
    pub fn new(server: &ServerHandle, server_uri: String) -> Self {
        let subscriptions = Arc::clone(server.subscriptions());
        let types = Arc::clone(&server.info().type_tree);
        Self {
            sessions: Sessions::new(Arc::clone(&subscriptions), types),
            subscriptions,
            server_uri,
        }
    }

    /// Returns whether a client subscribed to events of the server; otherwise none is built.
    pub fn has_subscribers(&self) -> bool {
        self.subscriptions.event_notifier().notify_for(ObjectId::Server).is_some()
    }

    fn send(&self, event: &ServerEvent) {
        let server: NodeId = ObjectId::Server.into();
        self.subscriptions.notify_events([(event as &dyn Event, &server)].into_iter());
    }

    /// Reports the value that a client wrote, to the users who may write themselves. Time, status and
    /// number of writes tell what a delay, a time step or a withheld state keeps from all others.
    pub fn report_write(&self, write: impl FnOnce() -> AuditWrite) {
        if self.has_subscribers() {
            self.sessions.send(&self.write_event(write()), Role::may_write);
        }
    }

    /// Reports a decision about a field, which everybody may read.
    pub fn report_decision(&self, decision: impl FnOnce() -> AuditWrite) {
        if self.has_subscribers() {
            self.send(&self.write_event(decision()));
        }
    }

    /// Builds an AuditWriteUpdateEventType (OPC 10000-5 §6.4.27).
    fn write_event(&self, write: AuditWrite) -> ServerEvent {
        let mut event = self.audit(
            ObjectTypeId::AuditWriteUpdateEventType,
            &write.user,
            write.status,
            write.message,
        );
        event.set("SourceNode", write.node_id);
        event.set("SourceName", "Attribute/Write");
        event.set("AttributeId", AttributeId::Value as u32);
        event.set("IndexRange", UAString::null());
        event.set_variant("OldValue", write.old_value);
        event.set_variant("NewValue", write.new_value);
        event
    }

    /// Reports an AuditAddNodesEventType and an AuditDeleteNodesEventType (OPC 10000-5 §6.4.21,
    /// §6.4.22).
    pub fn report_nodes(&self, changes: &[NodeChange], added: u8, deleted: u8) {
        let with = |verb: u8| {
            changes.iter().filter(move |c| c.verbs & verb != 0).take(NODES_PER_AUDIT_EVENT_MAX)
        };
        let to_add: Vec<ExtensionObject> = with(added)
            .map(|change| {
                ExtensionObject::from_message(AddNodesItem {
                    requested_new_node_id: change.node_id.clone().into(),
                    type_definition: change.type_id.clone().into(),
                    ..AddNodesItem::default()
                })
            })
            .collect();
        let to_delete: Vec<ExtensionObject> = with(deleted)
            .map(|change| {
                ExtensionObject::from_message(DeleteNodesItem {
                    node_id: change.node_id.clone(),
                    delete_target_references: true,
                })
            })
            .collect();
        for (event_type, field, source, items) in [
            (ObjectTypeId::AuditAddNodesEventType, "NodesToAdd", "NodeManagement/AddNodes", to_add),
            (
                ObjectTypeId::AuditDeleteNodesEventType,
                "NodesToDelete",
                "NodeManagement/DeleteNodes",
                to_delete,
            ),
        ] {
            if !items.is_empty() {
                // The platform's messages change the model, no OPC UA client does.
                let message = format!("{} nodes were named by the platform.", items.len());
                let mut event = self.audit(event_type, "", StatusCode::Good, message);
                event.set("SourceName", source);
                event.set_variant(field, items.into());
                self.send(&event);
            }
        }
    }

    /// Reports a GeneralModelChangeEventType (OPC 10000-5 §6.4.32).
    pub fn report_model_change(&self, change: ModelChange) {
        let mut event = ServerEvent::new(
            ObjectTypeId::GeneralModelChangeEventType,
            SEVERITY_NORMAL,
            change.message,
        );
        let changes: Vec<ExtensionObject> = change
            .changes
            .into_iter()
            .map(|change| {
                ExtensionObject::from_message(ModelChangeStructureDataType {
                    affected: change.node_id,
                    affected_type: change.type_id,
                    verb: change.verbs,
                })
            })
            .collect();
        event.set_variant("Changes", changes.into());
        self.send(&event);
    }

    fn audit(
        &self,
        event_type: ObjectTypeId,
        user: &str,
        status: StatusCode,
        message: String,
    ) -> ServerEvent {
        let severity = if status.is_bad() { SEVERITY_REFUSED } else { SEVERITY_NORMAL };
        let mut event = ServerEvent::new(event_type, severity, &message);
        event.set("ActionTimeStamp", event.time);
        event.set("Status", !status.is_bad());
        event.set("StatusCodeId", status);
        event.set("ServerId", self.server_uri.as_str());
        event.set("ClientAuditEntryId", UAString::null());
        event.set("ClientUserId", user);
        event
    }
}

/// An event with its fields by name. Names are unique over the standard's event types, so they need
/// no qualification.
#[derive(Debug)]
struct ServerEvent {
    event_type: NodeId,
    time: DateTime,
    fields: Vec<(&'static str, Variant)>,
}

impl ServerEvent {
    fn new(event_type: ObjectTypeId, severity: u16, message: &str) -> Self {
        let (time, event_type) = (crate::clock::stack_now(), NodeId::from(event_type));
        let fields = vec![
            ("EventId", random::byte_string(EVENT_ID_BYTES).into()),
            ("EventType", event_type.clone().into()),
            ("SourceNode", NodeId::from(ObjectId::Server).into()),
            ("SourceName", "Server".into()),
            ("Time", time.into()),
            ("ReceiveTime", time.into()),
            ("Message", LocalizedText::new("en", message).into()),
            ("Severity", severity.into()),
        ];
        Self { event_type, time, fields }
    }

    fn set(&mut self, name: &'static str, value: impl Into<Variant>) {
        self.set_variant(name, value.into());
    }

    fn set_variant(&mut self, name: &'static str, value: Variant) {
        match self.fields.iter_mut().find(|(known, _)| *known == name) {
            Some((_, old)) => *old = value,
            None => self.fields.push((name, value)),
        }
    }
}

impl EventField for ServerEvent {
    fn get_value(
        &self,
        attribute_id: AttributeId,
        index_range: &NumericRange,
        path: &[QualifiedName],
    ) -> Variant {
        let [name] = path else { return Variant::Empty };
        if attribute_id != AttributeId::Value || name.namespace_index != 0 {
            return Variant::Empty;
        }
        let field = self.fields.iter().find(|(known, _)| *known == name.name.as_ref());
        field.and_then(|(_, value)| value.range_of(index_range).ok()).unwrap_or_default()
    }
}

impl Event for ServerEvent {
    fn get_field(
        &self,
        _type_definition_id: &NodeId,
        attribute_id: AttributeId,
        index_range: &NumericRange,
        browse_path: &[QualifiedName],
    ) -> Variant {
        self.get_value(attribute_id, index_range, browse_path)
    }

    fn time(&self) -> &DateTime {
        &self.time
    }

    fn event_type_id(&self) -> &NodeId {
        &self.event_type
    }
}
