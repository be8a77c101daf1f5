//! The nodes of an interface.

use std::{collections::HashMap, sync::Arc};

use super::{
    FieldState, Instance,
    path::{FOLDER_ID, FOLDER_NAME, Path},
};
use crate::{
    asi_types::{self, Part, PartKind, asi, browse_name, instance_namespace_uri, parts_of_type},
    ids::{OperationId, RequestKey},
    messages::MappingState,
    network::{
        DynamicDataRequest, Operation, OperationKind, OperationRelation, RelationCondition,
        ReportField,
    },
    node_set::{Model, Node, NodeClass, NodeSet, ns0},
    units,
    values::{Array, BuiltInType, Namespace, NodeId, QualifiedName, Scalar, Variant},
};

/// The nodes of an interface with the folder it hangs in, to be written as NodeSet2.
#[must_use]
pub fn node_set(instance: &Instance<'_>) -> NodeSet {
    let message = instance.message;
    let uri = instance_namespace_uri(&message.factory_id);
    let mut writer =
        NodeWriter { instance, uri: uri.clone(), nodes: Vec::new(), operations: HashMap::new() };
    writer.interface();
    let types = asi_types::node_set().models;
    let model = Model {
        uri,
        version: Some(message.revision.to_string()),
        publication_date: None,
        required: types,
    };
    let required =
        model.required.into_iter().map(|required| Model { required: Vec::new(), ..required });
    let required = std::iter::once(Model::ua()).chain(required).collect();
    NodeSet { models: vec![Model { required, ..model }], nodes: writer.nodes }
}

struct NodeWriter<'a> {
    instance: &'a Instance<'a>,
    uri: String,
    nodes: Vec<Node>,
    /// NodeIds of the operations.
    operations: HashMap<OperationId, usize>,
}

fn text(text: &str) -> Option<Variant> {
    Some(text.into())
}

fn optional(text: Option<&str>) -> Option<Variant> {
    text.map(Into::into)
}

