//! What two states of one interface differ in, in terms of nodes: so that an update touches nothing
//! else.

use std::collections::{BTreeMap, HashMap, HashSet};

use opcua_stack::opcua::types::{DataValue, NodeId};

use super::{interface::Interface, model::PartKind, place::Place, provider::AsiProvider};

/// The verbs of a model change (OPC 10000-5 §12.16); they may stand together.
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

/// What differs.
#[derive(Debug, Default)]
pub(super) struct Difference {
    /// Objects and fields that are gone.
    pub gone: Vec<String>,
    /// Parts that are gone, or might be: those that a place of that kind can have.
    pub gone_parts: Vec<String>,
    /// Variables with another value, and those that came.
    pub changed: Vec<(String, DataValue)>,
    /// Objects and fields in a model change, by identifier.
    pub affected: BTreeMap<String, Affected>,
    pub nodes_added: usize,
    pub nodes_removed: usize,
    pub nodes_changed: usize,
}

impl Difference {
    fn affect(&mut self, interface: &Interface, place: Place, verbs: u8) {
        let affected = self.affected.entry(interface.identifier(place)).or_default();
        affected.type_id = interface.type_of(place).unwrap_or(0);
        affected.verbs |= verbs;
    }

    /// A relation came, went or changed: the arrows of both its operations did too.
    fn affect_related(&mut self, of: &Interface, relation: u32, current: &Interface, verbs: u8) {
        let relation = of.relation(relation);
        for id in [&relation.predecessor_operation_id, &relation.successor_operation_id] {
            if let Some(operation) = current.find_operation_id(id) {
                self.affect(current, Place::Operation(operation), verbs);
            }
        }
    }
}

fn by_identifier(interface: &Interface) -> HashMap<String, Place> {
    interface.places().into_iter().map(|place| (interface.identifier(place), place)).collect()
}

impl AsiProvider {
    /// Every variable of a place, by identifier: the field itself, its parts, units of parts.
    pub(super) fn variables(
        &self,
        interface: &Interface,
        place: Place,
        identifier: &str,
    ) -> Vec<(String, DataValue)> {
        let mut variables = Vec::new();
        if let Place::Field(field) = place {
            variables.push((
                identifier.to_owned(),
                self.shown(&interface.records.read()[field as usize]),
            ));
        }
        for part in interface.parts(place) {
            let part_id = format!("{identifier}#{}", part.name);
            for below in interface.parts_of_part(place, part) {
                let value = interface.part_of_part_value(place, part, below, self.types);
                variables.extend(value.map(|value| (format!("{part_id}#{}", below.name), value)));
            }
            variables.extend(interface.part_value(place, part).map(|value| (part_id, value)));
        }
        variables
    }

    /// A new interface, all of it.
    pub(super) fn all_added(&self, interface: &Interface) -> Difference {
        let mut difference = Difference::default();
        for place in interface.places() {
            difference.nodes_added += 1;
            difference.affect(interface, place, verb::NODE_ADDED);
        }
        difference
    }

    /// An interface that goes, all of it.
    pub(super) fn all_removed(&self, interface: &Interface) -> Difference {
        let mut difference = Difference::default();
        for place in interface.places() {
            self.remove(&mut difference, interface, place);
        }
        difference
    }

    fn remove(&self, difference: &mut Difference, interface: &Interface, place: Place) {
        let identifier = interface.identifier(place);
        difference.nodes_removed += 1;
        difference.affect(interface, place, verb::NODE_DELETED);
        // Without looking which parts there were: that would cost computing their values.
        for part in interface.possible_parts(place) {
            let part_id = format!("{identifier}#{}", part.name);
            if !matches!(part.kind, PartKind::Property(_)) {
                let below = interface.parts_of_part(place, part).into_iter();
                difference
                    .gone_parts
                    .extend(below.map(|below| format!("{part_id}#{}", below.name)));
            }
            difference.gone_parts.push(part_id);
        }
        difference.gone.push(identifier);
    }

