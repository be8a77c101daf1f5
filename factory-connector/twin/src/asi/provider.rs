//! Activity Status Interfaces as a node provider.

use std::{
    collections::{BTreeMap, HashMap},
    ops::ControlFlow,
    sync::Arc,
};

use asi_model::{
    OperationNetworkId,
    instance::{FOLDER_ID, FOLDER_NAME, encode_segment},
    messages::OperationNetworkMessage,
    network::ReportField,
};
use async_trait::async_trait;
use opcua_stack::{
    NamespaceTable,
    opcua::{
        server::{SubscriptionCache, node_manager::MonitoredItemRef},
        types::{
            DataValue, Identifier, LocalizedText, NodeId, ObjectId, QualifiedName, ReferenceTypeId, StatusCode,
            VariableTypeId, Variant,
        },
    },
    values::to_stack,
};
use parking_lot::{Mutex, RwLock};

use super::{
    interface::Interface,
    model::{self, FOLDER_PARTS, Part, PartKind, ValueType},
    parts::{built_in_type_id, data_type_id},
    place::{self, Place},
    types::folder_type,
};
use crate::{
    access::{FieldWriter, TwinUser},
    document::FieldRecord,
    events::EventReporter,
    provider::{
        CallOutcome, Node, NodeKind, NodeProvider, ProvidedNamespace, Reference, ReferenceVisitor, WriteRequest,
    },
};

