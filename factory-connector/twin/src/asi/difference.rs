//! Difference between two states of one interface, in terms of nodes: an update touches only the
//! nodes that differ.

use std::collections::{BTreeMap, HashMap, HashSet};

use opcua_stack::opcua::types::{DataValue, NodeId};

use super::{
    interface::Interface, model::PartKind, node_address::NodeAddress, node_ids::NodeIds,
    values::ValueEncoder,
};

/// Verbs of a model change (OPC 10000-5 §12.16), a bit mask.
pub(super) mod verb {
    pub const NODE_ADDED: u8 = 1;
    pub const NODE_DELETED: u8 = 2;
    pub const REFERENCE_ADDED: u8 = 4;
    pub const REFERENCE_DELETED: u8 = 8;
    pub const DATA_TYPE_CHANGED: u8 = 16;
}

/// One affected node of a model change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Affected {
    /// The type definition of the affected node: an ASI type's id; 0 for the variables of report
    /// fields.
    pub type_id: u32,
    pub verbs: u8,
}

impl Affected {
    /// Returns the NodeId of the type definition; null for the variables of fields.
    pub(super) fn type_definition(self, ids: NodeIds) -> NodeId {
        if self.type_id == 0 { NodeId::null() } else { ids.type_id(self.type_id) }
    }
}

/// Nodes and values that differ.
#[derive(Debug, Default)]
pub(super) struct Difference {
    /// Objects and fields that were removed.
    pub removed: Vec<String>,
    /// Parts that were removed, with those that a removed node may have had.
    pub removed_parts: Vec<String>,
    /// Variables with another value, and those that were added.
    pub changed: Vec<(String, DataValue)>,
    /// Objects and fields in a model change, by identifier.
    pub affected: BTreeMap<String, Affected>,
    pub nodes_added: usize,
    pub nodes_removed: usize,
    pub nodes_changed: usize,
}

impl Difference {
    /// Returns the difference of a new interface: all its nodes are added.
    pub(super) fn all_added(interface: &Interface) -> Self {
        let mut difference = Self::default();
        for address in interface.addresses() {
            difference.nodes_added += 1;
            difference.affect(interface, address, verb::NODE_ADDED);
        }
        difference
    }

    /// Returns the difference of an interface that is removed with all its nodes.
    pub(super) fn all_removed(interface: &Interface) -> Self {
        let mut difference = Self::default();
        for address in interface.addresses() {
            difference.remove(interface, address);
        }
        difference
    }

    fn remove(&mut self, interface: &Interface, address: NodeAddress) {
        let identifier = interface.identifier(address);
        self.nodes_removed += 1;
        self.affect(interface, address, verb::NODE_DELETED);
        // All parts that are possible: to find the existing ones, their values would be computed.
        for part in interface.possible_parts(address) {
            let part_id = format!("{identifier}#{}", part.name);
            if !matches!(part.kind, PartKind::Property(_)) {
                let below = interface.parts_of_part(address, part).into_iter();
                self.removed_parts.extend(below.map(|below| format!("{part_id}#{}", below.name)));
            }
            self.removed_parts.push(part_id);
        }
        self.removed.push(identifier);
    }

    /// Compares two states of the same interface.
    pub(super) fn between(values: &ValueEncoder, old: &Interface, new: &Interface) -> Self {
        let mut difference = Self::default();
        let (before, after) = (by_identifier(old), by_identifier(new));
        for (identifier, &address) in &before {
            let is_same_node =
                after.get(identifier).is_some_and(|&now| old.type_of(address) == new.type_of(now));
            if !is_same_node {
                difference.remove(old, address);
                if let Some(&parent) =
                    old.parent(address).and_then(|p| after.get(&old.identifier(p)))
                {
                    difference.affect(new, parent, verb::REFERENCE_DELETED);
                }
                if let NodeAddress::Relation(relation) = address {
                    difference.affect_related(old, relation, new, verb::REFERENCE_DELETED);
                }
            }
        }
        for (identifier, &address) in &after {
            match before.get(identifier) {
                Some(&earlier) if old.type_of(earlier) == new.type_of(address) => {
                    difference.compare(values, (old, earlier), (new, address), identifier);
                }
                _ => difference.add(values, new, address, identifier),
            }
        }
        difference
    }

