//! Numbers of namespaces in a document that is written.

use super::{NodeClass, NodeSet};
use crate::values::{ExtensionBody, Namespace, NodeId, QualifiedName, Scalar, Variant};

/// The URIs behind the indexes from 1 on.
pub(super) struct Namespaces(Vec<String>);

impl Namespaces {
    pub(super) fn uris(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(String::as_str)
    }

    pub(super) fn of(node_set: &NodeSet) -> Self {
        let mut namespaces = Self(node_set.models.iter().map(|model| model.uri.clone()).collect());
        for node in &node_set.nodes {
            namespaces.note(&node.node_id.namespace);
            namespaces.note(&node.browse_name.namespace);
            for reference in &node.references {
                namespaces.note(&reference.reference_type.namespace);
                namespaces.note(&reference.target.namespace);
            }
            match &node.class {
                NodeClass::Variable { data_type, value, .. } => {
                    namespaces.note(&data_type.namespace);
                    for_each_namespace(value, &mut |namespace| namespaces.note(namespace));
                }
                NodeClass::VariableType { data_type, .. } => namespaces.note(&data_type.namespace),
                _ => {}
            }
        }
        namespaces
    }

    fn note(&mut self, namespace: &Namespace) {
        if let Namespace::Uri(uri) = namespace
            && !self.0.iter().any(|known| **known == **uri)
        {
            self.0.push(uri.to_string());
        }
    }

    pub(super) fn index(&self, namespace: &Namespace) -> usize {
        match namespace {
            Namespace::Ua => 0,
            Namespace::Index(index) => usize::from(*index),
            Namespace::Uri(uri) => {
                self.0.iter().position(|known| **known == **uri).map_or(0, |at| at + 1)
            }
        }
    }

    pub(super) fn node_id(&self, id: &NodeId) -> String {
        match self.index(&id.namespace) {
            0 => id.identifier.to_string(),
            index => format!("ns={index};{}", id.identifier),
        }
    }

    pub(super) fn browse_name(&self, name: &QualifiedName) -> String {
        let text = name.name.as_deref().unwrap_or_default();
        match self.index(&name.namespace) {
            0 => text.to_owned(),
            index => format!("{index}:{text}"),
        }
    }
}

/// Calls `visit` for each namespace inside a value.
fn for_each_namespace(value: &Variant, visit: &mut dyn FnMut(&Namespace)) {
    for scalar in scalars(value) {
        match scalar {
            Scalar::NodeId(id) => visit(&id.namespace),
            Scalar::ExpandedNodeId(id) => visit(&id.node_id.namespace),
            Scalar::QualifiedName(name) => visit(&name.namespace),
            Scalar::ExtensionObject(object) => {
                if let ExtensionBody::Structure(structure) = &object.body {
                    structure.fields.values().for_each(|field| for_each_namespace(field, visit));
                }
            }
            _ => {}
        }
    }
}

pub(super) fn scalars(value: &Variant) -> &[Scalar] {
    match value {
        Variant::Null => &[],
        Variant::Scalar(scalar) => std::slice::from_ref(scalar),
        Variant::Array(array) => array.elements.as_slice(),
    }
}
