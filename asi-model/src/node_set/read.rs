//! Reading NodeSet2.

use std::collections::{HashMap, HashSet};

use super::{
    Model, Node, NodeClass, NodeSet, Reference, value,
    xml::{self, Element},
};
use crate::values::{Namespace, NodeId, QualifiedName, Variant};

/// Why a document is not a node set we take.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NodeSetError {
    /// It breaks a limit.
    #[error("the document has more than {count_max} {what}")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many are accepted.
        count_max: usize,
    },
    /// It is not XML or not a NodeSet2.
    #[error("at byte {position}: {message}")]
    Malformed {
        /// Where, roughly.
        position: u64,
        /// What is wrong.
        message: String,
    },
    /// A node is not as it should be.
    #[error("node {node_id}: {message}")]
    Node {
        /// The node as the document names it, cut after 120 characters.
        node_id: String,
        /// What is wrong.
        message: String,
    },
}

impl NodeSetError {
    pub(super) fn malformed(position: u64, message: &str) -> Self {
        Self::Malformed { position, message: message.to_owned() }
    }
}

/// Reads a document.
///
/// # Errors
/// [`NodeSetError`] where it is not XML, not a node set, or breaks a limit.
pub fn read(bytes: &[u8]) -> Result<NodeSet, NodeSetError> {
    let root = xml::read(bytes)?;
    if root.name != "UANodeSet" {
        return Err(NodeSetError::malformed(0, "the root element must be UANodeSet"));
    }
    let names = Names::of(&root);
    let models = root.child("Models").map(|models| models.children.iter().map(model).collect());
    let mut nodes: Vec<Node> = Vec::new();
    let mut ids = HashSet::new();
    for element in &root.children {
        if let Some(class) = class(element, &names) {
            let node = node(element, class?, &names)?;
            if !ids.insert(node.node_id.clone()) {
                return Err(failed(element, "the NodeId is that of an earlier node"));
            }
            nodes.push(node);
        }
    }
    Ok(NodeSet { models: models.unwrap_or_default(), nodes })
}

/// The document's namespaces and aliases.
pub(super) struct Names {
    namespaces: Vec<Namespace>,
    aliases: HashMap<String, String>,
}

impl Names {
    fn of(root: &Element) -> Self {
        let uris =
            root.child("NamespaceUris").map(|list| list.children.as_slice()).unwrap_or_default();
        let aliases =
            root.child("Aliases").map(|list| list.children.as_slice()).unwrap_or_default();
        Self {
            namespaces: uris.iter().map(|uri| Namespace::uri(uri.trimmed())).collect(),
            aliases: aliases
                .iter()
                .filter_map(|alias| {
                    Some((alias.attribute("Alias")?.to_owned(), alias.trimmed().to_owned()))
                })
                .collect(),
        }
    }

    pub(super) fn namespace(&self, namespace: Namespace) -> Option<Namespace> {
        match namespace {
            Namespace::Index(0) => Some(Namespace::Ua),
            Namespace::Index(index) => self.namespaces.get(usize::from(index) - 1).cloned(),
            known => Some(known),
        }
    }

    pub(super) fn node_id(&self, text: &str) -> Option<NodeId> {
        let text = self.aliases.get(text).map_or(text, String::as_str);
        let id: NodeId = text.parse().ok()?;
        Some(NodeId { namespace: self.namespace(id.namespace)?, ..id })
    }

    fn browse_name(&self, text: &str) -> Option<QualifiedName> {
        let name: QualifiedName = text.parse().ok()?;
        Some(QualifiedName { namespace: self.namespace(name.namespace)?, ..name })
    }
}

fn model(element: &Element) -> Model {
    Model {
        uri: element.attribute("ModelUri").unwrap_or_default().to_owned(),
        version: element.attribute("Version").map(ToOwned::to_owned),
        publication_date: element.attribute("PublicationDate").and_then(value::read_time),
        required: element
            .children
            .iter()
            .filter(|child| child.name == "RequiredModel")
            .map(model)
            .collect(),
    }
}