    /// What differs between two states of the same interface.
    pub(super) fn difference(&self, old: &Interface, new: &Interface) -> Difference {
        let mut difference = Difference::default();
        let (before, after) = (by_identifier(old), by_identifier(new));
        for (identifier, &place) in &before {
            let is_kept =
                after.get(identifier).is_some_and(|&now| old.type_of(place) == new.type_of(now));
            if !is_kept {
                self.remove(&mut difference, old, place);
                if let Some(&parent) = old.parent(place).and_then(|p| after.get(&old.identifier(p)))
                {
                    difference.affect(new, parent, verb::REFERENCE_DELETED);
                }
                if let Place::Relation(relation) = place {
                    difference.affect_related(old, relation, new, verb::REFERENCE_DELETED);
                }
            }
        }
        for (identifier, &place) in &after {
            match before.get(identifier) {
                Some(&earlier) if old.type_of(earlier) == new.type_of(place) => {
                    self.compare(&mut difference, (old, earlier), (new, place), identifier);
                }
                _ => self.add(&mut difference, new, place, identifier),
            }
        }
        difference
    }

    fn add(&self, difference: &mut Difference, new: &Interface, place: Place, identifier: &str) {
        difference.nodes_added += 1;
        difference.affect(new, place, verb::NODE_ADDED);
        if let Some(parent) = new.parent(place) {
            difference.affect(new, parent, verb::REFERENCE_ADDED);
        }
        if let Place::Relation(relation) = place {
            difference.affect_related(new, relation, new, verb::REFERENCE_ADDED);
        }
        // A client may still monitor a node that was there before.
        difference.changed.extend(self.variables(new, place, identifier));
    }

    fn compare(
        &self,
        difference: &mut Difference,
        (old, earlier): (&Interface, Place),
        (new, place): (&Interface, Place),
        identifier: &str,
    ) {
        let mut before: HashMap<String, DataValue> =
            self.variables(old, earlier, identifier).into_iter().collect();
        let mut is_changed = false;
        for (id, value) in self.variables(new, place, identifier) {
            match before.remove(&id) {
                Some(earlier) if is_same(&earlier, &value, id == identifier) => {}
                Some(_) => {
                    is_changed = true;
                    // The version follows from what else changed.
                    if !id.ends_with("#NodeVersion") {
                        difference.changed.push((id, value));
                    }
                }
                None => {
                    is_changed = true;
                    difference.affect(new, place, verb::REFERENCE_ADDED);
                    difference.changed.push((id, value));
                }
            }
        }
        for id in before.into_keys() {
            is_changed = true;
            difference.affect(new, place, verb::REFERENCE_DELETED);
            difference.gone_parts.push(id);
        }
        if let (Place::Field(before), Place::Field(now)) = (earlier, place) {
            let (before, now) = (old.field(before).1, new.field(now).1);
            if (before.field_type, before.value_rank) != (now.field_type, now.value_rank) {
                is_changed = true;
                difference.affect(new, place, verb::DATA_TYPE_CHANGED);
            }
        }
        if let (Place::Relation(before), Place::Relation(now)) = (earlier, place) {
            let ends = |interface: &Interface, relation| {
                let relation = interface.relation(relation);
                let ends = (
                    relation.predecessor_operation_id.clone(),
                    relation.successor_operation_id.clone(),
                );
                (relation.relation_type, ends)
            };
            if ends(old, before) != ends(new, now) {
                difference.affect_related(old, before, new, verb::REFERENCE_DELETED);
                difference.affect_related(new, now, new, verb::REFERENCE_ADDED);
            }
        }
        difference.nodes_changed += usize::from(is_changed);
    }

    /// The containers whose references changed.
    pub(super) fn changed_containers(difference: &Difference) -> HashSet<&str> {
        let verbs = verb::REFERENCE_ADDED | verb::REFERENCE_DELETED;
        difference
            .affected
            .iter()
            .filter(|(_, a)| a.verbs & verbs != 0)
            .map(|(id, _)| id.as_str())
            .collect()
    }

    /// The type definition's node id of an affected node, null for the variables of fields.
    pub(super) fn affected_type(&self, affected: Affected) -> NodeId {
        if affected.type_id == 0 { NodeId::null() } else { self.type_id(affected.type_id) }
    }
}

/// Properties carry the time of the whole document, which says nothing; fields carry their
/// source's.
fn is_same(a: &DataValue, b: &DataValue, with_time: bool) -> bool {
    a.value == b.value
        && a.status == b.status
        && (!with_time || a.source_timestamp == b.source_timestamp)
}
