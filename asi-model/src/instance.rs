//! Activity Status Interfaces as OPC UA nodes: their readable NodeIds, the nodes of a whole
//! interface, and the way back.
//!
//! A node set with one interface is accepted in place of the JSON of an `operation-network`
//! message: [`to_json`] returns the content of the nodes, which the usual validation then checks.

mod from_nodes;
mod nodes;
mod path;

use std::collections::HashMap;

pub use from_nodes::to_json;
pub use nodes::node_set;
pub use path::{FOLDER_ID, FOLDER_NAME, Path, decode_segment, encode_segment};

use crate::{
    ids::{FieldKey, RequestKey},
    messages::{MappingState, OperationNetworkMessage, ValueSource},
    values::{DateTime, Variant},
};

/// An interface to be written as nodes: the message that asked for it, and what has become of it.
#[derive(Debug, Clone)]
pub struct Instance<'a> {
    pub message: &'a OperationNetworkMessage,
    /// Time of receipt, by the connector's clock.
    pub received_at: Option<DateTime>,
    pub writers: HashMap<RequestKey, u16>,
    /// Decisions and values of its fields; absent ones are undecided.
    pub fields: HashMap<FieldKey, FieldState>,
}

/// Decision on a field, with the source and precision of its values.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FieldState {
    pub mapping_state: MappingState,
    /// Present for mapped fields.
    pub value_source: Option<ValueSource>,
    /// The value after the disclosure gate; Null before the first one.
    pub value: Variant,
    /// One sentence on how values are coarsened before they leave.
    pub disclosure: Option<String>,
    /// The engineer's reason, in words for the partner.
    pub reason: Option<String>,
    /// Name of the user who decided.
    pub decided_by: Option<String>,
    pub decision_time: Option<DateTime>,
}

impl<'a> Instance<'a> {
    /// An interface fresh from its message.
    #[must_use]
    pub fn new(message: &'a OperationNetworkMessage) -> Self {
        Self { message, received_at: None, writers: HashMap::new(), fields: HashMap::new() }
    }
}

#[cfg(test)]
mod tests;
