//! Rights of a revision's author: compares the document, member by member, with what the author
//! saw, and finds what is not the author's to change. See `docs/rights.md`.

use std::collections::{BTreeSet, HashMap, HashSet};

use asi_model::{
    OperationId, OrganisationId,
    messages::Fault,
    network::{DynamicDataRequest, Operation, OperationNetwork, OperationRelation},
};
use serde::Serialize;
use serde_json::{Map, Value};

use super::fault::fault;
use crate::store::{NetworkOwners, part_of};

/// Members of others' operations to which the drawer of the network may propose values.
const PLAN: [&str; 4] = ["plannedStart", "plannedEnd", "plannedQuantity", "quantityUnit"];
const REQUESTS: &str = "dynamicDataRequestList";
/// Sign of an operation that is shown in part. It follows from what the author may see.
const STUB: &str = "stub";

/// Finds all that the document changes, moves or leaves out of others. `before` is the revision in
/// force as the author sees it; `author` is the organisation for which it acts.
pub(super) fn faults(
    before: &OperationNetwork,
    document: &OperationNetwork,
    owners: &NetworkOwners,
    author: Option<&OrganisationId>,
) -> Vec<Fault> {
    let mut check = Check { owners, author, faults: Vec::new() };
    check.head(before, document);
    check.operations(before, document);
    check.relations(before, document);
    check.faults
}

struct Check<'a> {
    owners: &'a NetworkOwners,
    author: Option<&'a OrganisationId>,
    faults: Vec<Fault>,
}

