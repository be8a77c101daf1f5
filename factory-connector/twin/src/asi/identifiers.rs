//! Readable NodeIds of an interface's nodes, and the hierarchy that they follow.
//!
//! `<net>`, `<net>/op/<op>`, `<net>/op/<op>/req/<req>`, `.../<field>`,
//! `<net>/op/<op>/eq/<requirement>`, `<net>/rel/<rel>`, `<net>/rel/<rel>/cond/<condition>`; parts
//! with a fixed BrowseName follow after `#`. Inside an id `/`, `#` and `%` are percent-encoded, and
//! so are blanks at its ends. Every id therefore has exactly one NodeId, also after a restart.

use std::borrow::Cow;

use asi_model::instance::{decode_segment, encode_segment};

use super::{interface::Interface, node_address::NodeAddress};

/// BrowseNames of the objects that have no id.
const OPERATION_NETWORK: &str = "OperationNetwork";
const REPORT_DATA_FORMAT: &str = "ReportDataFormat";

/// A parsed identifier: the network's id, the path below it, and the names after `#`.
pub(super) struct InstanceIdentifier<'a> {
    pub network: Cow<'a, str>,
    path: Vec<Cow<'a, str>>,
    parts: Vec<&'a str>,
}

/// Most names after `#`: a component's or method's property.
const PARTS_MAX: usize = 3;
/// Most segments of a path.
const SEGMENTS_MAX: usize = 6;

impl<'a> InstanceIdentifier<'a> {
    /// Parses an identifier; none when it is too long or an id is not in its canonical encoding.
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

    /// Finds the address in an interface. Returns it with the names of the parts below.
    pub fn locate(&self, interface: &Interface) -> Option<(NodeAddress, &[&'a str])> {
        let path: Vec<&str> = self.path.iter().map(AsRef::as_ref).collect();
        let address = match path.as_slice() {
            [] => NodeAddress::Interface,
            ["op", operation] => NodeAddress::Operation(interface.find_operation(operation)?),
            ["op", operation, "eq", id] => {
                let operation = interface.find_operation(operation)?;
                let list = &interface.operation(operation).equipment_requirement_list;
                let index = list.iter().position(|r| r.equipment_requirement_id.as_str() == *id)?;
                NodeAddress::Requirement(operation, u32::try_from(index).ok()?)
            }
            ["op", operation, "req", id] => {
                NodeAddress::Request(interface.find_request(operation, id)?)
            }
            ["op", operation, "req", id, field] => NodeAddress::Field(
                interface.find_field(interface.find_request(operation, id)?, field)?,
            ),
            ["rel", relation] => NodeAddress::Relation(interface.find_relation(relation)?),
            ["rel", relation, "cond", id] => {
                let relation = interface.find_relation(relation)?;
                let list = &interface.relation(relation).condition_list;
                let index = list.iter().position(|c| c.condition_id.as_str() == *id)?;
                NodeAddress::Condition(relation, u32::try_from(index).ok()?)
            }
            _ => return None,
        };
        Some(match (address, self.parts.split_first()) {
            (NodeAddress::Interface, Some((&OPERATION_NETWORK, rest))) => {
                (NodeAddress::OperationNetwork, rest)
            }
            (NodeAddress::Request(request), Some((&REPORT_DATA_FORMAT, rest))) => {
                (NodeAddress::ReportDataFormat(request), rest)
            }
            _ => (address, &self.parts),
        })
    }
}

impl Interface {
    /// Returns the identifier of an address.
    pub fn identifier(&self, address: NodeAddress) -> String {
        let mut out = String::with_capacity(64);
        encode_segment(&mut out, self.network().operation_network_id.as_str());
        match address {
            NodeAddress::Interface => {}
            NodeAddress::OperationNetwork => {
                out.push('#');
                out.push_str(OPERATION_NETWORK);
            }
            NodeAddress::Operation(operation) => self.push_operation(&mut out, operation),
            NodeAddress::Requirement(operation, at) => {
                self.push_operation(&mut out, operation);
                let requirement =
                    &self.operation(operation).equipment_requirement_list[at as usize];
                push_segment(&mut out, "/eq/", requirement.equipment_requirement_id.as_str());
            }
            NodeAddress::Relation(relation) => self.push_relation(&mut out, relation),
            NodeAddress::Condition(relation, at) => {
                self.push_relation(&mut out, relation);
                let condition = &self.relation(relation).condition_list[at as usize];
                push_segment(&mut out, "/cond/", condition.condition_id.as_str());
            }
            NodeAddress::Request(request) => self.push_request(&mut out, request),
            NodeAddress::ReportDataFormat(request) => {
                self.push_request(&mut out, request);
                out.push('#');
                out.push_str(REPORT_DATA_FORMAT);
            }
            NodeAddress::Field(field) => {
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

    /// Returns the parent in the hierarchy; `None` for the interface itself, whose parent is the
    /// folder.
    pub fn parent(&self, address: NodeAddress) -> Option<NodeAddress> {
        Some(match address {
            NodeAddress::Interface => return None,
            NodeAddress::OperationNetwork => NodeAddress::Interface,
            NodeAddress::Operation(_) | NodeAddress::Relation(_) => NodeAddress::OperationNetwork,
            NodeAddress::Requirement(operation, _) => NodeAddress::Operation(operation),
            NodeAddress::Condition(relation, _) => NodeAddress::Relation(relation),
            NodeAddress::Request(request) => NodeAddress::Operation(self.slot(request).operation),
            NodeAddress::ReportDataFormat(request) => NodeAddress::Request(request),
            NodeAddress::Field(field) => NodeAddress::ReportDataFormat(self.field(field).0),
        })
    }

    /// Returns the direct children without the parts.
    pub fn children(&self, address: NodeAddress) -> Vec<NodeAddress> {
        let count = |length: usize| 0..u32::try_from(length).unwrap_or(u32::MAX);
        match address {
            NodeAddress::Interface => vec![NodeAddress::OperationNetwork],
            NodeAddress::OperationNetwork => {
                let network = self.network();
                let operations = count(network.operation_list.len()).map(NodeAddress::Operation);
                operations
                    .chain(count(network.operation_relation_list.len()).map(NodeAddress::Relation))
                    .collect()
            }
            NodeAddress::Operation(operation) => {
                let requirements = self.operation(operation).equipment_requirement_list.len();
                let requirements =
                    count(requirements).map(|at| NodeAddress::Requirement(operation, at));
                requirements.chain(self.requests_of(operation).map(NodeAddress::Request)).collect()
            }
            NodeAddress::Relation(relation) => count(self.relation(relation).condition_list.len())
                .map(|at| NodeAddress::Condition(relation, at))
                .collect(),
            NodeAddress::Request(request) => vec![NodeAddress::ReportDataFormat(request)],
            NodeAddress::ReportDataFormat(request) => {
                self.fields_of(request).map(NodeAddress::Field).collect()
            }
            NodeAddress::Requirement(..) | NodeAddress::Condition(..) | NodeAddress::Field(_) => {
                Vec::new()
            }
        }
    }

    /// Returns all addresses, parents before children.
    pub fn addresses(&self) -> Vec<NodeAddress> {
        let mut addresses = vec![NodeAddress::Interface];
        let mut next = 0;
        while let Some(address) = addresses.get(next).copied() {
            addresses.extend(self.children(address));
            next += 1;
        }
        addresses
    }
}

fn push_segment(out: &mut String, separator: &str, id: &str) {
    out.push_str(separator);
    encode_segment(out, id);
}