impl NodeWriter<'_> {
    fn id(&self, path: &Path) -> NodeId {
        NodeId::string(&self.uri, path.as_str())
    }

    /// A BrowseName of the instance namespace.
    fn name(&self, name: &str) -> QualifiedName {
        QualifiedName { namespace: Namespace::uri(&self.uri), name: Some(Arc::from(name)) }
    }

    /// An object with the parts of its type, with the values that `value_of` returns.
    fn object(
        &mut self,
        path: &Path,
        name: QualifiedName,
        type_id: u32,
        parent: (NodeId, NodeId),
        value_of: impl Fn(&str) -> Option<Variant>,
    ) {
        let node = Node::new(self.id(path), name, NodeClass::Object)
            .with(ns0::HAS_TYPE_DEFINITION, asi(type_id))
            .with_inverse(parent.0, parent.1);
        self.nodes.push(node);
        for part in parts_of_type(type_id) {
            if let Some(value) = value_of(part.name) {
                self.part(path, part, value);
            }
        }
    }

    fn part(&mut self, owner: &Path, part: &Part, value: Variant) {
        let (kind, definition, reference) = match part.kind {
            PartKind::Property(kind) => (kind, ns0::PROPERTY_TYPE, ns0::HAS_PROPERTY),
            PartKind::Component(kind) => (kind, ns0::BASE_DATA_VARIABLE_TYPE, ns0::HAS_COMPONENT),
            PartKind::Object(_) | PartKind::Method(_) => return,
        };
        let class = NodeClass::Variable {
            data_type: kind.data_type.node_id(),
            value_rank: kind.value_rank,
            value,
            is_writable: false,
        };
        let node = Node::new(self.id(&owner.part(part.name)), part.browse_name(), class)
            .with(ns0::HAS_TYPE_DEFINITION, definition)
            .with_inverse(reference, self.id(owner));
        self.nodes.push(node);
    }

    /// EngineeringUnits below a variable that was written last; the variable becomes an
    /// AnalogUnitType.
    fn unit(&mut self, variable: &Path, unit: &str) {
        let Some(unit) = units::lookup(unit) else { return };
        if let Some(node) = self.nodes.last_mut() {
            for reference in &mut node.references {
                if reference.reference_type == ns0::HAS_TYPE_DEFINITION {
                    reference.target = ns0::ANALOG_UNIT_TYPE;
                }
            }
        }
        let value = Variant::Scalar(Scalar::ExtensionObject(Box::new(unit.to_extension_object())));
        let class = NodeClass::Variable {
            data_type: ns0::EU_INFORMATION,
            value_rank: -1,
            value,
            is_writable: false,
        };
        let node = Node::new(
            self.id(&variable.part("EngineeringUnits")),
            browse_name("EngineeringUnits", true),
            class,
        )
        .with(ns0::HAS_TYPE_DEFINITION, ns0::PROPERTY_TYPE)
        .with_inverse(ns0::HAS_PROPERTY, self.id(variable));
        self.nodes.push(node);
    }

    fn interface(&mut self) {
        let message = self.instance.message;
        let network = &message.operation_network;
        let folder = NodeId::string(&self.uri, FOLDER_ID);
        self.nodes.push(
            Node::new(folder.clone(), browse_name(FOLDER_NAME, false), NodeClass::Object)
                .with(ns0::HAS_TYPE_DEFINITION, ns0::FOLDER_TYPE)
                .with_inverse(ns0::ORGANIZES, ns0::OBJECTS_FOLDER),
        );
        let path = Path::interface(&network.operation_network_id);
        let received = self.instance.received_at;
        let name = self.name(network.operation_network_id.as_str());
        self.object(&path, name, asi_types::INTERFACE_TYPE, (ns0::ORGANIZES, folder), |part| {
            match part {
                "CollaborationId" => text(message.collaboration_id.as_str()),
                "Revision" => Some(message.revision.into()),
                "ReceivedTime" => received.map(Into::into),
                _ => None,
            }
        });
        let inner = path.part("OperationNetwork");
        let parent = (ns0::HAS_COMPONENT, self.id(&path));
        let name = browse_name("OperationNetwork", false);
        self.object(&inner, name, asi_types::OPERATION_NETWORK_TYPE, parent, |part| match part {
            "OperationNetworkId" => text(network.operation_network_id.as_str()),
            "Name" => optional(network.name.as_deref()),
            "Description" => optional(network.description.as_deref()),
            _ => None,
        });
        for operation in &network.operation_list {
            self.operation(&path, &inner, operation);
        }
        for relation in &network.operation_relation_list {
            self.relation(&path, &inner, relation);
        }
    }

    fn operation(&mut self, interface: &Path, parent: &Path, operation: &Operation) {
        let path = interface.operation(&operation.operation_id);
        let type_id = match operation.kind {
            OperationKind::Production { .. } => asi_types::PRODUCTION_OPERATION_TYPE,
            OperationKind::Inspection { .. } => asi_types::INSPECTION_OPERATION_TYPE,
            OperationKind::Transportation { .. } => asi_types::TRANSPORTATION_OPERATION_TYPE,
        };
        let name = self.name(operation.operation_id.as_str());
        self.operations.insert(operation.operation_id.clone(), self.nodes.len());
        let parent = (asi(asi_types::HAS_OPERATION), self.id(parent));
        self.object(&path, name, type_id, parent, |part| operation_part(operation, part));
        // A unit without a quantity is kept at a variable without a value.
        let has_quantity =
            operation.planned_quantity.is_some() || operation.quantity_unit.is_some();
        if let Some(part) =
            parts_of_type(type_id).find(|part| has_quantity && part.name == "PlannedQuantity")
        {
            self.part(&path, part, operation.planned_quantity.map_or(Variant::Null, Into::into));
            if let Some(unit) = &operation.quantity_unit {
                self.unit(&path.part(part.name), unit);
            }
        }
        for requirement in &operation.equipment_requirement_list {
            let name = self.name(requirement.equipment_requirement_id.as_str());
            let parent = (ns0::HAS_COMPONENT, self.id(&path));
            let below = path.requirement(&requirement.equipment_requirement_id);
            self.object(&below, name, asi_types::EQUIPMENT_REQUIREMENT_TYPE, parent, |part| {
                match part {
                    "EquipmentRequirementId" => text(requirement.equipment_requirement_id.as_str()),
                    "EquipmentType" => text(&requirement.equipment_type),
                    "Capability" => optional(requirement.capability.as_deref()),
                    "Quantity" => requirement.quantity.map(Into::into),
                    "AssetId" => requirement.asset_id.as_ref().and_then(|id| text(id.as_str())),
                    _ => None,
                }
            });
        }
        for request in &operation.dynamic_data_request_list {
            self.request(&path, operation, request);
        }
    }

    fn request(
        &mut self,
        operation_path: &Path,
        operation: &Operation,
        request: &DynamicDataRequest,
    ) {
        let key = RequestKey {
            operation_network_id: self
                .instance
                .message
                .operation_network
                .operation_network_id
                .clone(),
            operation_id: operation.operation_id.clone(),
            dynamic_data_request_id: request.dynamic_data_request_id.clone(),
        };
        let writer = self.instance.writers.get(&key).copied();
        let path = operation_path.request(&request.dynamic_data_request_id);
        let name = self.name(request.dynamic_data_request_id.as_str());
        let parent = (ns0::HAS_COMPONENT, self.id(operation_path));
        self.object(&path, name, asi_types::DYNAMIC_DATA_REQUEST_TYPE, parent, |part| match part {
            "DataSetWriterId" => writer.map(Into::into),
            part => request_part(request, part),
        });
        let format = path.part("ReportDataFormat");
        let parent = (ns0::HAS_COMPONENT, self.id(&path));
        let name = browse_name("ReportDataFormat", false);
        self.object(&format, name, asi_types::REPORT_DATA_FORMAT_TYPE, parent, |part| {
            (part == "ReportName").then(|| request.report_data_format.report_name.as_str().into())
        });
        for field in &request.report_data_format.report_field_list {
            let state = self
                .instance
                .fields
                .get(&key.field(field.name.clone()))
                .cloned()
                .unwrap_or_default();
            self.field(&path.field(&field.name), &format, field, &state);
        }
    }

    fn field(&mut self, path: &Path, parent: &Path, field: &ReportField, state: &FieldState) {
        let data_type = match field.field_type.0 {
            // BaseDataType is the data type of what may be anything.
            BuiltInType::Variant => 24,
            built_in => u32::from(built_in.id()),
        };
        let class = NodeClass::Variable {
            data_type: NodeId::ua(data_type),
            value_rank: field.value_rank,
            value: state.value.clone(),
            is_writable: false,
        };
        let mut node = Node::new(self.id(path), self.name(field.name.as_str()), class)
            .with(ns0::HAS_TYPE_DEFINITION, ns0::BASE_DATA_VARIABLE_TYPE)
            .with_inverse(ns0::HAS_COMPONENT, self.id(parent));
        node.description.clone_from(&field.description);
        self.nodes.push(node);
        if let Some(unit) = &field.unit {
            self.unit(path, unit);
        }
        let optional = |text: Option<&str>| text.map(Variant::from);
        for part in &asi_types::FIELD_PARTS {
            let value = match part.name {
                "IsMapped" => Some((state.mapping_state == MappingState::Mapped).into()),
                "MappingState" => Some((state.mapping_state as i32).into()),
                "ValueSource" => state.value_source.map(|source| (source as i32).into()),
                "Semantic" => field.semantic.as_ref().map(|semantic| semantic.as_str().into()),
                "Disclosure" => optional(state.disclosure.as_deref()),
                "DecisionReason" => optional(state.reason.as_deref()),
                "DecidedBy" => optional(state.decided_by.as_deref()),
                "DecisionTime" => state.decision_time.map(Into::into),
                _ => None,
            };
            if let Some(value) = value {
                self.part(path, part, value);
            }
        }
    }

    fn relation(&mut self, interface: &Path, parent: &Path, relation: &OperationRelation) {
        let path = interface.relation(&relation.operation_relation_id);
        let name = self.name(relation.operation_relation_id.as_str());
        let parent = (ns0::HAS_COMPONENT, self.id(parent));
        self.object(&path, name, asi_types::OPERATION_RELATION_TYPE, parent, |part| match part {
            "OperationRelationId" => text(relation.operation_relation_id.as_str()),
            "RelationType" => Some((relation.relation_type as i32).into()),
            "PredecessorOperationId" => text(relation.predecessor_operation_id.as_str()),
            "SuccessorOperationId" => text(relation.successor_operation_id.as_str()),
            _ => None,
        });
        for condition in &relation.condition_list {
            let name = self.name(condition.condition_id.as_str());
            let parent = (ns0::HAS_COMPONENT, self.id(&path));
            let below = path.condition(&condition.condition_id);
            self.object(&below, name, asi_types::RELATION_CONDITION_TYPE, parent, |part| {
                condition_part(condition, part)
            });
        }
        // The arrow that clients follow from operation to operation.
        let to = self.id(&interface.operation(&relation.successor_operation_id));
        let arrow = asi(asi_types::dependency(relation.relation_type));
        if let Some(at) = self.operations.get(&relation.predecessor_operation_id) {
            let node = &mut self.nodes[*at];
            node.references.push(crate::node_set::Reference {
                reference_type: arrow,
                target: to,
                is_forward: true,
            });
        }
    }
}