    fn add(
        &mut self,
        values: &ValueEncoder,
        new: &Interface,
        address: NodeAddress,
        identifier: &str,
    ) {
        self.nodes_added += 1;
        self.affect(new, address, verb::NODE_ADDED);
        if let Some(parent) = new.parent(address) {
            self.affect(new, parent, verb::REFERENCE_ADDED);
        }
        if let NodeAddress::Relation(relation) = address {
            self.affect_related(new, relation, new, verb::REFERENCE_ADDED);
        }
        // A client may still monitor a node that existed before.
        self.changed.extend(values.variables(new, address, identifier));
    }

    fn compare(
        &mut self,
        values: &ValueEncoder,
        (old, earlier): (&Interface, NodeAddress),
        (new, address): (&Interface, NodeAddress),
        identifier: &str,
    ) {
        let mut before: HashMap<String, DataValue> =
            values.variables(old, earlier, identifier).into_iter().collect();
        let mut is_changed = false;
        for (id, value) in values.variables(new, address, identifier) {
            match before.remove(&id) {
                Some(earlier) if is_same(&earlier, &value, id == identifier) => {}
                Some(_) => {
                    is_changed = true;
                    // The version follows from the other changes.
                    if !id.ends_with("#NodeVersion") {
                        self.changed.push((id, value));
                    }
                }
                None => {
                    is_changed = true;
                    self.affect(new, address, verb::REFERENCE_ADDED);
                    self.changed.push((id, value));
                }
            }
        }
        for id in before.into_keys() {
            is_changed = true;
            self.affect(new, address, verb::REFERENCE_DELETED);
            self.removed_parts.push(id);
        }
        if let (NodeAddress::Field(before), NodeAddress::Field(now)) = (earlier, address) {
            let (before, now) = (old.field(before).1, new.field(now).1);
            if (before.field_type, before.value_rank) != (now.field_type, now.value_rank) {
                is_changed = true;
                self.affect(new, address, verb::DATA_TYPE_CHANGED);
            }
        }
        if let (NodeAddress::Relation(before), NodeAddress::Relation(now)) = (earlier, address) {
            let ends = |interface: &Interface, relation| {
                let relation = interface.relation(relation);
                let ends = (
                    relation.predecessor_operation_id.clone(),
                    relation.successor_operation_id.clone(),
                );
                (relation.relation_type, ends)
            };
            if ends(old, before) != ends(new, now) {
                self.affect_related(old, before, new, verb::REFERENCE_DELETED);
                self.affect_related(new, now, new, verb::REFERENCE_ADDED);
            }
        }
        self.nodes_changed += usize::from(is_changed);
    }

    /// Returns the containers whose references changed.
    pub(super) fn changed_containers(&self) -> HashSet<&str> {
        let verbs = verb::REFERENCE_ADDED | verb::REFERENCE_DELETED;
        self.affected
            .iter()
            .filter(|(_, a)| a.verbs & verbs != 0)
            .map(|(id, _)| id.as_str())
            .collect()
    }

    fn affect(&mut self, interface: &Interface, address: NodeAddress, verbs: u8) {
        let affected = self.affected.entry(interface.identifier(address)).or_default();
        affected.type_id = interface.type_of(address).unwrap_or(0);
        affected.verbs |= verbs;
    }

    /// Notes that the references of both operations of a relation changed.
    fn affect_related(&mut self, of: &Interface, relation: u32, current: &Interface, verbs: u8) {
        let relation = of.relation(relation);
        for id in [&relation.predecessor_operation_id, &relation.successor_operation_id] {
            if let Some(operation) = current.find_operation_id(id) {
                self.affect(current, NodeAddress::Operation(operation), verbs);
            }
        }
    }
}

fn by_identifier(interface: &Interface) -> HashMap<String, NodeAddress> {
    interface
        .addresses()
        .into_iter()
        .map(|address| (interface.identifier(address), address))
        .collect()
}

/// Compares two values. The time counts only for fields, which have that of their source; properties
/// have that of the whole document.
fn is_same(a: &DataValue, b: &DataValue, with_time: bool) -> bool {
    a.value == b.value
        && a.status == b.status
        && (!with_time || a.source_timestamp == b.source_timestamp)
}
