//! Namespaces and aliases of a document that is read.

use std::collections::HashMap;

use super::xml::Element;
use crate::values::{Namespace, NodeId, QualifiedName};

/// The document's namespaces and aliases.
pub(super) struct Names {
    namespaces: Vec<Namespace>,
    aliases: HashMap<String, String>,
}

impl Names {
    pub(super) fn of(root: &Element) -> Self {
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

    pub(super) fn browse_name(&self, text: &str) -> Option<QualifiedName> {
        let name: QualifiedName = text.parse().ok()?;
        Some(QualifiedName { namespace: self.namespace(name.namespace)?, ..name })
    }
}
