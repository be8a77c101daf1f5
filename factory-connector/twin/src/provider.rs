//! Providers of nodes, which the twin hosts. They may be added and removed while clients are connected.
//!
//! A provider computes its nodes on request and need not store one object per node. The host
//! implements the OPC UA services on top, with the tasks that are the same for all providers: filters,
//! continuation, roles, attributes.

use std::ops::ControlFlow;

use async_trait::async_trait;
use opcua_stack::opcua::{
    server::node_manager::MonitoredItemRef,
    types::{
        AttributeId, DataValue, ExtensionObject, LocalizedText, NodeClass, NodeId, QualifiedName,
        StatusCode, Variant,
    },
};

use crate::access::{Role, TwinUser};

/// Index and URI under which a provider shows its nodes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProvidedNamespace {
    /// Its index in the server's NamespaceArray.
    pub index: u16,
    pub uri: String,
    /// The version of the information model, for a namespace of types.
    pub version: Option<String>,
}

/// A node without its value, with which all other attributes of OPC 10000-3 §5 are computed.
#[derive(Debug, Clone, PartialEq)]
pub struct ProvidedNode {
    pub browse_name: QualifiedName,
    pub display_name: LocalizedText,
    /// Null when there is none.
    pub description: LocalizedText,
    /// The type definition of objects and variables.
    pub type_definition: Option<NodeId>,
    pub class: NodeKind,
}

/// NodeClass, with the attributes of nodes of this class.
#[derive(Debug, Clone, PartialEq)]
pub enum NodeKind {
    /// An object; it is no event notifier (events are reported by the Server object).
    Object,
    Variable {
        data_type: NodeId,
        value_rank: i32,
        /// True when roles with the right to write may do so at present.
        is_writable: bool,
    },
    Method {
        /// The least role that may call it.
        callable_by: Role,
    },
    ObjectType {
        is_abstract: bool,
    },
    ReferenceType {
        is_abstract: bool,
        is_symmetric: bool,
        /// InverseName; null for symmetric and abstract ones.
        inverse_name: LocalizedText,
    },
    DataType {
        /// DataTypeDefinition, for enumerations and structures.
        definition: Option<Box<ExtensionObject>>,
    },
}

impl NodeKind {
    /// Returns the NodeClass.
    #[must_use]
    pub fn node_class(&self) -> NodeClass {
        match self {
            Self::Object => NodeClass::Object,
            Self::Variable { .. } => NodeClass::Variable,
            Self::Method { .. } => NodeClass::Method,
            Self::ObjectType { .. } => NodeClass::ObjectType,
            Self::ReferenceType { .. } => NodeClass::ReferenceType,
            Self::DataType { .. } => NodeClass::DataType,
        }
    }
}

/// A reference of a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProvidedReference {
    pub reference_type: NodeId,
    /// True when it leads from the node to the target.
    pub is_forward: bool,
    /// The node at its other end.
    pub target: NodeId,
}

/// Receives references with the position after them; stops the enumeration with `Break`.
pub type ReferenceVisitor<'a> = dyn FnMut(u64, ProvidedReference) -> ControlFlow<()> + 'a;

/// A value that a client writes.
#[derive(Debug, Clone)]
pub struct WriteRequest<'a> {
    pub node_id: &'a NodeId,
    pub attribute: AttributeId,
    /// True when only a part of an array is written.
    pub has_index_range: bool,
    /// The value, with status and time if the client gave them.
    pub value: &'a DataValue,
}

/// Result of a method call.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodOutcome {
    /// Good, or the cause of the failure.
    pub status: StatusCode,
    /// The output arguments, in their order.
    pub outputs: Vec<Variant>,
    /// Status for every input argument, with `BadInvalidArgument`.
    pub argument_statuses: Vec<StatusCode>,
}

impl MethodOutcome {
    /// Returns the result of a successful call.
    #[must_use]
    pub fn good(outputs: Vec<Variant>) -> Self {
        Self { status: StatusCode::Good, outputs, argument_statuses: Vec::new() }
    }

    /// Returns the result of a call that failed as a whole.
    #[must_use]
    pub fn failed(status: StatusCode) -> Self {
        Self { status, outputs: Vec::new(), argument_statuses: Vec::new() }
    }

    /// Returns the result of a call with wrong input arguments.
    #[must_use]
    pub fn invalid_arguments(argument_statuses: Vec<StatusCode>) -> Self {
        Self { status: StatusCode::BadInvalidArgument, outputs: Vec::new(), argument_statuses }
    }
}

/// A source of nodes within its own namespaces.
#[async_trait]
pub trait NodeProvider: Send + Sync + 'static {
    /// Returns the provider's name in logs.
    fn name(&self) -> &'static str;

    /// Returns the namespaces whose nodes it provides.
    fn namespaces(&self) -> Vec<ProvidedNamespace>;

    /// Returns the node with this id, if it exists at present.
    fn node(&self, node_id: &NodeId) -> Option<ProvidedNode>;

    /// Returns the value of a variable; `None` when the node does not exist or has none.
    fn value(&self, node_id: &NodeId) -> Option<DataValue>;

    /// Enumerates the references of a node that this provider knows, in a stable order, beginning
    /// after a position (0: from the first). It is called for nodes of others too, so that its nodes
    /// can be children of standard ones.
    fn references(&self, node_id: &NodeId, after: u64, visit: &mut ReferenceVisitor<'_>);

    /// Returns the forward references to nodes of this BrowseName, if the provider finds them faster
    /// than by enumerating; `None` means enumerate.
    fn targets_named(
        &self,
        _node_id: &NodeId,
        _browse_name: &QualifiedName,
    ) -> Option<Vec<ProvidedReference>> {
        None
    }

    /// Returns all variables at present: their monitored items are notified when the provider is
    /// removed.
    fn variables(&self) -> Vec<NodeId> {
        Vec::new()
    }

    /// Returns its types as (type, supertype, class). The server needs them for filters.
    fn types(&self) -> Vec<(NodeId, NodeId, NodeClass)> {
        Vec::new()
    }

    /// Publishes the present values to newly registered monitored items, in order with other changes:
    /// they missed the changes between their first read and their registration.
    fn publish_present(&self, _items: &[&MonitoredItemRef]) {}

    /// Writes an attribute. The answer may be delayed until the value is durable.
    async fn write(&self, user: &TwinUser, request: WriteRequest<'_>) -> StatusCode;

    /// Calls a method. The host has checked that the user's role may call it.
    async fn call(
        &self,
        user: &TwinUser,
        object: &NodeId,
        method: &NodeId,
        arguments: &[Variant],
    ) -> MethodOutcome;
}