/// Positions among the folder's references below this are its own; above it, the sequences of interfaces.
const FOLDER_OWN_REFERENCES: u64 = 16;

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
        let AsiSurroundings { types, instances, uri, subscriptions, namespaces, writer, events } = surroundings;
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
        DataValue { value: Some(version.into()), status: Some(StatusCode::Good), ..DataValue::default() }
    }

    fn folder_node(&self, part: Option<&'static Part>) -> Node {
        match part {
            Some(part) => self.part_node(part, None),
            None => Node {
                browse_name: QualifiedName::new(self.instances, FOLDER_NAME),
                display_name: LocalizedText::from("Collaborative Process Twin"),
                description: LocalizedText::new("en", "Every operation network that concerns this factory."),
                type_definition: Some(folder_type()),
                class: NodeKind::Object,
            },
        }
    }

    fn folder_references(&self, after: u64, visit: &mut ReferenceVisitor<'_>) {
        let folder = FOLDER_ID.to_owned();
        let own = [
            reference(ReferenceTypeId::Organizes, false, ObjectId::ObjectsFolder.into()),
            reference(ReferenceTypeId::HasTypeDefinition, true, folder_type()),
            reference(ReferenceTypeId::HasProperty, true, self.id(format!("{folder}#{}", FOLDER_PARTS[0].name))),
        ];
        for (position, reference) in (1..).zip(own).filter(|(position, _)| *position > after) {
            if visit(position, reference).is_break() {
                return;
            }
        }
        let mut sequence = after.saturating_sub(FOLDER_OWN_REFERENCES);
        // The lock is taken anew for every interface: the visitor looks the targets up.
        loop {
            let next = {
                let state = self.state.read();
                state.by_sequence.range(sequence + 1..).next().map(|(sequence, id)| (*sequence, id.clone()))
            };
            let Some((found, id)) = next else { return };
            sequence = found;
            let reference = self.organizes(&id);
            if visit(FOLDER_OWN_REFERENCES + sequence, reference).is_break() {
                return;
            }
        }
    }

    fn organizes(&self, id: &OperationNetworkId) -> Reference {
        let mut identifier = String::new();
        encode_segment(&mut identifier, id.as_str());
        reference(ReferenceTypeId::Organizes, true, self.id(identifier))
    }

    fn place_node(&self, interface: &Interface, place: Place) -> Node {
        let message: &OperationNetworkMessage = &interface.message;
        let network = &message.operation_network;
        let instance = |id: &str, name: Option<&String>, description: Option<&String>| Node {
            browse_name: QualifiedName::new(self.instances, id),
            display_name: LocalizedText::from(name.map_or(id, String::as_str)),
            description: description.map_or_else(LocalizedText::null, LocalizedText::from),
            type_definition: interface.type_of(place).map(|id| self.type_id(id)),
            class: NodeKind::Object,
        };
        let fixed =
            |name: &str| Node { browse_name: QualifiedName::new(self.types, name), ..instance(name, None, None) };
        match place {
            Place::Interface => {
                instance(network.operation_network_id.as_str(), network.name.as_ref(), network.description.as_ref())
            }
            Place::OperationNetwork => fixed("OperationNetwork"),
            Place::Operation(operation) => {
                let operation = interface.operation(operation);
                instance(operation.operation_id.as_str(), operation.name.as_ref(), operation.description.as_ref())
            }
            Place::Requirement(operation, at) => {
                let requirement = &interface.operation(operation).equipment_requirement_list[at as usize];
                instance(requirement.equipment_requirement_id.as_str(), None, None)
            }
            Place::Relation(relation) => {
                instance(interface.relation(relation).operation_relation_id.as_str(), None, None)
            }
            Place::Condition(relation, at) => {
                instance(interface.relation(relation).condition_list[at as usize].condition_id.as_str(), None, None)
            }
            Place::Request(request) => {
                let request = interface.request(request);
                instance(request.dynamic_data_request_id.as_str(), None, request.description.as_ref())
            }
            Place::ReportDataFormat(_) => fixed("ReportDataFormat"),
            Place::Field(field) => {
                let definition = interface.field(field).1;
                let is_writable = interface.records.read()[field as usize].is_writable();
                Node {
                    type_definition: Some(field_type(definition)),
                    class: NodeKind::Variable {
                        data_type: built_in_type_id(definition.field_type.0),
                        value_rank: definition.value_rank,
                        is_writable,
                    },
                    ..instance(definition.name.as_str(), None, definition.description.as_ref())
                }
            }
        }
    }

    fn part_node(&self, part: &Part, unit: Option<&str>) -> Node {
        let variable = |value: ValueType| NodeKind::Variable {
            data_type: data_type_id(value.data_type, self.types),
            value_rank: value.value_rank,
            is_writable: false,
        };
        let (class, type_definition) = match part.kind {
            PartKind::Property(value) => (variable(value), Some(model::PROPERTY_TYPE.into())),
            PartKind::Component(value) if unit.is_some() => {
                (variable(value), Some(VariableTypeId::AnalogUnitType.into()))
            }
            PartKind::Component(value) => (variable(value), Some(VariableTypeId::BaseDataVariableType.into())),
            PartKind::Object(id) => (NodeKind::Object, Some(self.type_id(id))),
            PartKind::Method(_) => (NodeKind::Method { callable_by: model::callable_by(part.name) }, None),
        };
        Node {
            browse_name: QualifiedName::new(if part.is_standard { 0 } else { self.types }, part.name),
            display_name: LocalizedText::from(part.name),
            description: LocalizedText::null(),
            type_definition,
            class,
        }
    }

    fn place_references(&self, interface: &Interface, place: Place) -> Vec<Reference> {
        let identifier = interface.identifier(place);
        let mut references = vec![self.to_parent(interface, place)];
        let definition = match place {
            Place::Field(field) => Some(field_type(interface.field(field).1)),
            _ => interface.type_of(place).map(|id| self.type_id(id)),
        };
        references.extend(definition.map(|id| reference(ReferenceTypeId::HasTypeDefinition, true, id)));
        for part in interface.parts(place) {
            references.push(reference(part_reference(part), true, self.id(format!("{identifier}#{}", part.name))));
        }
        for child in interface.children(place) {
            references.push(Reference {
                reference_type: self.child_reference(child),
                is_forward: true,
                target: self.id(interface.identifier(child)),
            });
        }
        if let Place::Operation(operation) = place {
            self.push_dependencies(interface, operation, &mut references);
        }
        references
    }

    /// The second representation of relations: arrows between operations.
    fn push_dependencies(&self, interface: &Interface, operation: u32, references: &mut Vec<Reference>) {
        let own_id = &interface.operation(operation).operation_id;
        for relation in interface.relations_of(operation).map(|r| interface.relation(r)) {
            let is_forward = relation.predecessor_operation_id == *own_id;
            let other = if is_forward { &relation.successor_operation_id } else { &relation.predecessor_operation_id };
            if let Some(other) = interface.find_operation_id(other) {
                references.push(Reference {
                    reference_type: self.type_id(model::dependency(relation.relation_type)),
                    is_forward,
                    target: self.id(interface.identifier(Place::Operation(other))),
                });
            }
        }
    }

    fn to_parent(&self, interface: &Interface, place: Place) -> Reference {
        match interface.parent(place) {
            None => reference(ReferenceTypeId::Organizes, false, self.id(FOLDER_ID.to_owned())),
            Some(parent) => Reference {
                reference_type: self.child_reference(place),
                is_forward: false,
                target: self.id(interface.identifier(parent)),
            },
        }
    }

    fn child_reference(&self, child: Place) -> NodeId {
        match child {
            Place::Operation(_) => self.type_id(model::HAS_OPERATION),
            _ => ReferenceTypeId::HasComponent.into(),
        }
    }

    fn part_references(&self, at: &At, part: &'static Part) -> Vec<Reference> {
        let owner = at.interface.identifier(at.place);
        let own = format!("{owner}#{}", part.name);
        let mut references = Vec::new();
        let shown = match at.below {
            Some(below) => {
                references.push(reference(ReferenceTypeId::HasProperty, false, self.id(own)));
                below
            }
            None => {
                references.push(reference(part_reference(part), false, self.id(owner)));
                for below in at.interface.parts_of_part(at.place, part) {
                    let target = self.id(format!("{own}#{}", below.name));
                    references.push(reference(ReferenceTypeId::HasProperty, true, target));
                }
                part
            }
        };
        let definition = self.part_node(shown, at.interface.unit_of(at.place, shown)).type_definition;
        references.extend(definition.map(|id| reference(ReferenceTypeId::HasTypeDefinition, true, id)));
        references
    }
}

