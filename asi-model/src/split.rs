//! The part of a network that concerns one factory: its own operations, and stubs of their
//! neighbours.

use std::collections::{HashMap, HashSet};

use crate::{
    ids::{FactoryId, OperationId},
    network::{Operation, OperationKind, OperationNetwork, OperationRelation},
};

/// The factories that own operations of a whole network, in order of first mention.
#[must_use]
pub fn factories(whole: &OperationNetwork) -> Vec<FactoryId> {
    let mut seen = HashSet::new();
    let owners =
        whole.operation_list.iter().filter_map(|operation| operation.owning_factory_id.as_ref());
    owners.filter(|owner| seen.insert(*owner)).cloned().collect()
}

/// Returns the part of one factory: the operations it owns in full, every relation of one of them,
/// and stubs of the operations that those relations and its inspections name. Document order is
/// kept. A factory without operations gets an empty part, which is a withdrawal.
#[must_use]
pub fn factory_part(whole: &OperationNetwork, factory_id: &FactoryId) -> OperationNetwork {
    let own: HashSet<&OperationId> = whole
        .operation_list
        .iter()
        .filter(|operation| {
            !operation.stub && operation.owning_factory_id.as_ref() == Some(factory_id)
        })
        .map(|operation| &operation.operation_id)
        .collect();
    let concerns = |relation: &&OperationRelation| {
        own.contains(&relation.predecessor_operation_id)
            || own.contains(&relation.successor_operation_id)
    };
    let relations: Vec<OperationRelation> =
        whole.operation_relation_list.iter().filter(concerns).cloned().collect();
    let mut named: HashSet<&OperationId> = relations
        .iter()
        .flat_map(|relation| [&relation.predecessor_operation_id, &relation.successor_operation_id])
        .collect();
    named.extend(
        whole
            .operation_list
            .iter()
            .filter(|operation| own.contains(&operation.operation_id))
            .filter_map(|operation| match &operation.kind {
                OperationKind::Inspection { inspected_operation_id, .. } => {
                    inspected_operation_id.as_ref()
                }
                _ => None,
            }),
    );
    let operations = whole.operation_list.iter().filter_map(|operation| {
        if own.contains(&operation.operation_id) {
            Some(operation.clone())
        } else {
            named.contains(&operation.operation_id).then(|| stub(operation))
        }
    });
    OperationNetwork {
        operation_network_id: whole.operation_network_id.clone(),
        name: whole.name.clone(),
        description: whole.description.clone(),
        operation_list: operations.collect(),
        operation_relation_list: relations,
    }
}

/// Returns the part of an operation that a neighbour may know: type, id, name and owner.
#[must_use]
pub fn stub(operation: &Operation) -> Operation {
    Operation {
        operation_id: operation.operation_id.clone(),
        kind: match operation.kind {
            OperationKind::Production { .. } => OperationKind::Production { product_id: None },
            OperationKind::Inspection { .. } => {
                OperationKind::Inspection { inspected_operation_id: None, characteristic: None }
            }
            OperationKind::Transportation { .. } => {
                OperationKind::Transportation { origin: None, destination: None }
            }
        },
        name: operation.name.clone(),
        description: None,
        stub: true,
        owning_factory_id: operation.owning_factory_id.clone(),
        planned_start: None,
        planned_end: None,
        planned_quantity: None,
        quantity_unit: None,
        equipment_requirement_list: Vec::new(),
        dynamic_data_request_list: Vec::new(),
    }
}

/// Puts the parts of several factories together again: own operations win over stubs, relations and
/// stubs appear once. Order is that of first mention.
#[must_use]
pub fn join(parts: &[OperationNetwork]) -> Option<OperationNetwork> {
    let (first, rest) = parts.split_first()?;
    let mut whole = first.clone();
    let mut operations: HashMap<OperationId, usize> = whole
        .operation_list
        .iter()
        .enumerate()
        .map(|(index, o)| (o.operation_id.clone(), index))
        .collect();
    let mut relations: HashSet<_> = whole
        .operation_relation_list
        .iter()
        .map(|relation| relation.operation_relation_id.clone())
        .collect();
    for part in rest {
        for operation in &part.operation_list {
            match operations.get(&operation.operation_id) {
                Some(&index) if whole.operation_list[index].stub => {
                    whole.operation_list[index] = operation.clone()
                }
                Some(_) => {}
                None => {
                    operations.insert(operation.operation_id.clone(), whole.operation_list.len());
                    whole.operation_list.push(operation.clone());
                }
            }
        }
        for relation in &part.operation_relation_list {
            if relations.insert(relation.operation_relation_id.clone()) {
                whole.operation_relation_list.push(relation.clone());
            }
        }
    }
    Some(whole)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::validation::{validate_factory_part, validate_network};

    fn whole() -> OperationNetwork {
        let operation = |id: &str, kind: &str, owner: &str| {
            json!({ "operationId": id, "operationType": kind, "name": id, "owningFactoryId": owner,
                "plannedQuantity": 3, "characteristic": "size" })
        };
        let mut inspect = operation("inspect", "INSPECTION", "HAM");
        inspect["inspectedOperationId"] = json!("make");
        let relation = |id: &str, from: &str, to: &str| {
            json!({ "operationRelationId": id, "relationType": "FINISH_TO_START",
                "predecessorOperationId": from, "successorOperationId": to })
        };
        serde_json::from_value(json!({
            "operationNetworkId": "n",
            "operationList": [operation("make", "PRODUCTION", "MUC"), operation("move", "TRANSPORTATION", "LOG"),
                inspect, operation("assemble", "PRODUCTION", "HAM")],
            "operationRelationList": [relation("r1", "make", "move"), relation("r2", "move", "inspect"),
                relation("r3", "inspect", "assemble")]
        }))
        .expect("a network")
    }

    #[test]
    fn each_factory_gets_its_own_and_stubs_of_neighbours() {
        let whole = whole();
        assert_eq!(validate_network(&whole), []);
        for (factory, operations, relations) in [
            ("MUC", vec!["make", "move*"], vec!["r1"]),
            ("LOG", vec!["make*", "move", "inspect*"], vec!["r1", "r2"]),
            // The inspected operation is named by no relation of HAM.
            ("HAM", vec!["make*", "move*", "inspect", "assemble"], vec!["r2", "r3"]),
            ("NOBODY", vec![], vec![]),
        ] {
            let factory_id: FactoryId = factory.parse().expect("valid");
            let part = factory_part(&whole, &factory_id);
            let found: Vec<String> = part
                .operation_list
                .iter()
                .map(|o| format!("{}{}", o.operation_id, if o.stub { "*" } else { "" }))
                .collect();
            assert_eq!(found, operations);
            let found: Vec<&str> = part
                .operation_relation_list
                .iter()
                .map(|r| r.operation_relation_id.as_str())
                .collect();
            assert_eq!(found, relations);
            assert!(
                part.operation_list.iter().filter(|o| o.stub).all(|o| o.planned_quantity.is_none())
            );
            assert_eq!(validate_factory_part(&part, &factory_id), []);
        }
        let parts: Vec<OperationNetwork> =
            factories(&whole).iter().map(|id| factory_part(&whole, id)).collect();
        assert_eq!(join(&parts), Some(whole));
    }
}
