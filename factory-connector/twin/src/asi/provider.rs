//! Activity Status Interfaces as a node provider.

use std::{
    collections::{BTreeMap, HashMap},
    ops::ControlFlow,
    sync::Arc,
};

use asi_model::{OperationNetworkId, instance::FOLDER_ID};
use async_trait::async_trait;
use opcua_stack::{
    NamespaceTable,
    opcua::{
        server::{SubscriptionCache, node_manager::MonitoredItemRef},
        types::{
            DataValue, Identifier, NodeId, ObjectId, QualifiedName, ReferenceTypeId, StatusCode,
            Variant,
        },
    },
    values::to_stack,
};
use parking_lot::{Mutex, RwLock};

use super::{
    interface::Interface,
    model::{self, FOLDER_PARTS, Part},
    place::{self, Place},
    references::reference,
};
use crate::{
    access::{FieldWriter, TwinUser},
    document::FieldRecord,
    events::EventReporter,
    provider::{
        CallOutcome, Node, NodeProvider, ProvidedNamespace, Reference, ReferenceVisitor,
        WriteRequest,
    },
};

/// Provides the instances.
pub(crate) struct AsiProvider {
    /// Index of the type namespace.
    pub(super) types: u16,
    /// Index of the instance namespace.
    pub(super) instances: u16,
    uri: String,
    pub(super) state: RwLock<Interfaces>,
    /// Held while something is stored and told to subscribers, so that both happen in one order.
    pub(super) publishing: Mutex<()>,
    pub(super) subscriptions: Arc<SubscriptionCache>,
    pub(super) namespaces: NamespaceTable,
    pub(super) writer: Arc<dyn FieldWriter>,
    pub(super) events: Arc<EventReporter>,
}

/// All interfaces. Locked for moments only: what is expensive happens outside.
#[derive(Default)]
pub(super) struct Interfaces {
    pub by_id: HashMap<OperationNetworkId, Arc<Interface>>,
    pub by_sequence: BTreeMap<u64, OperationNetworkId>,
    pub last_sequence: u64,
    /// NodeVersion of the folder.
    pub version: u64,
}

/// What an [`AsiProvider`] needs from the server around it.
pub(crate) struct AsiSurroundings {
    pub types: u16,
    pub instances: u16,
    pub uri: String,
    pub subscriptions: Arc<SubscriptionCache>,
    pub namespaces: NamespaceTable,
    pub writer: Arc<dyn FieldWriter>,
    pub events: Arc<EventReporter>,
}

/// A node that was found.
pub(super) enum Located {
    Folder(Option<&'static Part>),
    Node(At),
}

/// A node within an interface: a place, a part of it, or a property of that part.
pub(super) struct At {
    pub interface: Arc<Interface>,
    pub place: Place,
    pub part: Option<&'static Part>,
    pub below: Option<&'static Part>,
}

impl AsiProvider {
    pub fn new(surroundings: AsiSurroundings) -> Self {
        let AsiSurroundings { types, instances, uri, subscriptions, namespaces, writer, events } =
            surroundings;
        Self {
            types,
            instances,
            uri,
            state: RwLock::default(),
            publishing: Mutex::new(()),
            subscriptions,
            namespaces,
            writer,
            events,
        }
    }

    /// How many interfaces there are.
    pub fn count(&self) -> usize {
        self.state.read().by_id.len()
    }

    pub(super) fn interface(&self, id: &str) -> Option<Arc<Interface>> {
        self.state.read().by_id.get(id).cloned()
    }

    /// Finds the node behind an id.
    pub(super) fn locate(&self, node_id: &NodeId) -> Option<Located> {
        let Identifier::String(identifier) = &node_id.identifier else { return None };
        let identifier = identifier.as_ref();
        if node_id.namespace != self.instances {
            return None;
        }
        if let Some(rest) = identifier.strip_prefix(FOLDER_ID) {
            let part = match rest.strip_prefix('#') {
                Some(name) => Some(FOLDER_PARTS.iter().find(|part| part.name == name)?),
                None if rest.is_empty() => None,
                None => return None,
            };
            return Some(Located::Folder(part));
        }
        let parsed = place::Identifier::parse(identifier)?;
        let interface = self.interface(&parsed.network)?;
        let (place, names) = parsed.locate(&interface)?;
        let (part, below) = match names {
            [] => (None, None),
            [name] => (Some(interface.part(place, name)?), None),
            [name, below] => {
                let part = interface.part(place, name)?;
                let parts = interface.parts_of_part(place, part);
                (Some(part), Some(parts.into_iter().find(|p| p.name == *below)?))
            }
            _ => return None,
        };
        Some(Located::Node(At { interface, place, part, below }))
    }

