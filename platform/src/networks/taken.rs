//! Ids that a document uses although something else has them: hidden things, and former requests.

use std::collections::{HashMap, HashSet};

use asi_model::{DynamicDataRequestId, OrganisationId, messages::Fault, network::OperationNetwork};

use super::fault::fault;

/// Kinds of things whose ids are unique within a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum NamedKind {
    Operation,
    Equipment,
    Request,
    Relation,
    Condition,
}

/// Finds ids of the document that belong to what its author does not see, and request ids that
/// another organisation used before. `whole` and `shown` are the revision in force, and as the
/// author sees it. The faults tell no more than that the id cannot be used.
pub(super) fn faults(
    document: &OperationNetwork,
    revision: Option<(&OperationNetwork, &OperationNetwork)>,
    requesters: &HashMap<DynamicDataRequestId, OrganisationId>,
) -> Vec<Fault> {
    let mut taken = HashSet::new();
    let mut unchanged = HashSet::new();
    if let Some((whole, shown)) = revision {
        visit(whole, |kind, id, _| {
            taken.insert((kind, id));
        });
        visit(shown, |kind, id, _| {
            taken.remove(&(kind, id));
        });
        unchanged.extend(
            shown.requests().map(|(_, _, r)| (&r.dynamic_data_request_id, &r.requester_id)),
        );
    }
    let mut faults = Vec::new();
    visit(document, |kind, id, pointer| {
        if taken.contains(&(kind, id)) {
            faults.push(id_taken(pointer()));
        }
    });
    for (index, operation) in document.operation_list.iter().enumerate() {
        for (number, request) in operation.dynamic_data_request_list.iter().enumerate() {
            let id = &request.dynamic_data_request_id;
            let is_of_others =
                requesters.get(id).is_some_and(|requester| *requester != request.requester_id);
            if is_of_others
                && !unchanged.contains(&(id, &request.requester_id))
                && !taken.contains(&(NamedKind::Request, id.as_str()))
            {
                faults.push(id_taken(format!(
                    "/operationList/{index}/dynamicDataRequestList/{number}/dynamicDataRequestId"
                )));
            }
        }
    }
    faults
}

fn id_taken(pointer: String) -> Fault {
    fault(pointer, "ID_TAKEN", "This id cannot be used here; take another one.".to_owned())
}

/// Visits every id that must be unique within a network, with its pointer.
fn visit<'n>(
    network: &'n OperationNetwork,
    mut take: impl FnMut(NamedKind, &'n str, &dyn Fn() -> String),
) {
    for (index, operation) in network.operation_list.iter().enumerate() {
        let at = format!("/operationList/{index}");
        let id = operation.operation_id.as_str();
        take(NamedKind::Operation, id, &|| format!("{at}/operationId"));
        for (number, equipment) in operation.equipment_requirement_list.iter().enumerate() {
            take(NamedKind::Equipment, equipment.equipment_requirement_id.as_str(), &|| {
                format!("{at}/equipmentRequirementList/{number}/equipmentRequirementId")
            });
        }
        for (number, request) in operation.dynamic_data_request_list.iter().enumerate() {
            take(NamedKind::Request, request.dynamic_data_request_id.as_str(), &|| {
                format!("{at}/dynamicDataRequestList/{number}/dynamicDataRequestId")
            });
        }
    }
    for (index, relation) in network.operation_relation_list.iter().enumerate() {
        let at = format!("/operationRelationList/{index}");
        let id = relation.operation_relation_id.as_str();
        take(NamedKind::Relation, id, &|| format!("{at}/operationRelationId"));
        for (number, condition) in relation.condition_list.iter().enumerate() {
            take(NamedKind::Condition, condition.condition_id.as_str(), &|| {
                format!("{at}/conditionList/{number}/conditionId")
            });
        }
    }
}
