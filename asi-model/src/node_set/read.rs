//! Reading NodeSet2.

use std::collections::HashSet;

use super::{
    Model, Node, NodeClass, NodeSet, NodeSetError, Reference,
    names::Names,
    value,
    xml::{self, Element},
};
use crate::values::Variant;

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