fn operation_part(operation: &Operation, part: &str) -> Option<Variant> {
    match (part, &operation.kind) {
        ("OperationId", _) => text(operation.operation_id.as_str()),
        ("Name", _) => optional(operation.name.as_deref()),
        ("Description", _) => optional(operation.description.as_deref()),
        ("OwningFactoryId", _) => {
            operation.owning_factory_id.as_ref().and_then(|id| text(id.as_str()))
        }
        ("PlannedStart", _) => operation.planned_start.map(Into::into),
        ("PlannedEnd", _) => operation.planned_end.map(Into::into),
        ("ProductId", OperationKind::Production { product_id }) => optional(product_id.as_deref()),
        ("InspectedOperationId", OperationKind::Inspection { inspected_operation_id, .. }) => {
            inspected_operation_id.as_ref().and_then(|id| text(id.as_str()))
        }
        ("Characteristic", OperationKind::Inspection { characteristic, .. }) => {
            optional(characteristic.as_deref())
        }
        ("Origin", OperationKind::Transportation { origin, .. }) => optional(origin.as_deref()),
        ("Destination", OperationKind::Transportation { destination, .. }) => {
            optional(destination.as_deref())
        }
        _ => None,
    }
}

fn request_part(request: &DynamicDataRequest, part: &str) -> Option<Variant> {
    match part {
        "DynamicDataRequestId" => text(request.dynamic_data_request_id.as_str()),
        "DynamicDataRequestPublisherId" => {
            request.dynamic_data_request_publisher_id.as_ref().and_then(|id| text(id.as_str()))
        }
        "RequesterId" => text(request.requester_id.as_str()),
        "Recipients" => {
            let elements = request.recipient_list.iter().map(|id| id.as_str().into()).collect();
            Some(Variant::Array(Arc::new(Array {
                element_type: BuiltInType::String,
                elements,
                dimensions: None,
            })))
        }
        "Purpose" => text(&request.purpose),
        "ValidFrom" => request.valid_from.map(Into::into),
        "ValidUntil" => request.valid_until.map(Into::into),
        "Description" => optional(request.description.as_deref()),
        "BufferId" => optional(request.buffer_id.as_deref()),
        "UpdateFrequency" => request.update_frequency.map(Into::into),
        "UpdateFrequencyUnit" => request.update_frequency_unit.map(|unit| (unit as i32).into()),
        _ => None,
    }
}

fn condition_part(condition: &RelationCondition, part: &str) -> Option<Variant> {
    match part {
        "ConditionId" => text(condition.condition_id.as_str()),
        "ConditionKind" => Some((condition.condition_kind as i32).into()),
        "Time" => condition.time.map(Into::into),
        "Duration" => condition.duration.map(|duration| duration.as_milliseconds().into()),
        _ => None,
    }
}
