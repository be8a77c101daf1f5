//! Where a node sits in an Activity Status Interface, and its readable NodeId.
//!
//! `<net>`, `<net>/op/<op>`, `<net>/op/<op>/req/<req>`, `.../<field>`,
//! `<net>/op/<op>/eq/<requirement>`, `<net>/rel/<rel>`, `<net>/rel/<rel>/cond/<condition>`; parts
//! with a fixed BrowseName follow after `#`. Inside an id `/`, `#` and `%` are percent-encoded, and
//! so are blanks at its ends, so that every id has one NodeId and the other way round, over all
//! restarts.

use std::borrow::Cow;

use asi_model::instance::{decode_segment, encode_segment};

use super::interface::Interface;

/// Where a node sits: an object, or a report field's variable. Numbers are positions within the
/// interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Place {
    Interface,
    OperationNetwork,
    Operation(u32),
    Requirement(u32, u32),
    Relation(u32),
    Condition(u32, u32),
    Request(u32),
    ReportDataFormat(u32),
    Field(u32),
}

const OPERATION_NETWORK: &str = "OperationNetwork";
const REPORT_DATA_FORMAT: &str = "ReportDataFormat";

/// An identifier taken apart: the network's id, the rest of its path, and the names after `#`.
pub(super) struct Identifier<'a> {
    pub network: Cow<'a, str>,
    path: Vec<Cow<'a, str>>,
    parts: Vec<&'a str>,
}

/// Most names after `#`: a component's or method's property.
const PARTS_MAX: usize = 3;
/// Most segments of a path.
const SEGMENTS_MAX: usize = 6;

impl<'a> Identifier<'a> {
    pub fn parse(text: &'a str) -> Option<Self> {
        let mut pieces = text.split('#');
        let mut path = Vec::new();
        for segment in pieces.next()?.split('/') {
            if path.len() == SEGMENTS_MAX {
                return None;
            }
            path.push(decode_segment(segment)?);
        }
        let network = path.remove(0);
        let parts: Vec<&str> = pieces.by_ref().take(PARTS_MAX).collect();
        (pieces.next().is_none()).then_some(Self { network, path, parts })
    }

    /// The place in an interface, and the names of the parts below it.
    pub fn locate(&self, interface: &Interface) -> Option<(Place, &[&'a str])> {
        let path: Vec<&str> = self.path.iter().map(AsRef::as_ref).collect();
        let place = match path.as_slice() {
            [] => Place::Interface,
            ["op", operation] => Place::Operation(interface.find_operation(operation)?),
            ["op", operation, "eq", id] => {
                let operation = interface.find_operation(operation)?;
                let list = &interface.operation(operation).equipment_requirement_list;
                let at = list.iter().position(|r| r.equipment_requirement_id.as_str() == *id)?;
                Place::Requirement(operation, u32::try_from(at).ok()?)
            }
            ["op", operation, "req", id] => Place::Request(interface.find_request(operation, id)?),
            ["op", operation, "req", id, field] => {
                Place::Field(interface.find_field(interface.find_request(operation, id)?, field)?)
            }
            ["rel", relation] => Place::Relation(interface.find_relation(relation)?),
            ["rel", relation, "cond", id] => {
                let relation = interface.find_relation(relation)?;
                let list = &interface.relation(relation).condition_list;
                let at = list.iter().position(|c| c.condition_id.as_str() == *id)?;
                Place::Condition(relation, u32::try_from(at).ok()?)
            }
            _ => return None,
        };
        Some(match (place, self.parts.split_first()) {
            (Place::Interface, Some((&OPERATION_NETWORK, rest))) => (Place::OperationNetwork, rest),
            (Place::Request(request), Some((&REPORT_DATA_FORMAT, rest))) => {
                (Place::ReportDataFormat(request), rest)
            }
            _ => (place, &self.parts),
        })
    }
}

impl Interface {
    /// The identifier of a place.
    pub fn identifier(&self, place: Place) -> String {
        let mut out = String::with_capacity(64);
        encode_segment(&mut out, self.network().operation_network_id.as_str());
        match place {
            Place::Interface => {}
            Place::OperationNetwork => {
                out.push('#');
                out.push_str(OPERATION_NETWORK);
            }
            Place::Operation(operation) => self.push_operation(&mut out, operation),
            Place::Requirement(operation, at) => {
                self.push_operation(&mut out, operation);
                let requirement =
                    &self.operation(operation).equipment_requirement_list[at as usize];
                push_segment(&mut out, "/eq/", requirement.equipment_requirement_id.as_str());
            }
            Place::Relation(relation) => self.push_relation(&mut out, relation),
            Place::Condition(relation, at) => {
                self.push_relation(&mut out, relation);
                let condition = &self.relation(relation).condition_list[at as usize];
                push_segment(&mut out, "/cond/", condition.condition_id.as_str());
            }
            Place::Request(request) => self.push_request(&mut out, request),
            Place::ReportDataFormat(request) => {
                self.push_request(&mut out, request);
                out.push('#');
                out.push_str(REPORT_DATA_FORMAT);
            }
            Place::Field(field) => {
                let (request, definition) = self.field(field);
                self.push_request(&mut out, request);
                push_segment(&mut out, "/", definition.name.as_str());
            }
        }
        out
    }

