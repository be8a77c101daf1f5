//! [`asi_model::values`] to the stack's values and back.
//!
//! Nothing is lost on the way in: a structure whose definition is known becomes named fields, any
//! other keeps its bytes under the id it came with. On the way out an unknown namespace is an
//! error, never a wrong index.

mod from_stack;
mod ids;
mod to_stack;

pub use from_stack::{from_stack, variant_from_stack};
pub use ids::{
    expanded_node_id_from_stack, expanded_node_id_to_stack, localized_text_from_stack,
    localized_text_to_stack, node_id_from_stack, node_id_to_stack, qualified_name_from_stack,
    qualified_name_to_stack, status_from_stack, status_to_stack, time_from_stack, time_to_stack,
};
pub use to_stack::{to_stack, variant_to_stack};

/// Deepest nesting of variants, structures and data values that is converted.
pub const DEPTH_MAX: usize = 64;

/// A value cannot be said in the peer's terms.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ConversionError {
    /// The peer has no such namespace.
    #[error("the server has no namespace {uri:?}")]
    UnknownNamespace { uri: String },
    /// A node on another server, which only that server's URI names.
    #[error("the server has no server table entry for {uri:?}")]
    UnknownServer {
        /// The other server's URI.
        uri: String,
    },
    /// The structure's definition is not known, so its fields cannot be encoded.
    #[error("the data type {type_id} of a structure is not known to the server")]
    UnknownStructure { type_id: String },
    /// The value does not fit the structure's definition.
    #[error("the value does not fit the data type {type_id}: {reason}")]
    StructureMismatch {
        type_id: String,
        /// Field or type that does not fit.
        reason: String,
    },
    /// A body in JSON, which OPC UA Binary cannot carry.
    #[error(
        "a structure of the data type {type_id} is known as JSON only and cannot be sent in OPC UA Binary"
    )]
    JsonBody { type_id: String },
    /// The elements of an array do not agree with its type or dimensions.
    #[error("an array's elements do not agree with its type or dimensions")]
    InvalidArray,
    /// Nested deeper than [`DEPTH_MAX`].
    #[error("the value is nested deeper than {DEPTH_MAX} levels")]
    TooDeep,
    /// The stack could not encode a structure.
    #[error("a structure of the data type {type_id} could not be encoded: {reason}")]
    Encoding {
        type_id: String,
        /// Message of the stack.
        reason: String,
    },
}
