//! Nodes as documents: NodeSet2 XML (OPC 10000-6 Annex F), written and read.
//!
//! The reader is bounded and takes what our models need: objects, variables with values, methods
//! and types. Namespace indexes are resolved, so that a node set in memory knows URIs only.

mod error;
mod names;
mod namespaces;
mod read;
mod value;
mod write;
mod xml;

pub use error::NodeSetError;
pub use read::read;
pub use write::write;

use crate::values::{DateTime, NodeId, QualifiedName, Variant};

/// Nodes and the models they belong to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NodeSet {
    /// The models whose nodes these are.
    pub models: Vec<Model>,
    pub nodes: Vec<Node>,
}

/// A namespace with its version.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Model {
    pub uri: String,
    /// Version of the model, as published with it.
    pub version: Option<String>,
    /// Publication time of the version.
    pub publication_date: Option<DateTime>,
    /// The models it builds on.
    pub required: Vec<Model>,
}

impl Model {
    /// The standard's own model.
    #[must_use]
    pub fn ua() -> Self {
        Self {
            uri: "http://opcfoundation.org/UA/".to_owned(),
            version: Some("1.04".to_owned()),
            publication_date: "2018-05-15T00:00:00Z".parse().ok(),
            required: Vec::new(),
        }
    }
}

/// Node of a NodeSet2 document with its references, as one `UA...` element declares it.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    pub node_id: NodeId,
    /// Its name in browse paths.
    pub browse_name: QualifiedName,
    /// Its name for people.
    pub display_name: String,
    /// Description attribute of the node.
    pub description: Option<String>,
    /// Node class, with the attributes of the class.
    pub class: NodeClass,
    /// Its references. Each is listed at one of its ends at least.
    pub references: Vec<Reference>,
}

/// Node classes with the attributes of their own.
#[derive(Debug, Clone, PartialEq)]
pub enum NodeClass {
    Object,
    Variable {
        data_type: NodeId,
        value_rank: i32,
        value: Variant,
        is_writable: bool,
    },
    Method,
    ObjectType {
        is_abstract: bool,
    },
    VariableType {
        is_abstract: bool,
        data_type: NodeId,
        value_rank: i32,
    },
    ReferenceType {
        is_abstract: bool,
        is_symmetric: bool,
        inverse_name: Option<String>,
    },
    DataType {
        is_abstract: bool,
        /// The values and names of an enumeration; empty for other data types.
        enumeration: Vec<(i64, String)>,
    },
}

/// A reference of a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    pub reference_type: NodeId,
    /// The node at the other end.
    pub target: NodeId,
    /// False where the node is its target and `target` its source.
    pub is_forward: bool,
}

impl Node {
    /// A node whose display name is its browse name.
    #[must_use]
    pub fn new(node_id: NodeId, browse_name: QualifiedName, class: NodeClass) -> Self {
        Self {
            display_name: browse_name.name.as_deref().unwrap_or_default().to_owned(),
            node_id,
            browse_name,
            description: None,
            class,
            references: Vec::new(),
        }
    }

    /// Adds a forward reference.
    #[must_use]
    pub fn with(mut self, reference_type: NodeId, target: NodeId) -> Self {
        self.references.push(Reference { reference_type, target, is_forward: true });
        self
    }

    /// Adds an inverse reference.
    #[must_use]
    pub fn with_inverse(mut self, reference_type: NodeId, target: NodeId) -> Self {
        self.references.push(Reference { reference_type, target, is_forward: false });
        self
    }

    /// The target of the first forward reference of a type.
    #[must_use]
    pub fn target(&self, reference_type: &NodeId) -> Option<&NodeId> {
        self.references
            .iter()
            .find(|reference| reference.is_forward && reference.reference_type == *reference_type)
            .map(|reference| &reference.target)
    }
}

/// Nodes of namespace 0 that every model uses.
pub mod ns0 {
    use crate::values::NodeId;

    /// The reference type Organizes.
    pub const ORGANIZES: NodeId = NodeId::ua(35);
    /// The reference type HasModellingRule.
    pub const HAS_MODELLING_RULE: NodeId = NodeId::ua(37);
    /// The reference type HasTypeDefinition.
    pub const HAS_TYPE_DEFINITION: NodeId = NodeId::ua(40);
    /// The reference type HasSubtype.
    pub const HAS_SUBTYPE: NodeId = NodeId::ua(45);
    /// The reference type HasProperty.
    pub const HAS_PROPERTY: NodeId = NodeId::ua(46);
    /// The reference type HasComponent.
    pub const HAS_COMPONENT: NodeId = NodeId::ua(47);
    /// The object type BaseObjectType.
    pub const BASE_OBJECT_TYPE: NodeId = NodeId::ua(58);
    /// The object type FolderType.
    pub const FOLDER_TYPE: NodeId = NodeId::ua(61);
    /// The variable type BaseDataVariableType.
    pub const BASE_DATA_VARIABLE_TYPE: NodeId = NodeId::ua(63);
    /// The variable type PropertyType.
    pub const PROPERTY_TYPE: NodeId = NodeId::ua(68);
    /// The modelling rule Mandatory.
    pub const MODELLING_RULE_MANDATORY: NodeId = NodeId::ua(78);
    /// The modelling rule Optional.
    pub const MODELLING_RULE_OPTIONAL: NodeId = NodeId::ua(80);
    /// The folder Objects.
    pub const OBJECTS_FOLDER: NodeId = NodeId::ua(85);
    /// The abstract data type Enumeration.
    pub const ENUMERATION: NodeId = NodeId::ua(29);
    /// The variable type AnalogUnitType.
    pub const ANALOG_UNIT_TYPE: NodeId = NodeId::ua(17497);
    /// The data type EUInformation.
    pub const EU_INFORMATION: NodeId = NodeId::ua(887);
}
