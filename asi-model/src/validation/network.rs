//! Reading operation networks, and the rules on them as a whole.

use std::collections::{HashMap, HashSet};

use super::{
    FaultCode, LIST_MAX, OPERATIONS_MAX, RELATIONS_MAX, acyclic, conditions, lists::not_empty,
    operations, reader::Reader, report_format,
};
use crate::{
    ids::{FactoryId, OperationId},
    json::{JsonNode, Kind},
    network::{
        ConditionKind, Operation, OperationKind, OperationNetwork, OperationRelation,
        RelationCondition, RelationType,
    },
};

const RELATION_TYPES: [(&str, RelationType); 4] = [
    ("FINISH_TO_START", RelationType::FinishToStart),
    ("START_TO_START", RelationType::StartToStart),
    ("FINISH_TO_FINISH", RelationType::FinishToFinish),
    ("START_TO_FINISH", RelationType::StartToFinish),
];
const CONDITION_KINDS: [(&str, ConditionKind); 6] = [
    ("START_NO_EARLIER_THAN", ConditionKind::StartNoEarlierThan),
    ("START_NO_LATER_THAN", ConditionKind::StartNoLaterThan),
    ("FINISH_NO_EARLIER_THAN", ConditionKind::FinishNoEarlierThan),
    ("FINISH_NO_LATER_THAN", ConditionKind::FinishNoLaterThan),
    ("MINIMUM_GAP", ConditionKind::MinimumGap),
    ("MAXIMUM_GAP", ConditionKind::MaximumGap),
];

