//! Owners of the places in a network's document, as `docs/rights.md` states them, told by ids alone
//! and without the platform's code.

use serde_json::Value;

use super::places::{Change, ENDS, Kind};
use crate::{chain::CARRIER_FACTORY, harness::Answer};

/// Members of others' operations to which the drawer of the network may propose values.
const PLAN: [&str; 4] = ["plannedStart", "plannedEnd", "plannedQuantity", "quantityUnit"];
/// The organisation that draws the networks of the chain.
pub const DRAWER: &str = "acme-aero";

fn organisation_of(factory: &Value) -> &'static str {
    match factory.as_str() {
        Some("ACME") => DRAWER,
        Some("FOR_MUC") => "frames-munich",
        Some("INS_HAM") => "inspect-hamburg",
        Some(CARRIER_FACTORY) => "freight-bremen",
        _ => "nobody",
    }
}

/// Rights of one member in the document that it sees.
pub struct Owner<'d> {
    pub author: &'static str,
    pub shown: &'d Value,
}

impl Owner<'_> {
    fn draws(&self) -> bool {
        self.author == DRAWER
    }

    fn performs(&self, operation: &Value) -> bool {
        organisation_of(&operation["owningFactoryId"]) == self.author
    }

    /// True where nobody else asks about the operation.
    fn alone(&self, operation: &Value) -> bool {
        let requests = operation["dynamicDataRequestList"].as_array();
        requests.into_iter().flatten().all(|request| request["requesterId"] == self.author)
    }

    /// True for the drawer, and for the performer of both ends.
    fn joins(&self, relation: &Value) -> bool {
        let operations = self.shown["operationList"].as_array().expect("operations");
        let performs = |end: &str| {
            let mut ends = operations.iter().filter(|o| o["operationId"] == relation[end]);
            ends.next().is_some_and(|operation| self.performs(operation))
        };
        self.draws() || (performs("predecessorOperationId") && performs("successorOperationId"))
    }

    /// True where the author may change all relations of the operation.
    fn joins_all(&self, operation: &Value) -> bool {
        let relations = self.shown["operationRelationList"].as_array();
        let of_it =
            |relation: &&Value| ENDS.iter().any(|end| relation[end] == operation["operationId"]);
        relations.into_iter().flatten().filter(of_it).all(|relation| self.joins(relation))
    }

    /// Returns true where the change is of what is the author's own, or a proposal that it may
    /// make. All else has to be refused.
    pub fn may(&self, change: &Change) -> bool {
        let path: Vec<&str> = change.pointer.split('/').skip(1).collect();
        let after = change.document.pointer(&change.pointer).unwrap_or(&Value::Null);
        let element = |list: &str, index: &str| {
            let before = &self.shown[list][index.parse::<usize>().expect("an index")];
            if before.is_null() { after.clone() } else { before.clone() }
        };
        match path[..] {
            ["name" | "description"] => self.draws(),
            // To leave all relations out is to leave out each.
            ["operationRelationList"] => {
                let relations = self.shown["operationRelationList"].as_array();
                self.draws() || relations.into_iter().flatten().all(|each| self.joins(each))
            }
            ["operationList", _] if change.kind == Kind::Added => true,
            ["operationList", index, ref inner @ ..] => {
                self.may_operation(change, &element("operationList", index), inner, after)
            }
            ["operationRelationList", index, ..] => {
                let place = format!("/operationRelationList/{index}");
                let now = change.document.pointer(&place);
                let now = now.filter(|_| path.len() > 2);
                self.joins(&element("operationRelationList", index))
                    && now.is_none_or(|relation| self.joins(relation))
            }
            // The id of the network, and the list of operations as such.
            _ => false,
        }
    }

    fn may_operation(
        &self,
        change: &Change,
        operation: &Value,
        inner: &[&str],
        after: &Value,
    ) -> bool {
        let is_own = self.performs(operation);
        match inner {
            // An operation with another id is another operation. Relations go with it.
            [] | ["operationId"] => is_own && self.alone(operation) && self.joins_all(operation),
            // Of others' operations it says nothing.
            ["stub"] => !is_own,
            ["owningFactoryId"] => {
                is_own && self.alone(operation) && organisation_of(after) == self.author
            }
            ["dynamicDataRequestList"] if change.kind == Kind::Added => {
                let requests = after.as_array().expect("requests");
                requests.iter().all(|request| request["requesterId"] == self.author)
            }
            ["dynamicDataRequestList"] => self.alone(operation),
            ["dynamicDataRequestList", index, member @ ..] => {
                let index: usize = index.parse().expect("an index");
                let before = &operation["dynamicDataRequestList"][index];
                let requester = if before.is_null() { after } else { before };
                let is_asked_by = |request: &Value| request["requesterId"] == self.author;
                is_asked_by(requester) && member != ["requesterId"]
            }
            [member, ..] => is_own || (self.draws() && PLAN.contains(member)),
        }
    }

    /// Asserts that a change that is not the author's to make was refused, at its place. Returns false where
    /// the document was refused as no right network, and so not compared with the author's rights.
    pub fn assert_refused(&self, change: &Change, answer: &Answer) -> bool {
        let what = || format!("{}: {:?} {}: {answer:?}", self.author, change.kind, change.pointer);
        if answer.body["isChanged"] == false {
            return false;
        }
        assert!([400, 409, 422].contains(&answer.status), "{}", what());
        let faults = answer.body["faults"].as_array().cloned().unwrap_or_default();
        let is_of_rights = |fault: &Value| {
            let code = fault["code"].as_str().expect("a code");
            code.starts_with("FOREIGN") || ["ID_TAKEN", "STUB_IN_WHOLE"].contains(&code)
        };
        if !faults.iter().any(is_of_rights) {
            return false;
        }
        // Relations follow an operation that goes or gets another id.
        let path: Vec<&str> = change.pointer.split('/').skip(1).collect();
        let is_of_relations =
            matches!(path[..], ["operationList", _] | ["operationList", _, "operationId"]);
        let is_there = |fault: &Value| {
            let pointer = fault["pointer"].as_str().expect("a pointer");
            let pointer = pointer.strip_prefix("/operationNetwork").unwrap_or(pointer);
            pointer.starts_with(&change.pointer)
                || change.pointer.starts_with(pointer)
                || (is_of_relations && pointer.starts_with("/operationRelationList"))
        };
        assert!(faults.iter().any(is_there), "{}", what());
        true
    }

    /// Asserts that a change that is the author's to make was not refused as another's.
    pub fn assert_taken_for_own(&self, change: &Change, answer: &Answer) {
        let what = || format!("{}: {:?} {}: {answer:?}", self.author, change.kind, change.pointer);
        assert!([200, 400, 422].contains(&answer.status), "{}", what());
        let faults = answer.body["faults"].as_array().into_iter().flatten();
        let mut codes = faults.map(|fault| fault["code"].as_str().expect("a code"));
        assert!(codes.all(|code| !code.starts_with("FOREIGN")), "{}", what());
    }
}