impl Check<'_> {
    fn is_author(&self, organisation: Option<&OrganisationId>) -> bool {
        organisation.is_some() && organisation == self.author
    }

    fn is_drawer(&self) -> bool {
        self.is_author(self.owners.drawn_by.as_ref())
    }

    fn performs(&self, operation: &Operation) -> bool {
        self.is_author(self.owners.performer(operation))
    }

    fn asks(&self, request: &DynamicDataRequest) -> bool {
        self.is_author(Some(&request.requester_id))
    }

    fn head(&mut self, before: &OperationNetwork, document: &OperationNetwork) {
        if self.is_drawer() {
            return;
        }
        let members = [
            ("/name", before.name == document.name),
            ("/description", before.description == document.description),
        ];
        for (pointer, _) in members.into_iter().filter(|(_, is_same)| !is_same) {
            self.refuse(pointer.to_owned(), "FOREIGN_NETWORK", "The network");
        }
    }

    fn operations(&mut self, before: &OperationNetwork, document: &OperationNetwork) {
        let present: HashMap<_, _> = document
            .operation_list
            .iter()
            .enumerate()
            .map(|(index, operation)| (&operation.operation_id, (index, operation)))
            .collect();
        for known in &before.operation_list {
            match present.get(&known.operation_id) {
                Some((index, operation)) => {
                    self.operation(known, operation, &format!("/operationList/{index}"));
                }
                None if !self.performs(known) => {
                    let what = format!("The operation {}", known.operation_id);
                    self.refuse("/operationList".to_owned(), "FOREIGN_OPERATION", &what);
                }
                None if known.dynamic_data_request_list.iter().any(|r| !self.asks(r)) => {
                    let what = format!("A request about the operation {}", known.operation_id);
                    self.refuse("/operationList".to_owned(), "FOREIGN_REQUEST", &what);
                }
                None => {}
            }
        }
    }

    fn operation(&mut self, known: &Operation, operation: &Operation, at: &str) {
        if self.performs(known) {
            self.own_operation(known, operation, at);
        } else {
            let plan: &[&str] = if self.is_drawer() { &PLAN } else { &[] };
            let is_others = |name: &str| ![REQUESTS, STUB].contains(&name) && !plan.contains(&name);
            // Who was shown it in part before may not have read the rest yet.
            if !self.is_drawer()
                && !differing(&part_of(known), operation).iter().any(|name| is_others(name))
            {
                return self.requests(known, operation, at);
            }
            for name in differing(known, operation) {
                if is_others(&name) {
                    self.refuse(format!("{at}/{name}"), "FOREIGN_OPERATION", "The operation");
                }
            }
        }
        self.requests(known, operation, at);
    }

    /// An own operation changes its factory only within the organisation, and only while nobody
    /// else asks about it: the answers would come of another place under the same name.
    fn own_operation(&mut self, known: &Operation, operation: &Operation, at: &str) {
        if known.owning_factory_id == operation.owning_factory_id {
            return;
        }
        let pointer = format!("{at}/owningFactoryId");
        if !self.performs(operation) {
            self.refuse(pointer, "FOREIGN_FACTORY", "The factory");
        } else if known.dynamic_data_request_list.iter().any(|request| !self.asks(request)) {
            self.refuse(pointer, "FOREIGN_REQUEST", "A request about the operation");
        }
    }

    fn requests(&mut self, known: &Operation, operation: &Operation, at: &str) {
        let list = &operation.dynamic_data_request_list;
        for request in &known.dynamic_data_request_list {
            if self.asks(request) {
                continue;
            }
            let id = &request.dynamic_data_request_id;
            match list.iter().position(|found| found.dynamic_data_request_id == *id) {
                Some(number) => {
                    for name in differing(request, &list[number]) {
                        let pointer = format!("{at}/{REQUESTS}/{number}/{name}");
                        self.refuse(pointer, "FOREIGN_REQUEST", "The request");
                    }
                }
                None => {
                    let what = format!("The request {id}");
                    self.refuse(format!("{at}/{REQUESTS}"), "FOREIGN_REQUEST", &what);
                }
            }
        }
    }

    fn relations(&mut self, before: &OperationNetwork, document: &OperationNetwork) {
        let list = &document.operation_relation_list;
        let known: HashMap<_, &OperationRelation> = before
            .operation_relation_list
            .iter()
            .map(|relation| (&relation.operation_relation_id, relation))
            .collect();
        for (index, relation) in list.iter().enumerate() {
            let at = format!("/operationRelationList/{index}");
            let old = known.get(&relation.operation_relation_id);
            if old.is_some_and(|old| *old == relation) {
                continue;
            }
            let is_own =
                old.is_none_or(|old| self.joins(before, old)) && self.joins(document, relation);
            match old {
                _ if is_own => {}
                None => self.refuse(at, "FOREIGN_RELATION", "One of the operations"),
                Some(old) => {
                    for name in differing(*old, relation) {
                        self.refuse(format!("{at}/{name}"), "FOREIGN_RELATION", "The relation");
                    }
                }
            }
        }
        let present: HashSet<_> = list.iter().map(|r| &r.operation_relation_id).collect();
        for old in &before.operation_relation_list {
            let id = &old.operation_relation_id;
            if !present.contains(id) && !self.joins(before, old) {
                let what = format!("The relation {id}");
                self.refuse("/operationRelationList".to_owned(), "FOREIGN_RELATION", &what);
            }
        }
    }

    /// Returns true for the drawer, and for the performer of both ends.
    fn joins(&self, network: &OperationNetwork, relation: &OperationRelation) -> bool {
        let is_own = |id: &OperationId| {
            let mut operations = network.operation_list.iter();
            operations.find(|o| o.operation_id == *id).is_some_and(|o| self.performs(o))
        };
        self.is_drawer()
            || (is_own(&relation.predecessor_operation_id)
                && is_own(&relation.successor_operation_id))
    }

    fn refuse(&mut self, pointer: String, code: &str, what: &str) {
        let message = format!("{what} belongs to another organisation and stays as it is.");
        self.faults.push(fault(pointer, code, message));
    }
}

/// Names of the members in which two documents differ, by name.
fn differing<T: Serialize>(before: &T, after: &T) -> BTreeSet<String> {
    let (before, after) = (members(before), members(after));
    let names = before.keys().chain(after.keys());
    names.filter(|name| before.get(*name) != after.get(*name)).cloned().collect()
}

fn members<T: Serialize>(document: &T) -> Map<String, Value> {
    match serde_json::to_value(document) {
        Ok(Value::Object(members)) => members,
        _ => Map::new(),
    }
}
