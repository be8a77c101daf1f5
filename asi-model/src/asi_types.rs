//! The OPC UA type model of the Activity Status Interface as plain facts: object types with their
//! parts, reference types and enumerations, with numeric ids that never change.
//!
//! The twin builds its address space from these tables and [`node_set`] writes the NodeSet2 file
//! from them, so that the two cannot drift apart.

mod nodes;
mod tables;

pub use nodes::node_set;
pub use tables::{
    CONDITION_KIND, ENUMERATIONS, FIELD_PARTS, MAPPING_STATE, OBJECT_TYPES, OPERATION_STATE,
    REFERENCE_TYPES, RELATION_TYPE, UPDATE_FREQUENCY_UNIT, VALUE_SOURCE,
};

use crate::{
    network::RelationType,
    values::{NodeId, QualifiedName},
};

/// The namespace of the ASI types.
pub const ASI_NAMESPACE_URI: &str = "urn:verbund:UA:ASI";
/// The version of the type model.
pub const ASI_MODEL_VERSION: &str = "1.0.0";
/// When this version was published.
pub const ASI_PUBLICATION_DATE: &str = "2026-11-20T00:00:00Z";

/// The namespace of a factory's ASI instances.
#[must_use]
pub fn instance_namespace_uri(factory_id: &crate::FactoryId) -> String {
    format!("{INSTANCE_NAMESPACE_PREFIX}{factory_id}")
}

/// What every instance namespace begins with; the factory id follows.
pub const INSTANCE_NAMESPACE_PREFIX: &str = "urn:verbund:cpt:";

/// An object type.
#[derive(Debug)]
pub struct ObjectType {
    /// Its numeric id in [`ASI_NAMESPACE_URI`].
    pub id: u32,
    /// Its BrowseName.
    pub name: &'static str,
    /// The object type it specialises; BaseObjectType where there is none.
    pub supertype: Option<u32>,
    /// True where only subtypes have instances.
    pub is_abstract: bool,
    /// What it stands for.
    pub description: &'static str,
    /// Its parts with fixed BrowseNames. The declaration of the n-th (from 1) has the id `id * 100
    /// + n`.
    pub parts: &'static [Part],
}

/// A part with a fixed BrowseName.
#[derive(Debug)]
pub struct Part {
    /// Its BrowseName.
    pub name: &'static str,
    /// Whether the BrowseName is the standard's (namespace 0).
    pub is_standard: bool,
    /// Whether every instance has it.
    pub is_mandatory: bool,
    /// What it is.
    pub kind: PartKind,
}

/// What a part is.
#[derive(Debug, Clone, Copy)]
pub enum PartKind {
    /// A property.
    Property(ValueType),
    /// A component variable; AnalogUnitType where it has a unit, else BaseDataVariableType.
    Component(ValueType),
    /// A component object of an ASI type.
    Object(u32),
    /// A method.
    Method(&'static Method),
}

/// The type of a variable's value.
#[derive(Debug, Clone, Copy)]
pub struct ValueType {
    /// Its data type.
    pub data_type: DataType,
    /// -1 scalar, 1 array.
    pub value_rank: i32,
}

/// A data type.
#[derive(Debug, Clone, Copy)]
pub enum DataType {
    /// Of namespace 0, by its id.
    Standard(u32),
    /// One of ours.
    Enumeration(&'static Enumeration),
}

/// A method's signature.
#[derive(Debug)]
pub struct Method {
    /// Its input arguments. Their property has the declaration's id plus 1 000 000.
    pub inputs: &'static [Argument],
    /// Its output arguments. Their property has the declaration's id plus 2 000 000.
    pub outputs: &'static [Argument],
}

/// An argument of a method, always scalar.
#[derive(Debug)]
pub struct Argument {
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub data_type: DataType,
    /// What it is for.
    pub description: &'static str,
}

/// An enumeration whose values count from 0. Its EnumStrings have the id `id * 100 + 1`.
#[derive(Debug)]
pub struct Enumeration {
    /// Its numeric id.
    pub id: u32,
    /// Its BrowseName.
    pub name: &'static str,
    /// The names of its values.
    pub values: &'static [&'static str],
}

/// A reference type.
#[derive(Debug)]
pub struct ReferenceType {
    /// Its numeric id.
    pub id: u32,
    /// Its BrowseName.
    pub name: &'static str,
    /// What the reference is called from its target's side.
    pub inverse_name: Option<&'static str>,
    /// True where only subtypes are used.
    pub is_abstract: bool,
    /// The reference type it specialises: of namespace 0, or one of ours.
    pub supertype: ReferenceSupertype,
}

/// What a reference type specialises.
#[derive(Debug, Clone, Copy)]
pub enum ReferenceSupertype {
    /// A reference type of namespace 0.
    Standard(u32),
    /// One of ours.
    Asi(u32),
}

impl DataType {
    /// Its NodeId.
    #[must_use]
    pub fn node_id(self) -> NodeId {
        match self {
            Self::Standard(id) => NodeId::ua(id),
            Self::Enumeration(enumeration) => asi(enumeration.id),
        }
    }
}

impl Part {
    /// Its BrowseName with namespace.
    #[must_use]
    pub fn browse_name(&self) -> QualifiedName {
        browse_name(self.name, self.is_standard)
    }
}

/// A NodeId of the type namespace.
#[must_use]
pub fn asi(id: u32) -> NodeId {
    NodeId::numeric(ASI_NAMESPACE_URI, id)
}

/// A BrowseName of namespace 0 or of the type namespace.
#[must_use]
pub fn browse_name(name: &str, is_standard: bool) -> QualifiedName {
    use crate::values::Namespace;
    let namespace = if is_standard { Namespace::Ua } else { Namespace::uri(ASI_NAMESPACE_URI) };
    QualifiedName { namespace, name: Some(name.into()) }
}

/// ActivityStatusInterfaceType.
pub const INTERFACE_TYPE: u32 = 1001;
/// OperationNetworkType.
pub const OPERATION_NETWORK_TYPE: u32 = 1002;
/// OperationType (abstract).
pub const OPERATION_TYPE: u32 = 1003;
/// ProductionOperationType.
pub const PRODUCTION_OPERATION_TYPE: u32 = 1004;
/// InspectionOperationType.
pub const INSPECTION_OPERATION_TYPE: u32 = 1005;
/// TransportationOperationType.
pub const TRANSPORTATION_OPERATION_TYPE: u32 = 1006;
/// EquipmentRequirementType.
pub const EQUIPMENT_REQUIREMENT_TYPE: u32 = 1007;
/// OperationRelationType.
pub const OPERATION_RELATION_TYPE: u32 = 1008;
/// RelationConditionType.
pub const RELATION_CONDITION_TYPE: u32 = 1009;
/// DynamicDataRequestType.
pub const DYNAMIC_DATA_REQUEST_TYPE: u32 = 1010;
/// ReportDataFormatType.
pub const REPORT_DATA_FORMAT_TYPE: u32 = 1011;
/// HasOperation, a subtype of HasComponent.
pub const HAS_OPERATION: u32 = 2001;
/// OperationDependency (abstract, not hierarchical).
pub const OPERATION_DEPENDENCY: u32 = 2002;

/// The reference type between two related operations, from predecessor to successor.
#[must_use]
pub const fn dependency(relation_type: RelationType) -> u32 {
    2003 + relation_type as u32
}

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
