//! NodeIds and qualified names (OPC 10000-6 §5.2.2.9 to §5.2.2.13, text form §5.1.12).

use std::{fmt, str::FromStr, sync::Arc};

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use uuid::Uuid;

/// The namespace of a NodeId or qualified name.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub enum Namespace {
    /// `http://opcfoundation.org/UA/`, index 0.
    #[default]
    Ua,
    /// Any other namespace by its URI: what we persist and emit.
    Uri(Arc<str>),
    /// An index whose table is unknown: only from foreign messages, never persisted.
    Index(u16),
}

/// The URI of namespace 0.
pub const UA_NAMESPACE_URI: &str = "http://opcfoundation.org/UA/";

impl Namespace {
    /// Makes one of a URI; namespace 0's own URI yields [`Namespace::Ua`].
    #[must_use]
    pub fn uri(uri: &str) -> Self {
        if uri == UA_NAMESPACE_URI { Self::Ua } else { Self::Uri(Arc::from(uri)) }
    }
}

/// The identifier within a namespace.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Identifier {
    /// A number, as `i=85`.
    Numeric(u32),
    /// A text, as `s=Counter`.
    String(Arc<str>),
    /// A UUID, as `g=72962b91-fa75-4ae6-8d28-b404dc7daf63`.
    Guid(Uuid),
    /// `b=` (Base64 in text)
    Opaque(Arc<[u8]>),
}

/// A node's identity. Text form `nsu=<uri>;s=<id>`; namespace 0 bare (`i=884`).
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, JsonSchema)]
#[schemars(with = "String")]
pub struct NodeId {
    /// Namespace of the server or standard that named the node.
    pub namespace: Namespace,
    /// Its identifier there.
    pub identifier: Identifier,
}

/// A NodeId that may live on another server.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ExpandedNodeId {
    pub node_id: NodeId,
    /// The other server, if any.
    pub server: Server,
}

/// Server of a node.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub enum Server {
    /// The server that sent the NodeId.
    #[default]
    Local,
    /// By the URI of the server.
    Uri(Arc<str>),
    /// By an index into a table we do not have.
    Index(u32),
}

/// A name within a namespace, as BrowseNames are.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct QualifiedName {
    /// Namespace in which the name is defined.
    pub namespace: Namespace,
    /// The name; `None` is the null string.
    pub name: Option<Arc<str>>,
}

/// A text is not a NodeId.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a NodeId must look like i=2258, ns=2;i=7 or nsu=urn:press;s=Counter, but is {found:?}")]
pub struct InvalidNodeId {
    /// The text, cut after 120 characters.
    pub found: String,
}

/// Longest NodeId text accepted, in bytes (OPC 10000-3 bounds string identifiers at 4096).
pub const NODE_ID_BYTES_MAX: usize = 8192;

impl NodeId {
    /// A numeric NodeId of namespace 0.
    #[must_use]
    pub const fn ua(identifier: u32) -> Self {
        Self { namespace: Namespace::Ua, identifier: Identifier::Numeric(identifier) }
    }

    /// A string NodeId in the namespace of a URI.
    #[must_use]
    pub fn string(namespace_uri: &str, identifier: &str) -> Self {
        Self {
            namespace: Namespace::uri(namespace_uri),
            identifier: Identifier::String(Arc::from(identifier)),
        }
    }

    /// A numeric NodeId in the namespace of a URI.
    #[must_use]
    pub fn numeric(namespace_uri: &str, identifier: u32) -> Self {
        Self {
            namespace: Namespace::uri(namespace_uri),
            identifier: Identifier::Numeric(identifier),
        }
    }

    /// The null NodeId `i=0`.
    #[must_use]
    pub const fn null() -> Self {
        Self::ua(0)
    }
}

impl fmt::Display for Identifier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Numeric(id) => write!(f, "i={id}"),
            Self::String(id) => write!(f, "s={id}"),
            Self::Guid(id) => write!(f, "g={}", id.hyphenated()),
            Self::Opaque(id) => {
                use base64::Engine as _;
                write!(f, "b={}", base64::engine::general_purpose::STANDARD.encode(id))
            }
        }
    }
}

/// Writes a URI that a `;` will end (OPC 10000-6 §5.1.12): `;` and `%` inside it are
/// percent-encoded.
fn write_uri(f: &mut fmt::Formatter<'_>, uri: &str) -> fmt::Result {
    for part in uri.split_inclusive([';', '%']) {
        let (text, special) = match part.as_bytes().last() {
            Some(b';') => (&part[..part.len() - 1], "%3B"),
            Some(b'%') => (&part[..part.len() - 1], "%25"),
            _ => (part, ""),
        };
        write!(f, "{text}{special}")?;
    }
    f.write_str(";")
}

impl fmt::Display for NodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.namespace {
            Namespace::Ua => {}
            Namespace::Uri(uri) => {
                f.write_str("nsu=")?;
                write_uri(f, uri)?;
            }
            Namespace::Index(index) => write!(f, "ns={index};")?,
        }
        self.identifier.fmt(f)
    }
}

impl fmt::Display for ExpandedNodeId {
    /// The text form of 1.05: `svu=<uri>;` or `svr=<index>;` before the NodeId's.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.server {
            Server::Local => {}
            Server::Uri(uri) => {
                f.write_str("svu=")?;
                write_uri(f, uri)?;
            }
            Server::Index(index) => write!(f, "svr={index};")?,
        }
        self.node_id.fmt(f)
    }
}

