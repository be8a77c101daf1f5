//! OPC UA built-in values (OPC 10000-6 §5.1.2) as plain data: value, status and time together.
//!
//! These are our own types so that the shared language needs no OPC UA stack. Namespaces are URIs;
//! an index stays only where a foreign message gave one without its table.

mod built_in_type;
mod date_time;
mod named_type;
mod node_id;
mod scalar;
mod status_code;
mod structure_type;

pub use built_in_type::BuiltInType;
pub use date_time::{DateTime, InvalidDateTime};
pub use named_type::{EnumType, EnumValue, SimpleType};
pub use node_id::{
    ExpandedNodeId, Identifier, InvalidNodeId, Namespace, NodeId, QualifiedName, Server,
};
pub use scalar::{
    Array, DataValue, DiagnosticInfo, ExtensionBody, ExtensionObject, LocalizedText, Scalar,
    StructureValue, Variant,
};
pub use status_code::StatusCode;
pub use structure_type::{STRUCTURE, StructureField, StructureKind, StructureType};