    pub(super) fn id(&self, identifier: String) -> NodeId {
        NodeId::new(self.instances, identifier)
    }

    pub(super) fn type_id(&self, id: u32) -> NodeId {
        NodeId::new(self.types, id)
    }

    /// What a client reads from a field's variable.
    pub(super) fn shown(&self, record: &FieldRecord) -> DataValue {
        to_stack(&record.shown_value(), &self.namespaces).unwrap_or_else(|error| {
            tracing::warn!(%error, "A value cannot be shown in OPC UA Binary.");
            DataValue { status: Some(StatusCode::BadEncodingError), ..DataValue::default() }
        })
    }

    fn folder_version(&self) -> DataValue {
        let version = self.state.read().version.to_string();
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
        vec![ProvidedNamespace { index: self.instances, uri: self.uri.clone(), version: None }]
    }

    fn node(&self, node_id: &NodeId) -> Option<Node> {
        Some(match self.locate(node_id)? {
            Located::Folder(part) => self.folder_node(part),
            Located::Node(At { below: Some(below), .. }) => self.part_node(below, None),
            Located::Node(At { interface, place, part: Some(part), .. }) => {
                self.part_node(part, interface.unit_of(place, part))
            }
            Located::Node(At { interface, place, .. }) => self.place_node(&interface, place),
        })
    }

    fn value(&self, node_id: &NodeId) -> Option<DataValue> {
        match self.locate(node_id)? {
            Located::Folder(None) => None,
            Located::Folder(Some(_)) => Some(self.folder_version()),
            Located::Node(At { interface, place, part: Some(part), below: Some(below) }) => {
                interface.part_of_part_value(place, part, below, self.types)
            }
            Located::Node(At { interface, place, part: Some(part), .. }) => {
                interface.part_value(place, part)
            }
            Located::Node(At { interface, place: Place::Field(field), .. }) => {
                let records = interface.records.read();
                Some(self.shown(&records[field as usize]))
            }
            Located::Node(_) => None,
        }
    }

    fn references(&self, node_id: &NodeId, after: u64, visit: &mut ReferenceVisitor<'_>) {
        if *node_id == ObjectId::ObjectsFolder {
            if after == 0 {
                // The only one, so it does not matter whether the visitor wants more.
                let _: ControlFlow<()> = visit(
                    1,
                    reference(ReferenceTypeId::Organizes, true, self.id(FOLDER_ID.to_owned())),
                );
            }
            return;
        }
        let references = match self.locate(node_id) {
            None => return,
            Some(Located::Folder(None)) => return self.folder_references(after, visit),
            Some(Located::Folder(Some(_))) => vec![
                reference(ReferenceTypeId::HasProperty, false, self.id(FOLDER_ID.to_owned())),
                reference(ReferenceTypeId::HasTypeDefinition, true, model::PROPERTY_TYPE.into()),
            ],
            Some(Located::Node(at)) => match at.part {
                Some(part) => self.part_references(&at, part),
                None => self.place_references(&at.interface, at.place),
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
    ) -> Option<Vec<Reference>> {
        let Some(Located::Folder(None)) = self.locate(node_id) else { return None };
        let name = browse_name.name.as_ref();
        if browse_name.namespace_index == self.instances {
            let id = OperationNetworkId::new(name).ok()?;
            return Some(self.interface(name).map(|_| self.organizes(&id)).into_iter().collect());
        }
        let part = FOLDER_PARTS.iter().find(|part| part.is_standard && part.name == name);
        let target = part.map(|part| self.id(format!("{FOLDER_ID}#{}", part.name)));
        Some(
            target
                .map(|id| reference(ReferenceTypeId::HasProperty, true, id))
                .into_iter()
                .collect(),
        )
    }

    fn tell_again(&self, items: &[&MonitoredItemRef]) {
        self.tell_present_values(items);
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
    ) -> CallOutcome {
        self.call_method(user, object, method, arguments).await
    }
}