pub(super) fn read(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<OperationNetwork> {
    if !reader.is_object(node, "An operation network") {
        return None;
    }
    not_empty(reader, node, "operationList");
    let is_listed = |list: JsonNode<'_, '_>| {
        list.kind() == Kind::Array && list.elements().count() <= OPERATIONS_MAX
    };
    reader.has_unreadable_operations = !node.get("operationList").is_some_and(is_listed);
    Some(OperationNetwork {
        operation_network_id: reader.required_id(node, "operationNetworkId"),
        name: reader.optional(node, "name", Reader::name),
        description: reader.optional(node, "description", Reader::text),
        operation_list: reader.list(node, "operationList", OPERATIONS_MAX, operations::operation),
        operation_relation_list: reader.optional_list(
            node,
            "operationRelationList",
            RELATIONS_MAX,
            relation,
        ),
    })
}

fn relation(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<OperationRelation> {
    if !reader.is_object(node, "An operation relation") {
        return Some(OperationRelation {
            operation_relation_id: reader.placeholder(),
            relation_type: RelationType::FinishToStart,
            predecessor_operation_id: reader.placeholder(),
            successor_operation_id: reader.placeholder(),
            condition_list: Vec::new(),
        });
    }
    Some(OperationRelation {
        operation_relation_id: reader.required_id(node, "operationRelationId"),
        relation_type: reader
            .required(node, "relationType", |reader, node| reader.choice(node, &RELATION_TYPES))
            .unwrap_or(RelationType::FinishToStart),
        predecessor_operation_id: reader.required_id(node, "predecessorOperationId"),
        successor_operation_id: reader.required_id(node, "successorOperationId"),
        condition_list: reader.optional_list(node, "conditionList", LIST_MAX, condition),
    })
}

fn condition(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<RelationCondition> {
    if !reader.is_object(node, "A condition") {
        return Some(RelationCondition {
            condition_id: reader.placeholder(),
            condition_kind: ConditionKind::StartNoEarlierThan,
            time: None,
            duration: None,
        });
    }
    let kind = reader
        .required(node, "conditionKind", |reader, node| reader.choice(node, &CONDITION_KINDS));
    let time = reader.optional(node, "time", Reader::time);
    let duration = reader.optional(node, "duration", |reader, node| {
        reader.parsed(node, "an ISO 8601 duration as PT8H or P1DT30M")
    });
    let condition_id = reader.required_id(node, "conditionId");
    if let Some(kind) = kind {
        // Judged by what is written, so that an unreadable bound is not called missing.
        let has = |name: &str| node.get(name).is_some_and(|bound| !bound.is_null());
        conditions::check_bound(kind, has("time"), has("duration"), &node.pointer(), reader);
    }
    Some(RelationCondition {
        condition_id,
        condition_kind: kind.unwrap_or(ConditionKind::StartNoEarlierThan),
        time,
        duration,
    })
}

/// The meaning of a network: `part_of` is the factory whose part it is, if it is one.
pub(super) fn check(
    network: &OperationNetwork,
    pointer: &str,
    part_of: Option<&FactoryId>,
    reader: &mut Reader,
) {
    check_ids(network, pointer, reader);
    let operations: HashMap<&OperationId, usize> = network
        .operation_list
        .iter()
        .enumerate()
        .map(|(index, operation)| (&operation.operation_id, index))
        .collect();
    for (index, operation) in network.operation_list.iter().enumerate() {
        let pointer = format!("{pointer}/operationList/{index}");
        check_operation(operation, &pointer, part_of, &operations, reader);
        for (number, request) in operation.dynamic_data_request_list.iter().enumerate() {
            report_format::check(
                request,
                &format!("{pointer}/dynamicDataRequestList/{number}"),
                reader,
            );
        }
    }
    for (index, relation) in network.operation_relation_list.iter().enumerate() {
        let pointer = format!("{pointer}/operationRelationList/{index}");
        check_relation(relation, &pointer, &operations, reader);
        conditions::check(relation, &pointer, reader);
    }
    let is_acyclic = acyclic::check(network, &operations, pointer, reader);
    if is_acyclic && !reader.faults.concern(|place| is_about_times(place, pointer)) {
        conditions::check_feasible(network, pointer, reader);
    }
}

/// True for the place of a fault that makes the time frames uncertain: in the relations, or at the
/// id or a planned time of an operation.
fn is_about_times(place: &str, network: &str) -> bool {
    let Some(place) = place.strip_prefix(network) else { return false };
    let mut names = place.split('/').skip(1);
    match (names.next(), names.next(), names.next()) {
        (Some("operationList"), Some(_), Some(member)) => {
            ["operationId", "plannedStart", "plannedEnd"].contains(&member)
        }
        (Some("operationList" | "operationRelationList") | None, ..) => true,
        _ => false,
    }
}

fn check_ids(network: &OperationNetwork, pointer: &str, reader: &mut Reader) {
    let mut operations = Unique::new("operation");
    let mut relations = Unique::new("relation");
    let mut conditions = Unique::new("condition");
    let mut requirements = Unique::new("equipment requirement");
    let mut requests = Unique::new("dynamic data request");
    for (index, operation) in network.operation_list.iter().enumerate() {
        let pointer = format!("{pointer}/operationList/{index}");
        operations.check(
            operation.operation_id.as_str(),
            || format!("{pointer}/operationId"),
            reader,
        );
        for (number, requirement) in operation.equipment_requirement_list.iter().enumerate() {
            requirements.check(
                requirement.equipment_requirement_id.as_str(),
                || format!("{pointer}/equipmentRequirementList/{number}/equipmentRequirementId"),
                reader,
            );
        }
        for (number, request) in operation.dynamic_data_request_list.iter().enumerate() {
            requests.check(
                request.dynamic_data_request_id.as_str(),
                || format!("{pointer}/dynamicDataRequestList/{number}/dynamicDataRequestId"),
                reader,
            );
        }
    }
    for (index, relation) in network.operation_relation_list.iter().enumerate() {
        let pointer = format!("{pointer}/operationRelationList/{index}");
        relations.check(
            relation.operation_relation_id.as_str(),
            || format!("{pointer}/operationRelationId"),
            reader,
        );
        for (number, condition) in relation.condition_list.iter().enumerate() {
            conditions.check(
                condition.condition_id.as_str(),
                || format!("{pointer}/conditionList/{number}/conditionId"),
                reader,
            );
        }
    }
}

struct Unique<'n> {
    kind: &'static str,
    seen: HashSet<&'n str>,
}

impl<'n> Unique<'n> {
    fn new(kind: &'static str) -> Self {
        Self { kind, seen: HashSet::new() }
    }

    fn check(&mut self, id: &'n str, pointer: impl FnOnce() -> String, reader: &mut Reader) {
        if !self.seen.insert(id) {
            let message = format!(
                "The network already has the {} {id}; ids must be unique within a network.",
                self.kind
            );
            reader.faults.push(pointer(), FaultCode::DuplicateId, message);
        }
    }
}

fn check_operation(
    operation: &Operation,
    pointer: &str,
    part_of: Option<&FactoryId>,
    operations: &HashMap<&OperationId, usize>,
    reader: &mut Reader,
) {
    if let (Some(start), Some(end)) = (operation.planned_start, operation.planned_end)
        && start > end
    {
        let message = "The operation ends before it begins: \
                       plannedEnd must not be earlier than plannedStart.";
        reader.faults.push(format!("{pointer}/plannedEnd"), FaultCode::TimeFrameInverted, message);
    }
    if let Some(unit) = &operation.quantity_unit {
        report_format::check_unit(unit, || format!("{pointer}/quantityUnit"), reader);
    }
    check_owner(operation, pointer, part_of, reader);
    if let OperationKind::Inspection { inspected_operation_id: Some(inspected), .. } =
        &operation.kind
    {
        let pointer = || format!("{pointer}/inspectedOperationId");
        if *inspected == operation.operation_id {
            reader.faults.push(
                pointer(),
                FaultCode::SelfReference,
                "An operation cannot inspect itself.",
            );
        } else {
            check_known(inspected, pointer, operations, reader);
        }
    }
}

fn check_owner(
    operation: &Operation,
    pointer: &str,
    part_of: Option<&FactoryId>,
    reader: &mut Reader,
) {
    let id = &operation.operation_id;
    if operation.stub {
        if operation.owning_factory_id.is_none() {
            let message =
                format!("The operation {id} is a stub and must name its owningFactoryId.");
            reader.faults.push(
                format!("{pointer}/owningFactoryId"),
                FaultCode::OwnerMissing,
                message,
            );
        }
        let details = [
            ("dynamicDataRequestList", operation.dynamic_data_request_list.is_empty()),
            ("equipmentRequirementList", operation.equipment_requirement_list.is_empty()),
        ];
        for (member, _) in details.into_iter().filter(|(_, is_empty)| !is_empty) {
            let message = format!("The operation {id} is a stub and must not have a {member}.");
            reader.faults.push(format!("{pointer}/{member}"), FaultCode::StubTooDetailed, message);
        }
    } else if let (Some(factory), Some(owner)) = (part_of, &operation.owning_factory_id)
        && owner != factory
    {
        let message = format!(
            "The operation {id} belongs to {owner}; in this factory's part it must be a stub."
        );
        reader.faults.push(format!("{pointer}/owningFactoryId"), FaultCode::WrongOwner, message);
    }
}

fn check_relation(
    relation: &OperationRelation,
    pointer: &str,
    operations: &HashMap<&OperationId, usize>,
    reader: &mut Reader,
) {
    let ends = [
        ("predecessorOperationId", &relation.predecessor_operation_id),
        ("successorOperationId", &relation.successor_operation_id),
    ];
    for (member, id) in ends {
        check_known(id, || format!("{pointer}/{member}"), operations, reader);
    }
    if relation.predecessor_operation_id == relation.successor_operation_id {
        let message = "A relation must connect two different operations.";
        reader.faults.push(
            format!("{pointer}/successorOperationId"),
            FaultCode::SelfReference,
            message,
        );
    }
}

fn check_known(
    id: &OperationId,
    pointer: impl FnOnce() -> String,
    operations: &HashMap<&OperationId, usize>,
    reader: &mut Reader,
) {
    // Where an operation's id could not be read, it may be the one meant.
    let is_uncertain = reader.has_unreadable_operations || reader.is_placeholder(id.as_str());
    if !is_uncertain && !operations.contains_key(id) {
        let message = format!("The network has no operation {id}; add it, or a stub of it.");
        reader.faults.push(pointer(), FaultCode::UnknownOperation, message);
    }
}
