//! Activity Status Interfaces as a node provider.

use std::{ops::ControlFlow, sync::Arc};

use asi_model::{OperationNetworkId, instance::FOLDER_ID};
use async_trait::async_trait;
use opcua_stack::{
    NamespaceTable,
    opcua::{
        server::{SubscriptionCache, node_manager::MonitoredItemRef},
        types::{DataValue, NodeId, ObjectId, QualifiedName, ReferenceTypeId, StatusCode, Variant},
    },
};
use parking_lot::{Mutex, RwLock};

use super::{
    interface::Interface,
    interfaces::Interfaces,
    location::{self, Located, Location},
    model::{self, FOLDER_PARTS},
    node_address::NodeAddress,
    node_ids::NodeIds,
    nodes, references,
    references::reference,
    values::ValueEncoder,
};
use crate::{
    access::{FieldWriter, TwinUser},
    events::EventReporter,
    provider::{
        MethodOutcome, NodeProvider, ProvidedNamespace, ProvidedNode, ProvidedReference,
        ReferenceVisitor, WriteRequest,
    },
};

/// Provides the instances.
pub(crate) struct AsiProvider {
    pub(super) ids: NodeIds,
    /// URI of the instance namespace.
    uri: String,
    pub(super) interfaces: RwLock<Interfaces>,
    /// Held while a change is stored and published, so that both happen in one order.
    pub(super) publishing: Mutex<()>,
    pub(super) subscriptions: Arc<SubscriptionCache>,
    pub(super) values: ValueEncoder,
    pub(super) writer: Arc<dyn FieldWriter>,
    pub(super) events: Arc<EventReporter>,
}

/// Dependencies of an [`AsiProvider`] in the server around it.
pub(crate) struct AsiSurroundings {
    /// Index of the type namespace.
    pub types: u16,
    /// Index of the instance namespace.
    pub instances: u16,
    /// URI of the instance namespace.
    pub uri: String,
    pub subscriptions: Arc<SubscriptionCache>,
    pub namespaces: NamespaceTable,
    pub writer: Arc<dyn FieldWriter>,
    pub events: Arc<EventReporter>,
}

impl AsiProvider {
    /// Creates a provider without interfaces.
    pub fn new(surroundings: AsiSurroundings) -> Self {
        let AsiSurroundings { types, instances, uri, subscriptions, namespaces, writer, events } =
            surroundings;
        let ids = NodeIds { types, instances };
        Self {
            ids,
            uri,
            interfaces: RwLock::default(),
            publishing: Mutex::new(()),
            subscriptions,
            values: ValueEncoder { namespaces, ids },
            writer,
            events,
        }
    }

    /// Returns the number of interfaces.
    pub fn count(&self) -> usize {
        self.interfaces.read().len()
    }

    pub(super) fn interface(&self, id: &str) -> Option<Arc<Interface>> {
        self.interfaces.read().get(id)
    }

    /// Finds the node with this NodeId.
    pub(super) fn locate(&self, node_id: &NodeId) -> Option<Located> {
        location::locate(self.ids, &self.interfaces, node_id)
    }

    fn folder_version(&self) -> DataValue {
        let version = self.interfaces.read().version().to_string();
        DataValue {
            value: Some(version.into()),
            status: Some(StatusCode::Good),
            ..DataValue::default()
        }
    }
}

#[async_trait]
impl NodeProvider for AsiProvider {
    fn name(&self) -> &'static str {
        "asi"
    }

    fn namespaces(&self) -> Vec<ProvidedNamespace> {
        vec![ProvidedNamespace { index: self.ids.instances, uri: self.uri.clone(), version: None }]
    }

    fn node(&self, node_id: &NodeId) -> Option<ProvidedNode> {
        Some(match self.locate(node_id)? {
            Located::Folder(part) => nodes::folder(self.ids, part),
            Located::Node(Location { below: Some(below), .. }) => {
                nodes::part(self.ids, below, None)
            }
            Located::Node(Location { interface, address, part: Some(part), .. }) => {
                nodes::part(self.ids, part, interface.unit_of(address, part))
            }
            Located::Node(Location { interface, address, .. }) => {
                nodes::object_or_field(self.ids, &interface, address)
            }
        })
    }

    fn value(&self, node_id: &NodeId) -> Option<DataValue> {
        match self.locate(node_id)? {
            Located::Folder(None) => None,
            Located::Folder(Some(_)) => Some(self.folder_version()),
            Located::Node(Location {
                interface,
                address,
                part: Some(part),
                below: Some(below),
            }) => interface.part_of_part_value(address, part, below, self.ids.types),
            Located::Node(Location { interface, address, part: Some(part), .. }) => {
                interface.part_value(address, part)
            }
            Located::Node(Location { interface, address: NodeAddress::Field(field), .. }) => {
                let records = interface.records.read();
                Some(self.values.field(&records[field as usize]))
            }
            Located::Node(_) => None,
        }
    }

    fn references(&self, node_id: &NodeId, after: u64, visit: &mut ReferenceVisitor<'_>) {
        if *node_id == ObjectId::ObjectsFolder {
            if after == 0 {
                // It is the only one, so the visitor's answer does not matter.
                let _: ControlFlow<()> = visit(
                    1,
                    reference(
                        ReferenceTypeId::Organizes,
                        true,
                        self.ids.instance(FOLDER_ID.to_owned()),
                    ),
                );
            }
            return;
        }
        let references = match self.locate(node_id) {
            None => return,
            Some(Located::Folder(None)) => {
                return references::of_folder(self.ids, &self.interfaces, after, visit);
            }
            Some(Located::Folder(Some(_))) => vec![
                reference(
                    ReferenceTypeId::HasProperty,
                    false,
                    self.ids.instance(FOLDER_ID.to_owned()),
                ),
                reference(ReferenceTypeId::HasTypeDefinition, true, model::PROPERTY_TYPE.into()),
            ],
            Some(Located::Node(location)) => match location.part {
                Some(part) => references::of_part(self.ids, &location, part),
                None => {
                    references::of_object_or_field(self.ids, &location.interface, location.address)
                }
            },
        };
        for (position, reference) in
            (1..).zip(references).skip(usize::try_from(after).unwrap_or(usize::MAX))
        {
            if visit(position, reference).is_break() {
                return;
            }
        }
    }

    fn targets_named(
        &self,
        node_id: &NodeId,
        browse_name: &QualifiedName,
    ) -> Option<Vec<ProvidedReference>> {
        let Some(Located::Folder(None)) = self.locate(node_id) else { return None };
        let name = browse_name.name.as_ref();
        if browse_name.namespace_index == self.ids.instances {
            let id = OperationNetworkId::new(name).ok()?;
            return Some(
                self.interface(name)
                    .map(|_| references::organizes(self.ids, &id))
                    .into_iter()
                    .collect(),
            );
        }
        let part = FOLDER_PARTS.iter().find(|part| part.is_standard && part.name == name);
        let target = part.map(|part| self.ids.instance(format!("{FOLDER_ID}#{}", part.name)));
        Some(
            target
                .map(|id| reference(ReferenceTypeId::HasProperty, true, id))
                .into_iter()
                .collect(),
        )
    }

    fn publish_present(&self, items: &[&MonitoredItemRef]) {
        self.publish_present_values(items);
    }

    async fn write(&self, user: &TwinUser, request: WriteRequest<'_>) -> StatusCode {
        self.write_field(user, request).await
    }

    async fn call(
        &self,
        user: &TwinUser,
        object: &NodeId,
        method: &NodeId,
        arguments: &[Variant],
    ) -> MethodOutcome {
        self.call_method(user, object, method, arguments).await
    }
}
