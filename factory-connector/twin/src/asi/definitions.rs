//! Values of the properties that the operation network defines: ids, names, plans, relations.

use asi_model::{DateTime, network::OperationKind};
use opcua_stack::{opcua::types::Variant, values::time_to_stack};

use super::{interface::Interface, node_address::NodeAddress};

/// Returns the value of a property that the network defines itself; none when it is absent.
pub(super) fn property(interface: &Interface, address: NodeAddress, name: &str) -> Option<Variant> {
    match address {
        NodeAddress::Interface => of_interface(interface, name),
        NodeAddress::OperationNetwork => {
            let network = interface.network();
            match name {
                "OperationNetworkId" => text(network.operation_network_id.as_str()),
                "Name" => optional_text(network.name.as_ref()),
                "Description" => optional_text(network.description.as_ref()),
                _ => None,
            }
        }
        NodeAddress::Operation(operation) => of_operation(interface, operation, name),
        NodeAddress::Requirement(operation, index) => {
            of_requirement(interface, operation, index, name)
        }
        NodeAddress::Relation(relation) => of_relation(interface, relation, name),
        NodeAddress::Condition(relation, index) => of_condition(interface, relation, index, name),
        NodeAddress::Request(request) => of_request(interface, request, name),
        NodeAddress::ReportDataFormat(request) => match name {
            "ReportName" => text(&interface.request(request).report_data_format.report_name),
            _ => None,
        },
        NodeAddress::Field(_) => None,
    }
}

fn of_interface(interface: &Interface, name: &str) -> Option<Variant> {
    match name {
        "CollaborationId" => text(interface.message.collaboration_id.as_str()),
        "Revision" => Some(interface.message.revision.into()),
        "ReceivedTime" => Some(time(interface.received_at)),
        _ => None,
    }
}

fn of_operation(interface: &Interface, operation: u32, name: &str) -> Option<Variant> {
    let operation = interface.operation(operation);
    match name {
        "OperationId" => text(operation.operation_id.as_str()),
        "Name" => optional_text(operation.name.as_ref()),
        "Description" => optional_text(operation.description.as_ref()),
        "OwningFactoryId" => operation.owning_factory_id.as_ref().and_then(|id| text(id.as_str())),
        "PlannedStart" => operation.planned_start.map(time),
        "PlannedEnd" => operation.planned_end.map(time),
        "PlannedQuantity" => operation.planned_quantity.map(Variant::from),
        _ => match &operation.kind {
            OperationKind::Production { product_id } if name == "ProductId" => {
                optional_text(product_id.as_ref())
            }
            OperationKind::Inspection { inspected_operation_id: Some(id), .. }
                if name == "InspectedOperationId" =>
            {
                text(id.as_str())
            }
            OperationKind::Inspection { characteristic, .. } if name == "Characteristic" => {
                optional_text(characteristic.as_ref())
            }
            OperationKind::Transportation { origin, .. } if name == "Origin" => {
                optional_text(origin.as_ref())
            }
            OperationKind::Transportation { destination, .. } if name == "Destination" => {
                optional_text(destination.as_ref())
            }
            _ => None,
        },
    }
}

fn of_requirement(
    interface: &Interface,
    operation: u32,
    index: u32,
    name: &str,
) -> Option<Variant> {
    let requirement = &interface.operation(operation).equipment_requirement_list[index as usize];
    match name {
        "EquipmentRequirementId" => text(requirement.equipment_requirement_id.as_str()),
        "EquipmentType" => text(&requirement.equipment_type),
        "Capability" => optional_text(requirement.capability.as_ref()),
        "Quantity" => requirement.quantity.map(Variant::from),
        "AssetId" => requirement.asset_id.as_ref().and_then(|id| text(id.as_str())),
        _ => None,
    }
}

fn of_relation(interface: &Interface, relation: u32, name: &str) -> Option<Variant> {
    let relation = interface.relation(relation);
    match name {
        "OperationRelationId" => text(relation.operation_relation_id.as_str()),
        "RelationType" => Some((relation.relation_type as i32).into()),
        "PredecessorOperationId" => text(relation.predecessor_operation_id.as_str()),
        "SuccessorOperationId" => text(relation.successor_operation_id.as_str()),
        _ => None,
    }
}

fn of_condition(interface: &Interface, relation: u32, index: u32, name: &str) -> Option<Variant> {
    let condition = &interface.relation(relation).condition_list[index as usize];
    match name {
        "ConditionId" => text(condition.condition_id.as_str()),
        "ConditionKind" => Some((condition.condition_kind as i32).into()),
        "Time" => condition.time.map(time),
        "Duration" => condition.duration.map(|duration| (duration.0.as_secs_f64() * 1000.0).into()),
        _ => None,
    }
}

fn of_request(interface: &Interface, number: u32, name: &str) -> Option<Variant> {
    let request = interface.request(number);
    match name {
        "DynamicDataRequestId" => text(request.dynamic_data_request_id.as_str()),
        "DynamicDataRequestPublisherId" => {
            request.dynamic_data_request_publisher_id.as_ref().and_then(|id| text(id.as_str()))
        }
        "RequesterId" => text(request.requester_id.as_str()),
        "Recipients" => {
            let recipients: Vec<String> =
                request.recipient_list.iter().map(ToString::to_string).collect();
            Some(recipients.into())
        }
        "Purpose" => text(&request.purpose),
        "ValidFrom" => request.valid_from.map(time),
        "ValidUntil" => request.valid_until.map(time),
        "Description" => optional_text(request.description.as_ref()),
        "BufferId" => optional_text(request.buffer_id.as_ref()),
        "UpdateFrequency" => request.update_frequency.map(Variant::from),
        "UpdateFrequencyUnit" => request.update_frequency_unit.map(|unit| (unit as i32).into()),
        "DataSetWriterId" => interface.slot(number).data_set_writer_id.map(Variant::from),
        _ => None,
    }
}

fn text(text: &str) -> Option<Variant> {
    Some(Variant::from(text))
}

fn optional_text(text: Option<&String>) -> Option<Variant> {
    text.map(|text| Variant::from(text.as_str()))
}

fn time(time: DateTime) -> Variant {
    time_to_stack(time).into()
}
