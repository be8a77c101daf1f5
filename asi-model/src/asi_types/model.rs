//! Shapes of the tables: object types with their parts, methods, enumerations and reference types.

use super::namespaces::{asi, browse_name};
use crate::values::{NodeId, QualifiedName};

/// An object type.
#[derive(Debug)]
pub struct ObjectType {
    /// Its numeric id in [`ASI_NAMESPACE_URI`](super::ASI_NAMESPACE_URI).
    pub id: u32,
    pub name: &'static str,
    /// The object type it specialises; BaseObjectType where there is none.
    pub supertype: Option<u32>,
    /// True where only subtypes have instances.
    pub is_abstract: bool,
    /// Description attribute of the type node.
    pub description: &'static str,
    /// Its parts with fixed BrowseNames. The declaration of the n-th (from 1) has the id `id * 100
    /// + n`.
    pub parts: &'static [Part],
}

/// A part with a fixed BrowseName.
#[derive(Debug)]
pub struct Part {
    pub name: &'static str,
    /// True where the BrowseName is the standard's (namespace 0).
    pub is_standard: bool,
    /// True where every instance has the part (modelling rule Mandatory).
    pub is_mandatory: bool,
    pub kind: PartKind,
}

/// Node class of a part, with its type.
#[derive(Debug, Clone, Copy)]
pub enum PartKind {
    Property(ValueType),
    /// A component variable; AnalogUnitType where it has a unit, else BaseDataVariableType.
    Component(ValueType),
    /// A component object of an ASI type.
    Object(u32),
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
    pub name: &'static str,
    pub data_type: DataType,
    /// Purpose of the argument, for people.
    pub description: &'static str,
}

/// An enumeration whose values count from 0. Its EnumStrings have the id `id * 100 + 1`.
#[derive(Debug)]
pub struct Enumeration {
    /// Its numeric id.
    pub id: u32,
    pub name: &'static str,
    /// The names of its values.
    pub values: &'static [&'static str],
}

/// A reference type.
#[derive(Debug)]
pub struct ReferenceType {
    /// Its numeric id.
    pub id: u32,
    pub name: &'static str,
    /// Name of the reference as read from its target.
    pub inverse_name: Option<&'static str>,
    /// True where only subtypes are used.
    pub is_abstract: bool,
    /// The reference type it specialises: of namespace 0, or one of ours.
    pub supertype: ReferenceSupertype,
}

/// Supertype of a reference type.
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