pub(super) fn reference(reference_type: ReferenceTypeId, is_forward: bool, target: NodeId) -> Reference {
    Reference { reference_type: reference_type.into(), is_forward, target }
}

fn part_reference(part: &Part) -> ReferenceTypeId {
    match part.kind {
        PartKind::Property(_) => ReferenceTypeId::HasProperty,
        _ => ReferenceTypeId::HasComponent,
    }
}

/// AnalogUnitType where the field has a unit and a numeric type.
fn field_type(definition: &ReportField) -> NodeId {
    if definition.unit.is_some() && definition.field_type.0.is_numeric() {
        VariableTypeId::AnalogUnitType.into()
    } else {
        VariableTypeId::BaseDataVariableType.into()
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
            Located::Node(At { interface, place, part: Some(part), .. }) => interface.part_value(place, part),
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
                let _: ControlFlow<()> =
                    visit(1, reference(ReferenceTypeId::Organizes, true, self.id(FOLDER_ID.to_owned())));
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
        for (position, reference) in (1..).zip(references).skip(usize::try_from(after).unwrap_or(usize::MAX)) {
            if visit(position, reference).is_break() {
                return;
            }
        }
    }

    fn targets_named(&self, node_id: &NodeId, browse_name: &QualifiedName) -> Option<Vec<Reference>> {
        let Some(Located::Folder(None)) = self.locate(node_id) else { return None };
        let name = browse_name.name.as_ref();
        if browse_name.namespace_index == self.instances {
            let id = OperationNetworkId::new(name).ok()?;
            return Some(self.interface(name).map(|_| self.organizes(&id)).into_iter().collect());
        }
        let part = FOLDER_PARTS.iter().find(|part| part.is_standard && part.name == name);
        let target = part.map(|part| self.id(format!("{FOLDER_ID}#{}", part.name)));
        Some(target.map(|id| reference(ReferenceTypeId::HasProperty, true, id)).into_iter().collect())
    }

    fn tell_again(&self, items: &[&MonitoredItemRef]) {
        self.tell_present_values(items);
    }

    async fn write(&self, user: &TwinUser, request: WriteRequest<'_>) -> StatusCode {
        self.write_field(user, request).await
    }

    async fn call(&self, user: &TwinUser, object: &NodeId, method: &NodeId, arguments: &[Variant]) -> CallOutcome {
        self.call_method(user, object, method, arguments).await
    }
}
