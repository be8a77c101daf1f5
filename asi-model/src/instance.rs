//! Activity Status Interfaces as OPC UA nodes: their readable NodeIds, the nodes of a whole
//! interface, and the way back.
//!
//! A node set with one interface is accepted in place of the JSON of an `operation-network`
//! message: [`to_json`] says what the nodes say, and the usual validation judges it.

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
    /// The message.
    pub message: &'a OperationNetworkMessage,
    /// When it was received.
    pub received_at: Option<DateTime>,
    /// The writers of its requests.
    pub writers: HashMap<RequestKey, u16>,
    /// Decisions and values of its fields; absent ones are undecided.
    pub fields: HashMap<FieldKey, FieldState>,
}

/// What has become of a field.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FieldState {
    /// Where it stands.
    pub mapping_state: MappingState,
    /// Where its values come from.
    pub value_source: Option<ValueSource>,
    /// Its disclosed value.
    pub value: Variant,
    /// How it is coarsened, in words.
    pub disclosure: Option<String>,
    /// Why it was decided so.
    pub reason: Option<String>,
    /// Who decided.
    pub decided_by: Option<String>,
    /// When.
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
