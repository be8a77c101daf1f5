//! The readable NodeIds of an interface's nodes, stable over restarts: `<net>`, `<net>/op/<op>`,
//! `<net>/op/<op>/eq/<requirement>`, `<net>/op/<op>/req/<req>`, `.../<field>`, `<net>/rel/<rel>`,
//! `<net>/rel/<rel>/cond/<condition>`; parts with a fixed BrowseName follow after `#`. Inside an id
//! `/`, `#` and `%` are percent-encoded, and so are blanks at its ends, so that every id has one
//! NodeId and the other way round.

use std::{borrow::Cow, fmt};

use crate::{
    FactoryId,
    asi_types::instance_namespace_uri,
    ids::{
        ConditionId, DynamicDataRequestId, EquipmentRequirementId, FieldName, OperationId,
        OperationNetworkId, OperationRelationId,
    },
    values::NodeId,
};

/// The identifier of the folder that holds all interfaces; `#` keeps it apart from every network's.
pub const FOLDER_ID: &str = "#CollaborativeProcessTwin";
/// The BrowseName of that folder.
pub const FOLDER_NAME: &str = "CollaborativeProcessTwin";

/// Appends an id with its separators percent-encoded, and the blanks at its ends: foreign tools
/// trim the NodeIds they read.
pub fn encode_segment(out: &mut String, id: &str) {
    let inner = id.trim_matches(is_blank);
    // An id of blanks only is all lead.
    let (lead, trail) = match inner {
        "" => (id, ""),
        inner => {
            let at = id.len() - id.trim_start_matches(is_blank).len();
            (&id[..at], &id[at + inner.len()..])
        }
    };
    encode_bytes(out, lead);
    for character in inner.chars() {
        match character {
            '%' | '/' | '#' => encode_bytes(out, character.encode_utf8(&mut [0; 4])),
            other => out.push(other),
        }
    }
    encode_bytes(out, trail);
}

/// True for white space in the sense of any common language.
fn is_blank(c: char) -> bool {
    c.is_whitespace() || c == '\u{feff}'
}

fn encode_bytes(out: &mut String, text: &str) {
    for byte in text.bytes() {
        out.push_str(&format!("%{byte:02X}"));
    }
}

/// The id behind its encoded form; `None` where [`encode_segment`] did not encode it.
#[must_use]
pub fn decode_segment(text: &str) -> Option<Cow<'_, str>> {
    if !text.contains('%') && text.trim_matches(is_blank).len() == text.len() {
        return Some(Cow::Borrowed(text));
    }
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some((plain, after)) = rest.split_once('%') {
        bytes.extend_from_slice(plain.as_bytes());
        bytes.push(u8::from_str_radix(after.get(..2)?, 16).ok()?);
        rest = &after[2..];
    }
    bytes.extend_from_slice(rest.as_bytes());
    let id = String::from_utf8(bytes).ok()?;
    // Each id has one form: another one that means the same names no node.
    let mut form = String::with_capacity(text.len());
    encode_segment(&mut form, &id);
    (form == text).then_some(Cow::Owned(id))
}

/// The identifier of a node, built from the network down.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Path(String);

impl Path {
    /// The interface itself.
    #[must_use]
    pub fn interface(network: &OperationNetworkId) -> Self {
        let mut path = String::with_capacity(64);
        encode_segment(&mut path, network.as_str());
        Self(path)
    }

    fn below(&self, separator: &str, id: &str) -> Self {
        let mut path = self.0.clone();
        path.push_str(separator);
        encode_segment(&mut path, id);
        Self(path)
    }

    /// An operation of this interface.
    #[must_use]
    pub fn operation(&self, id: &OperationId) -> Self {
        self.below("/op/", id.as_str())
    }

    /// A relation of this interface.
    #[must_use]
    pub fn relation(&self, id: &OperationRelationId) -> Self {
        self.below("/rel/", id.as_str())
    }

    /// A condition of this relation.
    #[must_use]
    pub fn condition(&self, id: &ConditionId) -> Self {
        self.below("/cond/", id.as_str())
    }

    /// An equipment requirement of this operation.
    #[must_use]
    pub fn requirement(&self, id: &EquipmentRequirementId) -> Self {
        self.below("/eq/", id.as_str())
    }

    /// A dynamic data request of this operation.
    #[must_use]
    pub fn request(&self, id: &DynamicDataRequestId) -> Self {
        self.below("/req/", id.as_str())
    }

    /// A report field of this request.
    #[must_use]
    pub fn field(&self, name: &FieldName) -> Self {
        self.below("/", name.as_str())
    }

    /// A part with a fixed BrowseName.
    #[must_use]
    pub fn part(&self, name: &str) -> Self {
        Self(format!("{}#{name}", self.0))
    }

    /// The NodeId at a factory.
    #[must_use]
    pub fn node_id(&self, factory_id: &FactoryId) -> NodeId {
        NodeId::string(&instance_namespace_uri(factory_id), &self.0)
    }

    /// The identifier as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}
