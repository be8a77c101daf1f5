//! References between the nodes of interfaces, computed from addresses and parts.

use asi_model::{
    OperationNetworkId,
    instance::{FOLDER_ID, encode_segment},
};
use opcua_stack::opcua::types::{NodeId, ObjectId, ReferenceTypeId};
use parking_lot::RwLock;

use super::{
    interface::Interface,
    interfaces::Interfaces,
    location::Location,
    model::{self, FOLDER_PARTS, Part, PartKind},
    node_address::NodeAddress,
    node_ids::NodeIds,
    nodes::{self, field_type},
    types::folder_type,
};
use crate::provider::{ProvidedReference, ReferenceVisitor};

/// Positions up to this belong to the folder's fixed references; the sequence numbers of interfaces
/// follow.
const FOLDER_OWN_REFERENCES: u64 = 16;

/// Visits the references of the folder after a position.
pub(super) fn of_folder(
    ids: NodeIds,
    interfaces: &RwLock<Interfaces>,
    after: u64,
    visit: &mut ReferenceVisitor<'_>,
) {
    let folder = FOLDER_ID.to_owned();
    let own = [
        reference(ReferenceTypeId::Organizes, false, ObjectId::ObjectsFolder.into()),
        reference(ReferenceTypeId::HasTypeDefinition, true, folder_type()),
        reference(
            ReferenceTypeId::HasProperty,
            true,
            ids.instance(format!("{folder}#{}", FOLDER_PARTS[0].name)),
        ),
    ];
    for (position, reference) in (1..).zip(own).filter(|(position, _)| *position > after) {
        if visit(position, reference).is_break() {
            return;
        }
    }
    let mut sequence = after.saturating_sub(FOLDER_OWN_REFERENCES);
    // Locks for each interface separately, because the visitor looks up the targets.
    loop {
        let next = interfaces.read().after(sequence);
        let Some((found, id)) = next else { return };
        sequence = found;
        let reference = organizes(ids, &id);
        if visit(FOLDER_OWN_REFERENCES + sequence, reference).is_break() {
            return;
        }
    }
}

/// Returns the reference from the folder to an interface.
pub(super) fn organizes(ids: NodeIds, id: &OperationNetworkId) -> ProvidedReference {
    let mut identifier = String::new();
    encode_segment(&mut identifier, id.as_str());
    reference(ReferenceTypeId::Organizes, true, ids.instance(identifier))
}

/// Returns the references of an object or field.
pub(super) fn of_object_or_field(
    ids: NodeIds,
    interface: &Interface,
    address: NodeAddress,
) -> Vec<ProvidedReference> {
    let identifier = interface.identifier(address);
    let mut references = vec![to_parent(ids, interface, address)];
    let definition = match address {
        NodeAddress::Field(field) => Some(field_type(interface.field(field).1)),
        _ => interface.type_of(address).map(|id| ids.type_id(id)),
    };
    references.extend(definition.map(|id| reference(ReferenceTypeId::HasTypeDefinition, true, id)));
    for part in interface.parts(address) {
        references.push(reference(
            part_reference(part),
            true,
            ids.instance(format!("{identifier}#{}", part.name)),
        ));
    }
    for child in interface.children(address) {
        references.push(ProvidedReference {
            reference_type: child_reference(ids, child),
            is_forward: true,
            target: ids.instance(interface.identifier(child)),
        });
    }
    if let NodeAddress::Operation(operation) = address {
        push_dependencies(ids, interface, operation, &mut references);
    }
    references
}

/// Adds the references between operations that represent their relations.
fn push_dependencies(
    ids: NodeIds,
    interface: &Interface,
    operation: u32,
    references: &mut Vec<ProvidedReference>,
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
            references.push(ProvidedReference {
                reference_type: ids.type_id(model::dependency(relation.relation_type)),
                is_forward,
                target: ids.instance(interface.identifier(NodeAddress::Operation(other))),
            });
        }
    }
}

fn to_parent(ids: NodeIds, interface: &Interface, address: NodeAddress) -> ProvidedReference {
    match interface.parent(address) {
        None => reference(ReferenceTypeId::Organizes, false, ids.instance(FOLDER_ID.to_owned())),
        Some(parent) => ProvidedReference {
            reference_type: child_reference(ids, address),
            is_forward: false,
            target: ids.instance(interface.identifier(parent)),
        },
    }
}

fn child_reference(ids: NodeIds, child: NodeAddress) -> NodeId {
    match child {
        NodeAddress::Operation(_) => ids.type_id(model::HAS_OPERATION),
        _ => ReferenceTypeId::HasComponent.into(),
    }
}

/// Returns the references of a part, or of the part's property at a location.
pub(super) fn of_part(
    ids: NodeIds,
    location: &Location,
    part: &'static Part,
) -> Vec<ProvidedReference> {
    let owner = location.interface.identifier(location.address);
    let own = format!("{owner}#{}", part.name);
    let mut references = Vec::new();
    let shown = match location.below {
        Some(below) => {
            references.push(reference(ReferenceTypeId::HasProperty, false, ids.instance(own)));
            below
        }
        None => {
            references.push(reference(part_reference(part), false, ids.instance(owner)));
            for below in location.interface.parts_of_part(location.address, part) {
                let target = ids.instance(format!("{own}#{}", below.name));
                references.push(reference(ReferenceTypeId::HasProperty, true, target));
            }
            part
        }
    };
    let definition = nodes::part(ids, shown, location.interface.unit_of(location.address, shown))
        .type_definition;
    references.extend(definition.map(|id| reference(ReferenceTypeId::HasTypeDefinition, true, id)));
    references
}

/// Returns a reference of a standard type.
pub(super) fn reference(
    reference_type: ReferenceTypeId,
    is_forward: bool,
    target: NodeId,
) -> ProvidedReference {
    ProvidedReference { reference_type: reference_type.into(), is_forward, target }
}

fn part_reference(part: &Part) -> ReferenceTypeId {
    match part.kind {
        PartKind::Property(_) => ReferenceTypeId::HasProperty,
        _ => ReferenceTypeId::HasComponent,
    }
}
