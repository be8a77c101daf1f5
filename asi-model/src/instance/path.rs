//! The readable NodeIds of an interface's nodes, stable over restarts: `<net>`, `<net>/op/<op>`,
//! `<net>/op/<op>/eq/<requirement>`, `<net>/op/<op>/req/<req>`, `.../<field>`, `<net>/rel/<rel>`,
//! `<net>/rel/<rel>/cond/<condition>`; parts with a fixed BrowseName follow after `#`. Inside an id `/`, `#` and `%` are
//! percent-encoded, so that every id has one NodeId and the other way round.

use std::fmt;

use crate::{
    FactoryId,
    asi_types::instance_namespace_uri,
    ids::{
        ConditionId, DynamicDataRequestId, EquipmentRequirementId, FieldName, OperationId, OperationNetworkId,
        OperationRelationId,
    },
    values::NodeId,
};

/// The identifier of the folder that holds all interfaces; `#` keeps it apart from every network's.
pub const FOLDER_ID: &str = "#CollaborativeProcessTwin";
/// The BrowseName of that folder.
pub const FOLDER_NAME: &str = "CollaborativeProcessTwin";

/// Appends an id with its separators percent-encoded.
pub fn encode_segment(out: &mut String, id: &str) {
    for character in id.chars() {
        match character {
            '%' => out.push_str("%25"),
            '/' => out.push_str("%2F"),
            '#' => out.push_str("%23"),
            other => out.push(other),
        }
    }
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