impl FromStr for ExpandedNodeId {
    type Err = InvalidNodeId;
    fn from_str(text: &str) -> Result<Self, InvalidNodeId> {
        let invalid = || InvalidNodeId { found: text.chars().take(120).collect() };
        let (server, rest) = if let Some(rest) = text.strip_prefix("svu=") {
            let (uri, rest) = rest.split_once(';').ok_or_else(invalid)?;
            (Server::Uri(decode_uri(uri).ok_or_else(invalid)?.into()), rest)
        } else if let Some(rest) = text.strip_prefix("svr=") {
            let (index, rest) = rest.split_once(';').ok_or_else(invalid)?;
            let index = index.parse().map_err(|_| invalid())?;
            (if index == 0 { Server::Local } else { Server::Index(index) }, rest)
        } else {
            (Server::Local, text)
        };
        Ok(Self { node_id: rest.parse()?, server })
    }
}

impl From<NodeId> for ExpandedNodeId {
    fn from(node_id: NodeId) -> Self {
        Self { node_id, server: Server::Local }
    }
}

impl fmt::Display for QualifiedName {
    /// The text form of 1.05: `nsu=<uri>;name`, `1:name`, or the bare name in namespace 0 (with
    /// `0:` where the name itself would be taken for one of the others). A null name is empty.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.name.as_deref().unwrap_or_default();
        match &self.namespace {
            Namespace::Ua => {
                let is_ambiguous = name.starts_with("nsu=")
                    || name.split_once(':').is_some_and(|(index, _)| index.parse::<u16>().is_ok());
                if is_ambiguous {
                    f.write_str("0:")?;
                }
            }
            Namespace::Uri(uri) => {
                f.write_str("nsu=")?;
                write_uri(f, uri)?;
            }
            Namespace::Index(index) => write!(f, "{index}:")?,
        }
        f.write_str(name)
    }
}

impl FromStr for QualifiedName {
    type Err = InvalidNodeId;
    fn from_str(text: &str) -> Result<Self, InvalidNodeId> {
        let invalid = || InvalidNodeId { found: text.chars().take(120).collect() };
        let (namespace, name) = if let Some(rest) = text.strip_prefix("nsu=") {
            let (uri, name) = rest.split_once(';').ok_or_else(invalid)?;
            (Namespace::uri(&decode_uri(uri).ok_or_else(invalid)?), name)
        } else {
            match text.split_once(':').and_then(|(index, name)| Some((index.parse().ok()?, name))) {
                Some((0, name)) => (Namespace::Ua, name),
                Some((index, name)) => (Namespace::Index(index), name),
                None => (Namespace::Ua, text),
            }
        };
        Ok(Self { namespace, name: Some(Arc::from(name)) })
    }
}

fn decode_uri(text: &str) -> Option<String> {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('%') {
        out.push_str(&rest[..at]);
        match rest.get(at..at + 3)? {
            "%3B" | "%3b" => out.push(';'),
            "%25" => out.push('%'),
            _ => return None,
        }
        rest = &rest[at + 3..];
    }
    out.push_str(rest);
    Some(out)
}

fn parse_identifier(text: &str) -> Option<Identifier> {
    use base64::Engine as _;
    let (kind, id) = text.split_at_checked(2)?;
    Some(match kind {
        "i=" => Identifier::Numeric(id.parse().ok()?),
        "s=" => Identifier::String(Arc::from(id)),
        "g=" => Identifier::Guid(id.parse().ok()?),
        "b=" => {
            Identifier::Opaque(base64::engine::general_purpose::STANDARD.decode(id).ok()?.into())
        }
        _ => return None,
    })
}

fn parse_node_id(text: &str) -> Option<NodeId> {
    if text.len() > NODE_ID_BYTES_MAX {
        return None;
    }
    let (namespace, rest) = if let Some(rest) = text.strip_prefix("nsu=") {
        let (uri, rest) = rest.split_once(';')?;
        (Namespace::uri(&decode_uri(uri)?), rest)
    } else if let Some(rest) = text.strip_prefix("ns=") {
        let (index, rest) = rest.split_once(';')?;
        let index = index.parse().ok()?;
        (if index == 0 { Namespace::Ua } else { Namespace::Index(index) }, rest)
    } else {
        (Namespace::Ua, text)
    };
    Some(NodeId { namespace, identifier: parse_identifier(rest)? })
}

impl FromStr for NodeId {
    type Err = InvalidNodeId;
    fn from_str(text: &str) -> Result<Self, InvalidNodeId> {
        parse_node_id(text).ok_or_else(|| InvalidNodeId { found: text.chars().take(120).collect() })
    }
}

impl Serialize for NodeId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for NodeId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        std::borrow::Cow::<'de, str>::deserialize(deserializer)?
            .parse()
            .map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_form_round_trips() {
        for text in [
            "i=884",
            "nsu=urn:press;s=Cell.Counter",
            "nsu=urn:a%3Bb%25c;i=7",
            "ns=3;s=x;y=z",
            "b=AQID",
        ] {
            assert_eq!(text.parse::<NodeId>().map(|id| id.to_string()), Ok(text.to_owned()));
        }
        for text in ["", "i=", "i=-1", "nsu=urn:x", "q=1", "nsu=urn:%41;i=1"] {
            assert!(text.parse::<NodeId>().is_err(), "{text:?}");
        }
    }
}
