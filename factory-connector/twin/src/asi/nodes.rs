//! Nodes of interfaces, computed from addresses and parts.

use asi_model::{instance::FOLDER_NAME, messages::OperationNetworkMessage, network::ReportField};
use opcua_stack::opcua::types::{LocalizedText, NodeId, QualifiedName, VariableTypeId};

use super::{
    data_types::{built_in_type_id, data_type_id},
    interface::Interface,
    model::{self, Part, PartKind, ValueType},
    node_address::NodeAddress,
    node_ids::NodeIds,
    types::folder_type,
};
use crate::provider::{NodeKind, ProvidedNode};

/// Returns the folder of all interfaces, or a property of it.
pub(super) fn folder(ids: NodeIds, part: Option<&'static Part>) -> ProvidedNode {
    match part {
        Some(part) => self::part(ids, part, None),
        None => ProvidedNode {
            browse_name: QualifiedName::new(ids.instances, FOLDER_NAME),
            display_name: LocalizedText::from("Collaborative Process Twin"),
            description: LocalizedText::new(
                "en",
                "Every operation network that concerns this factory.",
            ),
            type_definition: Some(folder_type()),
            class: NodeKind::Object,
        },
    }
}

/// Returns an object or a field's variable.
pub(super) fn object_or_field(
    ids: NodeIds,
    interface: &Interface,
    address: NodeAddress,
) -> ProvidedNode {
    let message: &OperationNetworkMessage = &interface.message;
    let network = &message.operation_network;
    let instance = |id: &str, name: Option<&String>, description: Option<&String>| ProvidedNode {
        browse_name: QualifiedName::new(ids.instances, id),
        display_name: LocalizedText::from(name.map_or(id, String::as_str)),
        description: description.map_or_else(LocalizedText::null, LocalizedText::from),
        type_definition: interface.type_of(address).map(|id| ids.type_id(id)),
        class: NodeKind::Object,
    };
    let fixed = |name: &str| ProvidedNode {
        browse_name: QualifiedName::new(ids.types, name),
        ..instance(name, None, None)
    };
    match address {
        NodeAddress::Interface => instance(
            network.operation_network_id.as_str(),
            network.name.as_ref(),
            network.description.as_ref(),
        ),
        NodeAddress::OperationNetwork => fixed("OperationNetwork"),
        NodeAddress::Operation(operation) => {
            let operation = interface.operation(operation);
            instance(
                operation.operation_id.as_str(),
                operation.name.as_ref(),
                operation.description.as_ref(),
            )
        }
        NodeAddress::Requirement(operation, index) => {
            let requirement =
                &interface.operation(operation).equipment_requirement_list[index as usize];
            instance(requirement.equipment_requirement_id.as_str(), None, None)
        }
        NodeAddress::Relation(relation) => {
            instance(interface.relation(relation).operation_relation_id.as_str(), None, None)
        }
        NodeAddress::Condition(relation, index) => instance(
            interface.relation(relation).condition_list[index as usize].condition_id.as_str(),
            None,
            None,
        ),
        NodeAddress::Request(request) => {
            let request = interface.request(request);
            instance(request.dynamic_data_request_id.as_str(), None, request.description.as_ref())
        }
        NodeAddress::ReportDataFormat(_) => fixed("ReportDataFormat"),
        NodeAddress::Field(field) => {
            let definition = interface.field(field).1;
            let is_writable = interface.records.read()[field as usize].is_writable();
            ProvidedNode {
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

/// Returns a property, component variable or method; `unit` is that of a component variable.
pub(super) fn part(ids: NodeIds, part: &Part, unit: Option<&str>) -> ProvidedNode {
    let variable = |value: ValueType| NodeKind::Variable {
        data_type: data_type_id(value.data_type, ids.types),
        value_rank: value.value_rank,
        is_writable: false,
    };
    let (class, type_definition) = match part.kind {
        PartKind::Property(value) => (variable(value), Some(model::PROPERTY_TYPE.into())),
        PartKind::Component(value) if unit.is_some() => {
            (variable(value), Some(VariableTypeId::AnalogUnitType.into()))
        }
        PartKind::Component(value) => {
            (variable(value), Some(VariableTypeId::BaseDataVariableType.into()))
        }
        PartKind::Object(id) => (NodeKind::Object, Some(ids.type_id(id))),
        PartKind::Method(_) => {
            (NodeKind::Method { callable_by: model::callable_by(part.name) }, None)
        }
    };
    ProvidedNode {
        browse_name: QualifiedName::new(if part.is_standard { 0 } else { ids.types }, part.name),
        display_name: LocalizedText::from(part.name),
        description: LocalizedText::null(),
        type_definition,
        class,
    }
}

/// Returns the type definition of a field's variable: AnalogUnitType if it is a number with a unit.
pub(super) fn field_type(definition: &ReportField) -> NodeId {
    if definition.unit.is_some() && definition.field_type.0.is_numeric() {
        VariableTypeId::AnalogUnitType.into()
    } else {
        VariableTypeId::BaseDataVariableType.into()
    }
}