    fn push_operation(&self, out: &mut String, operation: u32) {
        push_segment(out, "/op/", self.operation(operation).operation_id.as_str());
    }

    fn push_relation(&self, out: &mut String, relation: u32) {
        push_segment(out, "/rel/", self.relation(relation).operation_relation_id.as_str());
    }

    fn push_request(&self, out: &mut String, request: u32) {
        self.push_operation(out, self.slot(request).operation);
        push_segment(out, "/req/", self.request(request).dynamic_data_request_id.as_str());
    }

    /// The place above in the hierarchy; `None` for the interface itself, which hangs under the
    /// folder.
    pub fn parent(&self, place: Place) -> Option<Place> {
        Some(match place {
            Place::Interface => return None,
            Place::OperationNetwork => Place::Interface,
            Place::Operation(_) | Place::Relation(_) => Place::OperationNetwork,
            Place::Requirement(operation, _) => Place::Operation(operation),
            Place::Condition(relation, _) => Place::Relation(relation),
            Place::Request(request) => Place::Operation(self.slot(request).operation),
            Place::ReportDataFormat(request) => Place::Request(request),
            Place::Field(field) => Place::ReportDataFormat(self.field(field).0),
        })
    }

    /// The places right below, parts not counted.
    pub fn children(&self, place: Place) -> Vec<Place> {
        let count = |length: usize| 0..u32::try_from(length).unwrap_or(u32::MAX);
        match place {
            Place::Interface => vec![Place::OperationNetwork],
            Place::OperationNetwork => {
                let network = self.network();
                let operations = count(network.operation_list.len()).map(Place::Operation);
                operations
                    .chain(count(network.operation_relation_list.len()).map(Place::Relation))
                    .collect()
            }
            Place::Operation(operation) => {
                let requirements = self.operation(operation).equipment_requirement_list.len();
                let requirements = count(requirements).map(|at| Place::Requirement(operation, at));
                requirements.chain(self.requests_of(operation).map(Place::Request)).collect()
            }
            Place::Relation(relation) => count(self.relation(relation).condition_list.len())
                .map(|at| Place::Condition(relation, at))
                .collect(),
            Place::Request(request) => vec![Place::ReportDataFormat(request)],
            Place::ReportDataFormat(request) => self.fields_of(request).map(Place::Field).collect(),
            Place::Requirement(..) | Place::Condition(..) | Place::Field(_) => Vec::new(),
        }
    }

    /// Every place, parents before children.
    pub fn places(&self) -> Vec<Place> {
        let mut places = vec![Place::Interface];
        let mut next = 0;
        while let Some(place) = places.get(next).copied() {
            places.extend(self.children(place));
            next += 1;
        }
        places
    }
}

fn push_segment(out: &mut String, separator: &str, id: &str) {
    out.push_str(separator);
    encode_segment(out, id);
}
