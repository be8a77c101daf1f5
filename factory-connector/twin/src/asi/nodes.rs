//! What the nodes of interfaces are, computed from places and parts.

use asi_model::{instance::FOLDER_NAME, messages::OperationNetworkMessage, network::ReportField};
use opcua_stack::opcua::types::{LocalizedText, NodeId, QualifiedName, VariableTypeId};

use super::{
    interface::Interface,
    model::{self, Part, PartKind, ValueType},
    parts::{built_in_type_id, data_type_id},
    place::Place,
    provider::AsiProvider,
    types::folder_type,
};
use crate::provider::{Node, NodeKind};

impl AsiProvider {
    pub(super) fn folder_node(&self, part: Option<&'static Part>) -> Node {
        match part {
            Some(part) => self.part_node(part, None),
            None => Node {
                browse_name: QualifiedName::new(self.instances, FOLDER_NAME),
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

    pub(super) fn place_node(&self, interface: &Interface, place: Place) -> Node {
        let message: &OperationNetworkMessage = &interface.message;
        let network = &message.operation_network;
        let instance = |id: &str, name: Option<&String>, description: Option<&String>| Node {
            browse_name: QualifiedName::new(self.instances, id),
            display_name: LocalizedText::from(name.map_or(id, String::as_str)),
            description: description.map_or_else(LocalizedText::null, LocalizedText::from),
            type_definition: interface.type_of(place).map(|id| self.type_id(id)),
            class: NodeKind::Object,
        };
        let fixed = |name: &str| Node {
            browse_name: QualifiedName::new(self.types, name),
            ..instance(name, None, None)
        };
        match place {
            Place::Interface => instance(
                network.operation_network_id.as_str(),
                network.name.as_ref(),
                network.description.as_ref(),
            ),
            Place::OperationNetwork => fixed("OperationNetwork"),
            Place::Operation(operation) => {
                let operation = interface.operation(operation);
                instance(
                    operation.operation_id.as_str(),
                    operation.name.as_ref(),
                    operation.description.as_ref(),
                )
            }
            Place::Requirement(operation, at) => {
                let requirement =
                    &interface.operation(operation).equipment_requirement_list[at as usize];
                instance(requirement.equipment_requirement_id.as_str(), None, None)
            }
            Place::Relation(relation) => {
                instance(interface.relation(relation).operation_relation_id.as_str(), None, None)
            }
            Place::Condition(relation, at) => instance(
                interface.relation(relation).condition_list[at as usize].condition_id.as_str(),
                None,
                None,
            ),
            Place::Request(request) => {
                let request = interface.request(request);
                instance(
                    request.dynamic_data_request_id.as_str(),
                    None,
                    request.description.as_ref(),
                )
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

    pub(super) fn part_node(&self, part: &Part, unit: Option<&str>) -> Node {
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
            PartKind::Component(value) => {
                (variable(value), Some(VariableTypeId::BaseDataVariableType.into()))
            }
            PartKind::Object(id) => (NodeKind::Object, Some(self.type_id(id))),
            PartKind::Method(_) => {
                (NodeKind::Method { callable_by: model::callable_by(part.name) }, None)
            }
        };
        Node {
            browse_name: QualifiedName::new(
                if part.is_standard { 0 } else { self.types },
                part.name,
            ),
            display_name: LocalizedText::from(part.name),
            description: LocalizedText::null(),
            type_definition,
            class,
        }
    }
}

/// AnalogUnitType where the field has a unit and a numeric type.
pub(super) fn field_type(definition: &ReportField) -> NodeId {
    if definition.unit.is_some() && definition.field_type.0.is_numeric() {
        VariableTypeId::AnalogUnitType.into()
    } else {
        VariableTypeId::BaseDataVariableType.into()
    }
}
