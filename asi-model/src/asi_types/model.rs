//! Shapes of the tables: object types with their parts, methods, enumerations and reference types.

use super::namespaces::{asi, browse_name};
use crate::values::{NodeId, QualifiedName};

/// Row of the table of object types; becomes one ObjectType node (OPC 10000-3 §5.5.2).
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
    pub data_type: DataType,
    /// -1 scalar, 1 array.
    pub value_rank: i32,
}

/// Data type of a variable or argument: a standard one, or an enumeration of the ASI namespace.
#[derive(Debug, Clone, Copy)]
pub enum DataType {
    /// Numeric id in namespace 0, as 12 for String.
    Standard(u32),
    Enumeration(&'static Enumeration),
}

/// Signature of a method: what its properties InputArguments and OutputArguments list.
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
    /// Numeric id in the ASI namespace.
    pub id: u32,
    pub name: &'static str,
    /// The names of its values.
    pub values: &'static [&'static str],
}

/// Row of the table of reference types; becomes one ReferenceType node (OPC 10000-3 §5.3).
#[derive(Debug)]
pub struct ReferenceType {
    /// Numeric id in the ASI namespace.
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
    /// Numeric id of a reference type in namespace 0.
    Standard(u32),
    /// Numeric id of a reference type in the ASI namespace.
    Asi(u32),
}

impl DataType {
    /// Returns the NodeId of the DataType node, in namespace 0 or the ASI namespace.
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
