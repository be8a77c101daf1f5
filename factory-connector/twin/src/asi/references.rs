//! How the nodes of interfaces hang together, computed from places and parts.

use asi_model::{
    OperationNetworkId,
    instance::{FOLDER_ID, encode_segment},
};
use opcua_stack::opcua::types::{NodeId, ObjectId, ReferenceTypeId};

use super::{
    interface::Interface,
    model::{self, FOLDER_PARTS, Part, PartKind},
    nodes::field_type,
    place::Place,
    provider::{AsiProvider, At},
    types::folder_type,
};
use crate::provider::{Reference, ReferenceVisitor};

/// Positions among the folder's references below this are its own; above it, the sequences of
/// interfaces.
const FOLDER_OWN_REFERENCES: u64 = 16;

impl AsiProvider {
    pub(super) fn folder_references(&self, after: u64, visit: &mut ReferenceVisitor<'_>) {
        let folder = FOLDER_ID.to_owned();
        let own = [
            reference(ReferenceTypeId::Organizes, false, ObjectId::ObjectsFolder.into()),
            reference(ReferenceTypeId::HasTypeDefinition, true, folder_type()),
            reference(
                ReferenceTypeId::HasProperty,
                true,
                self.id(format!("{folder}#{}", FOLDER_PARTS[0].name)),
            ),
        ];
        for (position, reference) in (1..).zip(own).filter(|(position, _)| *position > after) {
            if visit(position, reference).is_break() {
                return;
            }
        }
        let mut sequence = after.saturating_sub(FOLDER_OWN_REFERENCES);
        // The lock is taken anew for every interface: the visitor looks the targets up.
        loop {
            let next = {
                let state = self.state.read();
                state
                    .by_sequence
                    .range(sequence + 1..)
                    .next()
                    .map(|(sequence, id)| (*sequence, id.clone()))
            };
            let Some((found, id)) = next else { return };
            sequence = found;
            let reference = self.organizes(&id);
            if visit(FOLDER_OWN_REFERENCES + sequence, reference).is_break() {
                return;
            }
        }
    }

    pub(super) fn organizes(&self, id: &OperationNetworkId) -> Reference {
        let mut identifier = String::new();
        encode_segment(&mut identifier, id.as_str());
        reference(ReferenceTypeId::Organizes, true, self.id(identifier))
    }

    pub(super) fn place_references(&self, interface: &Interface, place: Place) -> Vec<Reference> {
        let identifier = interface.identifier(place);
        let mut references = vec![self.to_parent(interface, place)];
        let definition = match place {
            Place::Field(field) => Some(field_type(interface.field(field).1)),
            _ => interface.type_of(place).map(|id| self.type_id(id)),
        };
        references
            .extend(definition.map(|id| reference(ReferenceTypeId::HasTypeDefinition, true, id)));
        for part in interface.parts(place) {
            references.push(reference(
                part_reference(part),
                true,
                self.id(format!("{identifier}#{}", part.name)),
            ));
        }
        for child in interface.children(place) {
            references.push(Reference {
                reference_type: self.child_reference(child),
                is_forward: true,
                target: self.id(interface.identifier(child)),
            });
        }
        if let Place::Operation(operation) = place {
            self.push_dependencies(interface, operation, &mut references);
        }
        references
    }

    /// The second representation of relations: arrows between operations.
    fn push_dependencies(
        &self,
        interface: &Interface,
        operation: u32,
        references: &mut Vec<Reference>,
    ) {
        let own_id = &interface.operation(operation).operation_id;
        for relation in interface.relations_of(operation).map(|r| interface.relation(r)) {
            let is_forward = relation.predecessor_operation_id == *own_id;
            let other = if is_forward {
                &relation.successor_operation_id
            } else {
                &relation.predecessor_operation_id
            };
            if let Some(other) = interface.find_operation_id(other) {
                references.push(Reference {
                    reference_type: self.type_id(model::dependency(relation.relation_type)),
                    is_forward,
                    target: self.id(interface.identifier(Place::Operation(other))),
                });
            }
        }
    }

    fn to_parent(&self, interface: &Interface, place: Place) -> Reference {
        match interface.parent(place) {
            None => reference(ReferenceTypeId::Organizes, false, self.id(FOLDER_ID.to_owned())),
            Some(parent) => Reference {
                reference_type: self.child_reference(place),
                is_forward: false,
                target: self.id(interface.identifier(parent)),
            },
        }
    }

    fn child_reference(&self, child: Place) -> NodeId {
        match child {
            Place::Operation(_) => self.type_id(model::HAS_OPERATION),
            _ => ReferenceTypeId::HasComponent.into(),
        }
    }

    pub(super) fn part_references(&self, at: &At, part: &'static Part) -> Vec<Reference> {
        let owner = at.interface.identifier(at.place);
        let own = format!("{owner}#{}", part.name);
        let mut references = Vec::new();
        let shown = match at.below {
            Some(below) => {
                references.push(reference(ReferenceTypeId::HasProperty, false, self.id(own)));
                below
            }
            None => {
                references.push(reference(part_reference(part), false, self.id(owner)));
                for below in at.interface.parts_of_part(at.place, part) {
                    let target = self.id(format!("{own}#{}", below.name));
                    references.push(reference(ReferenceTypeId::HasProperty, true, target));
                }
                part
            }
        };
        let definition =
            self.part_node(shown, at.interface.unit_of(at.place, shown)).type_definition;
        references
            .extend(definition.map(|id| reference(ReferenceTypeId::HasTypeDefinition, true, id)));
        references
    }
}

pub(super) fn reference(
    reference_type: ReferenceTypeId,
    is_forward: bool,
    target: NodeId,
) -> Reference {
    Reference { reference_type: reference_type.into(), is_forward, target }
}

fn part_reference(part: &Part) -> ReferenceTypeId {
    match part.kind {
        PartKind::Property(_) => ReferenceTypeId::HasProperty,
        _ => ReferenceTypeId::HasComponent,
    }
}