fn failed(element: &Element, message: &str) -> NodeSetError {
    let node_id =
        element.attribute("NodeId").unwrap_or("without NodeId").chars().take(120).collect();
    NodeSetError::Node { node_id, message: message.to_owned() }
}

/// The class of an element that is a node; `None` for others.
fn class(element: &Element, names: &Names) -> Option<Result<NodeClass, NodeSetError>> {
    let flag = |name: &str| element.attribute(name) == Some("true");
    let data_type = || {
        let text = element.attribute("DataType").unwrap_or("i=24");
        names.node_id(text).ok_or_else(|| failed(element, "the DataType is not a NodeId"))
    };
    let value_rank =
        element.attribute("ValueRank").and_then(|rank| rank.parse().ok()).unwrap_or(-1);
    let is_abstract = flag("IsAbstract");
    Some(Ok(match element.name.as_str() {
        "UAObject" => NodeClass::Object,
        "UAMethod" => NodeClass::Method,
        "UAObjectType" => NodeClass::ObjectType { is_abstract },
        "UAVariable" => {
            let data_type = match data_type() {
                Ok(id) => id,
                Err(error) => return Some(Err(error)),
            };
            let access: u8 =
                element.attribute("AccessLevel").and_then(|level| level.parse().ok()).unwrap_or(1);
            let content = element.child("Value");
            let value = content.and_then(|content| value::read(content, names));
            NodeClass::Variable {
                data_type,
                value_rank,
                value: value.unwrap_or(Variant::Null),
                is_writable: access & 2 != 0,
            }
        }
        "UAVariableType" => match data_type() {
            Ok(data_type) => NodeClass::VariableType { is_abstract, data_type, value_rank },
            Err(error) => return Some(Err(error)),
        },
        "UAReferenceType" => NodeClass::ReferenceType {
            is_abstract,
            is_symmetric: flag("Symmetric"),
            inverse_name: element.child("InverseName").map(|name| name.text.clone()),
        },
        "UADataType" => NodeClass::DataType {
            is_abstract,
            enumeration: element
                .child("Definition")
                .map(|definition| {
                    definition.children.iter().filter_map(enumeration_value).collect()
                })
                .unwrap_or_default(),
        },
        _ => return None,
    }))
}

fn enumeration_value(field: &Element) -> Option<(i64, String)> {
    Some((field.attribute("Value")?.parse().ok()?, field.attribute("Name")?.to_owned()))
}

fn node(element: &Element, class: NodeClass, names: &Names) -> Result<Node, NodeSetError> {
    let node_id = element
        .attribute("NodeId")
        .and_then(|id| names.node_id(id))
        .ok_or_else(|| failed(element, "the NodeId is missing or malformed"))?;
    let browse_name = element
        .attribute("BrowseName")
        .and_then(|name| names.browse_name(name))
        .ok_or_else(|| failed(element, "the BrowseName is missing or malformed"))?;
    let mut references = Vec::new();
    for reference in
        element.child("References").map(|list| list.children.as_slice()).unwrap_or_default()
    {
        let reference_type = reference.attribute("ReferenceType").and_then(|id| names.node_id(id));
        let target = names.node_id(reference.trimmed());
        let (Some(reference_type), Some(target)) = (reference_type, target) else {
            return Err(failed(element, "a reference has no type or target that is a NodeId"));
        };
        references.push(Reference {
            reference_type,
            target,
            is_forward: reference.attribute("IsForward") != Some("false"),
        });
    }
    let name = browse_name.name.as_deref().unwrap_or_default();
    Ok(Node {
        display_name: element
            .child("DisplayName")
            .map_or_else(|| name.to_owned(), |name| name.text.clone()),
        description: element.child("Description").map(|text| text.text.clone()),
        node_id,
        browse_name,
        class,
        references,
    })
}
