//! The OPC UA type model of the Activity Status Interface as plain facts: object types with their
//! parts, reference types and enumerations, with numeric ids that never change.
//!
//! The twin builds its address space from these tables and [`node_set`] writes the NodeSet2 file
//! from them, so that the two cannot drift apart.

mod ids;
mod model;
mod namespaces;
mod nodes;
mod tables;

pub use ids::*;
pub use model::{
    Argument, DataType, Enumeration, Method, ObjectType, Part, PartKind, ReferenceSupertype,
    ReferenceType, ValueType,
};
pub use namespaces::{
    ASI_MODEL_VERSION, ASI_NAMESPACE_URI, ASI_PUBLICATION_DATE, INSTANCE_NAMESPACE_PREFIX, asi,
    browse_name, instance_namespace_uri,
};
pub use nodes::node_set;
pub use tables::{
    CONDITION_KIND, ENUMERATIONS, FIELD_PARTS, MAPPING_STATE, OBJECT_TYPES, OPERATION_STATE,
    REFERENCE_TYPES, RELATION_TYPE, UPDATE_FREQUENCY_UNIT, VALUE_SOURCE,
};

/// The object type with this id.
#[must_use]
pub fn object_type(id: u32) -> Option<&'static ObjectType> {
    OBJECT_TYPES.iter().find(|known| known.id == id)
}

/// The parts of a type, those of its supertypes first.
pub fn parts_of_type(id: u32) -> impl Iterator<Item = &'static Part> {
    let own = object_type(id);
    let inherited = own.and_then(|own| own.supertype).and_then(object_type);
    inherited.into_iter().chain(own).flat_map(|known| known.parts)
}
