//! Reading NodeIds and qualified names, whose namespaces may be indexes.

use std::sync::Arc;

use super::{
    decode_scalar::{bytes, guid, integer, text},
    mismatch::Mismatch,
};
use crate::{
    json::{JsonNode, Kind},
    values::{ExpandedNodeId, Identifier, Namespace, NodeId, QualifiedName, Server},
};

/// The URIs behind namespace indexes; the first is index 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NamespaceTable<'d>(pub(super) &'d [Arc<str>]);

impl NamespaceTable<'_> {
    pub(crate) fn node_id<'t, 'a>(
        &self,
        node: JsonNode<'t, 'a>,
    ) -> Result<NodeId, Mismatch<'t, 'a>> {
        match node.kind() {
            Kind::String => {
                let id: NodeId = text(node)?.parse().map_err(|_| {
                    Mismatch::new(node, "expected a NodeId as nsu=urn:press;s=Counter")
                })?;
                Ok(NodeId { namespace: self.resolve(id.namespace), ..id })
            }
            Kind::Object => self.node_id_object(node),
            _ => Err(Mismatch::new(node, "expected a NodeId: a string or an object with Id")),
        }
    }

    fn node_id_object<'t, 'a>(&self, node: JsonNode<'t, 'a>) -> Result<NodeId, Mismatch<'t, 'a>> {
        let id_type = match node.get("IdType") {
            None => 0,
            Some(kind) => kind.integer::<u8>().filter(|kind| *kind <= 3).ok_or_else(|| {
                Mismatch::new(
                    kind,
                    "IdType must be 0 (numeric), 1 (string), 2 (Guid) or 3 (opaque)",
                )
            })?,
        };
        let identifier = match (id_type, node.get("Id")) {
            (0, None) => Identifier::Numeric(0),
            (_, None) => return Err(Mismatch::new(node, "Id is missing")),
            (0, Some(id)) => Identifier::Numeric(integer(id, "a numeric Id from 0 to 4294967295")?),
            (1, Some(id)) => Identifier::String(text(id)?.into()),
            (2, Some(id)) => Identifier::Guid(guid(id)?),
            (_, Some(id)) => Identifier::Opaque(bytes(id)?),
        };
        Ok(NodeId { namespace: self.namespace(node.get("Namespace"))?, identifier })
    }

    /// A namespace as index or URI; absent it is namespace 0.
    fn namespace<'t, 'a>(
        &self,
        node: Option<JsonNode<'t, 'a>>,
    ) -> Result<Namespace, Mismatch<'t, 'a>> {
        let Some(node) = node else { return Ok(Namespace::Ua) };
        match node.kind() {
            Kind::Null => Ok(Namespace::Ua),
            Kind::String => Ok(Namespace::uri(&text(node)?)),
            _ => match integer::<u16>(node, "a namespace as index or URI")? {
                0 => Ok(Namespace::Ua),
                index => Ok(self.resolve(Namespace::Index(index))),
            },
        }
    }

    /// The URI behind an index, where the table is known.
    fn resolve(&self, namespace: Namespace) -> Namespace {
        match namespace {
            Namespace::Index(index) => match self.0.get(usize::from(index).wrapping_sub(1)) {
                Some(uri) => Namespace::uri(uri),
                None => Namespace::Index(index),
            },
            other => other,
        }
    }

    pub(super) fn expanded_node_id<'t, 'a>(
        &self,
        node: JsonNode<'t, 'a>,
    ) -> Result<ExpandedNodeId, Mismatch<'t, 'a>> {
        match node.kind() {
            Kind::String => {
                let id: ExpandedNodeId = text(node)?.parse().map_err(|_| {
                    Mismatch::new(node, "expected a NodeId as nsu=urn:press;s=Counter")
                })?;
                let namespace = self.resolve(id.node_id.namespace);
                Ok(ExpandedNodeId { node_id: NodeId { namespace, ..id.node_id }, ..id })
            }
            Kind::Object => {
                let server = match node.get("ServerUri") {
                    None => Server::Local,
                    Some(server) if server.kind() == Kind::String => {
                        Server::Uri(text(server)?.into())
                    }
                    Some(server) => match integer(server, "a server as index or URI")? {
                        0 => Server::Local,
                        index => Server::Index(index),
                    },
                };
                Ok(ExpandedNodeId { node_id: self.node_id_object(node)?, server })
            }
            _ => Err(Mismatch::new(node, "expected a NodeId: a string or an object with Id")),
        }
    }

    pub(crate) fn qualified_name<'t, 'a>(
        &self,
        node: JsonNode<'t, 'a>,
    ) -> Result<QualifiedName, Mismatch<'t, 'a>> {
        match node.kind() {
            Kind::Null => Ok(QualifiedName::default()),
            Kind::String => {
                let name: QualifiedName = text(node)?.parse().map_err(|_| {
                    Mismatch::new(node, "expected a qualified name as nsu=urn:press;Counter")
                })?;
                Ok(QualifiedName { namespace: self.resolve(name.namespace), ..name })
            }
            Kind::Object => {
                let name = node
                    .get("Name")
                    .filter(|name| !name.is_null())
                    .map(text)
                    .transpose()?
                    .map(Arc::from);
                Ok(QualifiedName { namespace: self.namespace(node.get("Uri"))?, name })
            }
            _ => Err(Mismatch::new(
                node,
                "expected a qualified name: a string or an object with Name",
            )),
        }
    }
}
