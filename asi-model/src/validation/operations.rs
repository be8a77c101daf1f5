//! Reading operations and their equipment.

use super::{LIST_MAX, reader::Reader, report_format};
use crate::{
    ids::OperationId,
    json::JsonNode,
    network::{EquipmentRequirement, Operation, OperationKind},
};

pub(super) fn operation(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<Operation> {
    if !reader.is_object(node, "An operation") {
        return Some(unreadable(reader));
    }
    let operation_id: OperationId = reader.required_id(node, "operationId");
    reader.has_unreadable_operations |= reader.is_placeholder(operation_id.as_str());
    Some(Operation {
        operation_id,
        kind: kind(reader, node),
        name: reader.optional(node, "name", Reader::name),
        description: reader.optional(node, "description", Reader::text),
        stub: reader.optional(node, "stub", Reader::boolean).unwrap_or(false),
        owning_factory_id: reader.optional(node, "owningFactoryId", Reader::id),
        planned_start: reader.optional(node, "plannedStart", Reader::time),
        planned_end: reader.optional(node, "plannedEnd", Reader::time),
        planned_quantity: reader.optional(node, "plannedQuantity", Reader::quantity),
        quantity_unit: reader.optional(node, "quantityUnit", Reader::name),
        equipment_requirement_list: reader.optional_list(
            node,
            "equipmentRequirementList",
            LIST_MAX,
            equipment,
        ),
        dynamic_data_request_list: reader.optional_list(
            node,
            "dynamicDataRequestList",
            LIST_MAX,
            report_format::request,
        ),
    })
}

/// An operation that stands for something else in the list.
fn unreadable(reader: &mut Reader) -> Operation {
    reader.has_unreadable_operations = true;
    Operation {
        operation_id: reader.placeholder(),
        kind: OperationKind::Production { product_id: None },
        name: None,
        description: None,
        stub: false,
        owning_factory_id: None,
        planned_start: None,
        planned_end: None,
        planned_quantity: None,
        quantity_unit: None,
        equipment_requirement_list: Vec::new(),
        dynamic_data_request_list: Vec::new(),
    }
}

fn kind(reader: &mut Reader, node: JsonNode<'_, '_>) -> OperationKind {
    #[derive(Clone)]
    enum Kind {
        Production,
        Inspection,
        Transportation,
    }
    const TYPES: [(&str, Kind); 3] = [
        ("PRODUCTION", Kind::Production),
        ("INSPECTION", Kind::Inspection),
        ("TRANSPORTATION", Kind::Transportation),
    ];
    match reader.required(node, "operationType", |reader, node| reader.choice(node, &TYPES)) {
        Some(Kind::Inspection) => OperationKind::Inspection {
            inspected_operation_id: reader.optional(node, "inspectedOperationId", Reader::id),
            characteristic: reader.optional(node, "characteristic", Reader::name),
        },
        Some(Kind::Transportation) => OperationKind::Transportation {
            origin: reader.optional(node, "origin", Reader::name),
            destination: reader.optional(node, "destination", Reader::name),
        },
        Some(Kind::Production) | None => OperationKind::Production {
            product_id: reader.optional(node, "productId", Reader::name),
        },
    }
}

fn equipment(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<EquipmentRequirement> {
    if !reader.is_object(node, "An equipment requirement") {
        return Some(EquipmentRequirement {
            equipment_requirement_id: reader.placeholder(),
            equipment_type: String::new(),
            capability: None,
            quantity: None,
            asset_id: None,
        });
    }
    Some(EquipmentRequirement {
        equipment_requirement_id: reader.required_id(node, "equipmentRequirementId"),
        equipment_type: reader.required(node, "equipmentType", Reader::name).unwrap_or_default(),
        capability: reader.optional(node, "capability", Reader::text),
        quantity: reader.optional(node, "quantity", Reader::quantity),
        asset_id: reader.optional(node, "assetId", Reader::id),
    })
}
