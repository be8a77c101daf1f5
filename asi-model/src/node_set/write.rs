//! Writing NodeSet2.

use std::fmt::Write as _;

use super::{Model, Node, NodeClass, NodeSet, namespaces::Namespaces, value, xml::escape};

/// The text of a node set. Namespaces are numbered in order of models, then of first mention.
#[must_use]
pub fn write(node_set: &NodeSet) -> String {
    let namespaces = Namespaces::of(node_set);
    let mut out = String::with_capacity(512 + 400 * node_set.nodes.len());
    out.push_str("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n");
    out.push_str(concat!(
        "<UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\"",
        " xmlns:uax=\"http://opcfoundation.org/UA/2008/02/Types.xsd\">\n"
    ));
    out.push_str("  <NamespaceUris>\n");
    for uri in namespaces.uris() {
        line(&mut out, 2, format_args!("<Uri>{}</Uri>", escape(uri)));
    }
    out.push_str("  </NamespaceUris>\n  <Models>\n");
    for model in &node_set.models {
        write_model(&mut out, model, "Model", 2);
    }
    out.push_str("  </Models>\n");
    for node in &node_set.nodes {
        write_node(&mut out, node, &namespaces);
    }
    out.push_str("</UANodeSet>\n");
    out
}

fn line(out: &mut String, depth: usize, content: std::fmt::Arguments<'_>) {
    writeln!(out, "{:width$}{content}", "", width = depth * 2).expect("a String takes every write");
}

fn write_model(out: &mut String, model: &Model, element: &str, depth: usize) {
    let mut attributes = format!("ModelUri=\"{}\"", escape(&model.uri));
    if let Some(version) = &model.version {
        attributes.push_str(&format!(" Version=\"{}\"", escape(version)));
    }
    if let Some(date) = model.publication_date {
        attributes.push_str(&format!(" PublicationDate=\"{date}\""));
    }
    if model.required.is_empty() {
        return line(out, depth, format_args!("<{element} {attributes}/>"));
    }
    line(out, depth, format_args!("<{element} {attributes}>"));
    for required in &model.required {
        write_model(out, required, "RequiredModel", depth + 1);
    }
    line(out, depth, format_args!("</{element}>"));
}

fn write_node(out: &mut String, node: &Node, namespaces: &Namespaces) {
    let mut attributes = format!(
        "NodeId=\"{}\" BrowseName=\"{}\"",
        escape(&namespaces.node_id(&node.node_id)),
        escape(&namespaces.browse_name(&node.browse_name))
    );
    let mut flag = |is_set: bool, name: &str| {
        if is_set {
            attributes.push_str(&format!(" {name}=\"true\""));
        }
    };
    let element = match &node.class {
        NodeClass::Object => "UAObject",
        NodeClass::Method => "UAMethod",
        NodeClass::Variable { .. } => "UAVariable",
        NodeClass::ObjectType { is_abstract } => {
            flag(*is_abstract, "IsAbstract");
            "UAObjectType"
        }
        NodeClass::VariableType { is_abstract, .. } => {
            flag(*is_abstract, "IsAbstract");
            "UAVariableType"
        }
        NodeClass::ReferenceType { is_abstract, is_symmetric, .. } => {
            flag(*is_abstract, "IsAbstract");
            flag(*is_symmetric, "Symmetric");
            "UAReferenceType"
        }
        NodeClass::DataType { is_abstract, .. } => {
            flag(*is_abstract, "IsAbstract");
            "UADataType"
        }
    };
    if let NodeClass::Variable { data_type, value_rank, .. }
    | NodeClass::VariableType { data_type, value_rank, .. } = &node.class
    {
        attributes.push_str(&format!(" DataType=\"{}\"", escape(&namespaces.node_id(data_type))));
        if *value_rank != -1 {
            attributes.push_str(&format!(" ValueRank=\"{value_rank}\""));
        }
    }
    if let NodeClass::Variable { is_writable: true, .. } = &node.class {
        // CurrentRead and CurrentWrite.
        attributes.push_str(" AccessLevel=\"3\"");
    }
    line(out, 1, format_args!("<{element} {attributes}>"));
    write_children(out, node, namespaces);
    line(out, 1, format_args!("</{element}>"));
}

fn write_children(out: &mut String, node: &Node, namespaces: &Namespaces) {
    line(out, 2, format_args!("<DisplayName>{}</DisplayName>", escape(&node.display_name)));
    if let Some(description) = &node.description {
        line(out, 2, format_args!("<Description>{}</Description>", escape(description)));
    }
    if !node.references.is_empty() {
        line(out, 2, format_args!("<References>"));
        for reference in &node.references {
            let direction = if reference.is_forward { "" } else { " IsForward=\"false\"" };
            line(
                out,
                3,
                format_args!(
                    "<Reference ReferenceType=\"{}\"{direction}>{}</Reference>",
                    escape(&namespaces.node_id(&reference.reference_type)),
                    escape(&namespaces.node_id(&reference.target))
                ),
            );
        }
        line(out, 2, format_args!("</References>"));
    }
    match &node.class {
        NodeClass::ReferenceType { inverse_name: Some(name), .. } => {
            line(out, 2, format_args!("<InverseName>{}</InverseName>", escape(name)));
        }
        NodeClass::DataType { enumeration, .. } if !enumeration.is_empty() => {
            let name = escape(&namespaces.browse_name(&node.browse_name)).into_owned();
            line(out, 2, format_args!("<Definition Name=\"{name}\">"));
            for (value, name) in enumeration {
                line(out, 3, format_args!("<Field Name=\"{}\" Value=\"{value}\"/>", escape(name)));
            }
            line(out, 2, format_args!("</Definition>"));
        }
        NodeClass::Variable { value, .. } if value::is_writable(value) => {
            let mut text = String::new();
            value::write(&mut text, value, namespaces);
            line(out, 2, format_args!("<Value>{text}</Value>"));
        }
        _ => {}
    }
}
