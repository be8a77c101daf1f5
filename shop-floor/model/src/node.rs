//! Nodes and variables as browsing returns them.

use std::sync::Arc;

use asi_model::values::{BuiltInType, NodeId, StatusCode, Variant};
use serde::{Serialize, Serializer};
use utoipa::ToSchema;

use crate::BrowsePath;

/// A node as a person picks it in a tree.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct BrowsedNode {
    pub node_id: NodeId,
    /// Its browse name, as an element of a browse path.
    pub browse_name: String,
    /// Its name for people.
    pub display_name: String,
    /// Description of the server, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    pub node_class: NodeClass,
    /// Type of an object or variable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub type_definition: Option<NodeType>,
    /// The type of a variable's value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data_type: Option<NodeType>,
    /// Built-in type that carries the value: the data type itself, or the base of an enumeration or
    /// structure.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "built_in_name")]
    pub built_in_type: Option<BuiltInType>,
    /// Rank of a variable: -1 scalar, 1 or more the number of dimensions, 0 one or more, -2 any, -3
    /// scalar or one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value_rank: Option<i32>,
    /// The unit of an analog variable.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<UnitName>,
    /// The usual range of an analog variable, low and high.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<(f64, f64)>,
    /// True when the signed-in user may write the value.
    pub is_writable: bool,
    /// True when it has child nodes.
    pub has_children: bool,
    /// Path from the Objects folder; only in answers to a search.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub browse_path: Option<BrowsePath>,
}

/// A variable in a list of all that a server has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedVariable {
    pub node_id: NodeId,
    /// Its name for people.
    pub display_name: String,
    /// The way to it from the Objects folder.
    pub browse_path: BrowsePath,
    /// Names of its type and of the types of the nodes above it, each with its supertypes, nearest
    /// first.
    pub type_names: Vec<Arc<str>>,
}

/// The variables of a server.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct VariableList {
    /// The variables, those nearest the Objects folder first.
    pub variables: Vec<ListedVariable>,
    /// False where the address space was too large to be walked through to the end.
    pub is_complete: bool,
}

/// A type's identity and name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NodeType {
    pub node_id: NodeId,
    /// Its browse name without the namespace; empty where the server does not know the type.
    pub name: String,
}

/// A unit as the server gives it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct UnitName {
    /// Symbol for people: `mm/s`.
    pub display_name: String,
    /// The UNECE code behind it (`C16`), where the unit is one of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub code: Option<String>,
}

/// Node classes (OPC 10000-3 §5.2.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
#[allow(missing_docs)]
pub enum NodeClass {
    Object,
    Variable,
    Method,
    ObjectType,
    VariableType,
    ReferenceType,
    DataType,
    View,
}

/// Outcome of a method call.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceCallResult {
    pub status: StatusCode,
    /// Output arguments, in the order of the method.
    pub outputs: Vec<Variant>,
}

#[allow(clippy::ref_option)] // The signature that serde asks for.
fn built_in_name<S: Serializer>(
    built_in: &Option<BuiltInType>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    built_in.map(BuiltInType::name).serialize(serializer)
}
