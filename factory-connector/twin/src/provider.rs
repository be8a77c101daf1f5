//! What the twin hosts: providers of nodes, whose namespaces and nodes come and go while clients
//! are connected.
//!
//! A provider computes its nodes when it is asked for them; nothing obliges it to store one object
//! per node. The host turns the answers into OPC UA services and keeps everything that is alike for
//! all providers: filters, continuation, roles, attributes.

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

/// A namespace that a provider brings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProvidedNamespace {
    /// Its index on this server.
    pub index: u16,
    /// Its URI.
    pub uri: String,
    /// The version of the information model, for a namespace of types.
    pub version: Option<String>,
}

/// A node without its value: what the other attributes of OPC 10000-3 §5 are made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// BrowseName.
    pub browse_name: QualifiedName,
    /// DisplayName.
    pub display_name: LocalizedText,
    /// Description; null where there is none.
    pub description: LocalizedText,
    /// The type definition of objects and variables.
    pub type_definition: Option<NodeId>,
    /// What only nodes of its class have.
    pub class: NodeKind,
}

/// What only nodes of one class have.
#[derive(Debug, Clone, PartialEq)]
pub enum NodeKind {
    /// An object; it is no event notifier (events are reported by the Server object).
    Object,
    /// A variable.
    Variable {
        /// DataType.
        data_type: NodeId,
        /// ValueRank.
        value_rank: i32,
        /// Whether clients in a role that may write may write it now.
        is_writable: bool,
    },
    /// A method.
    Method {
        /// The least role that may call it.
        callable_by: Role,
    },
    /// An object type.
    ObjectType {
        /// IsAbstract.
        is_abstract: bool,
    },
    /// A reference type.
    ReferenceType {
        /// IsAbstract.
        is_abstract: bool,
        /// Symmetric.
        is_symmetric: bool,
        /// InverseName; null for symmetric and abstract ones.
        inverse_name: LocalizedText,
    },
    /// A data type.
    DataType {
        /// DataTypeDefinition, for enumerations and structures.
        definition: Option<Box<ExtensionObject>>,
    },
}

impl NodeKind {
    /// The NodeClass.
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

/// A reference as seen from the node it was asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    /// The type of the reference.
    pub reference_type: NodeId,
    /// Whether it leads from the node asked for to the target.
    pub is_forward: bool,
    /// The node at its other end.
    pub target: NodeId,
}

/// Receives references with the position after them; stops the enumeration with `Break`.
pub type ReferenceVisitor<'a> = dyn FnMut(u64, Reference) -> ControlFlow<()> + 'a;

/// One value that a client wants to write.
#[derive(Debug, Clone)]
pub struct WriteRequest<'a> {
    /// The node.
    pub node_id: &'a NodeId,
    /// The attribute.
    pub attribute: AttributeId,
    /// Whether only a part of an array is to be written.
    pub has_index_range: bool,
    /// The value with what status and time the client gave it.
    pub value: &'a DataValue,
}

/// What a method call came to.
#[derive(Debug, Clone, PartialEq)]
pub struct CallOutcome {
    /// Good, or why not.
    pub status: StatusCode,
    /// The output arguments.
    pub outputs: Vec<Variant>,
    /// With `BadInvalidArgument`: a status for every input argument.
    pub argument_statuses: Vec<StatusCode>,
}

impl CallOutcome {
    /// The call succeeded.
    #[must_use]
    pub fn good(outputs: Vec<Variant>) -> Self {
        Self { status: StatusCode::Good, outputs, argument_statuses: Vec::new() }
    }

    /// The call failed as a whole.
    #[must_use]
    pub fn failed(status: StatusCode) -> Self {
        Self { status, outputs: Vec::new(), argument_statuses: Vec::new() }
    }

    /// The input arguments are wrong.
    #[must_use]
    pub fn invalid_arguments(argument_statuses: Vec<StatusCode>) -> Self {
        Self { status: StatusCode::BadInvalidArgument, outputs: Vec::new(), argument_statuses }
    }
}

/// A source of nodes within its own namespaces.
#[async_trait]
pub trait NodeProvider: Send + Sync + 'static {
    /// The provider's name in logs.
    fn name(&self) -> &'static str;

    /// The namespaces whose nodes it provides.
    fn namespaces(&self) -> Vec<ProvidedNamespace>;

    /// The node with this id, if there is one (now).
    fn node(&self, node_id: &NodeId) -> Option<Node>;

    /// The value of a variable; `None` where the node does not exist or has none.
    fn value(&self, node_id: &NodeId) -> Option<DataValue>;

    /// Enumerates the references of a node that this provider knows, in a stable order, beginning
    /// after a position (0: from the first). It is asked about foreign nodes too: that is how its
    /// nodes hang under standard ones.
    fn references(&self, node_id: &NodeId, after: u64, visit: &mut ReferenceVisitor<'_>);

    /// The targets of forward references to nodes of this BrowseName, where the provider can tell
    /// faster than by enumerating; `None` means enumerate.
    fn targets_named(
        &self,
        _node_id: &NodeId,
        _browse_name: &QualifiedName,
    ) -> Option<Vec<Reference>> {
        None
    }

    /// Every variable that it has now: whose monitored items are told when the provider is taken
    /// away.
    fn variables(&self) -> Vec<NodeId> {
        Vec::new()
    }

    /// The types it brings: (type, supertype, class). The server needs to know them for filters.
    fn types(&self) -> Vec<(NodeId, NodeId, NodeClass)> {
        Vec::new()
    }

    /// Tells newly registered monitored items the present values, in order with what is published
    /// otherwise: what changed between their first read and their registration was notified to
    /// nobody.
    fn tell_again(&self, _items: &[&MonitoredItemRef]) {}

    /// Writes an attribute. The answer may be delayed until the value is durable.
    async fn write(&self, user: &TwinUser, request: WriteRequest<'_>) -> StatusCode;

    /// Calls a method. The host has checked that the user's role may call it.
    async fn call(
        &self,
        user: &TwinUser,
        object: &NodeId,
        method: &NodeId,
        arguments: &[Variant],
    ) -> CallOutcome;
}
