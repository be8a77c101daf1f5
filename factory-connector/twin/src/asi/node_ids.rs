//! NodeIds in the two namespaces of the interfaces.

use opcua_stack::opcua::types::NodeId;

/// Namespace indexes on this server.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodeIds {
    /// Index of the type namespace.
    pub types: u16,
    /// Index of the instance namespace.
    pub instances: u16,
}

impl NodeIds {
    /// Returns the NodeId of an instance.
    pub(super) fn instance(self, identifier: String) -> NodeId {
        NodeId::new(self.instances, identifier)
    }

    /// Returns the NodeId of a type.
    pub(super) fn type_id(self, id: u32) -> NodeId {
        NodeId::new(self.types, id)
    }
}
