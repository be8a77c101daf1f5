//! OPC UA built-in values (OPC 10000-6 §5.1.2) as plain data: value, status and time together.
//!
//! These are our own types so that the shared language needs no OPC UA stack. Namespaces are URIs;
//! an index stays only where a foreign message gave one without its table.

mod date_time;
mod named_type;
mod node_id;
mod scalar;
mod status_code;
mod structure_type;

pub use date_time::{DateTime, InvalidDateTime};
pub use named_type::{EnumType, EnumValue, SimpleType};
pub use node_id::{
    ExpandedNodeId, Identifier, InvalidNodeId, Namespace, NodeId, QualifiedName, Server,
};
pub use scalar::{
    Array, BuiltInType, DiagnosticInfo, ExtensionBody, ExtensionObject, LocalizedText, Scalar,
    StructureValue, Variant,
};
pub use status_code::StatusCode;
pub use structure_type::{STRUCTURE, StructureField, StructureKind, StructureType};

/// A value with its quality and times (OPC 10000-4 §7.11). The three never travel apart.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DataValue {
    /// The value; [`Variant::Null`] where there is none.
    pub value: Variant,
    /// The quality; Good where nothing is said.
    pub status: StatusCode,
    /// When the source measured the value.
    pub source_timestamp: Option<DateTime>,
    /// Further resolution of the source time, in units of 10 ps (0 to 9999).
    pub source_picoseconds: u16,
    /// When the server last knew the value to be true.
    pub server_timestamp: Option<DateTime>,
    /// Further resolution of the server time, in units of 10 ps (0 to 9999).
    pub server_picoseconds: u16,
}

impl DataValue {
    /// A Good value measured at a time.
    #[must_use]
    pub fn good(value: impl Into<Variant>, source_timestamp: DateTime) -> Self {
        Self { value: value.into(), source_timestamp: Some(source_timestamp), ..Self::default() }
    }

    /// No value, only a status and the time since which it holds.
    #[must_use]
    pub fn status_only(status: StatusCode, source_timestamp: Option<DateTime>) -> Self {
        Self { status, source_timestamp, ..Self::default() }
    }
}
