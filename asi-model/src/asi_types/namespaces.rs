//! Namespaces of the types and of their instances.

use crate::{
    ids::FactoryId,
    values::{Namespace, NodeId, QualifiedName},
};

/// The namespace of the ASI types.
pub const ASI_NAMESPACE_URI: &str = "urn:verbund:UA:ASI";

/// The version of the type model.
pub const ASI_MODEL_VERSION: &str = "1.0.0";

/// Publication time of this version, RFC 3339.
pub const ASI_PUBLICATION_DATE: &str = "2026-11-20T00:00:00Z";

/// The namespace of a factory's ASI instances.
#[must_use]
pub fn instance_namespace_uri(factory_id: &FactoryId) -> String {
    format!("{INSTANCE_NAMESPACE_PREFIX}{factory_id}")
}

/// Prefix of every instance namespace; the factory id follows.
pub const INSTANCE_NAMESPACE_PREFIX: &str = "urn:verbund:cpt:";

/// A NodeId of the type namespace.
#[must_use]
pub fn asi(id: u32) -> NodeId {
    NodeId::numeric(ASI_NAMESPACE_URI, id)
}

/// A BrowseName of namespace 0 or of the type namespace.
#[must_use]
pub fn browse_name(name: &str, is_standard: bool) -> QualifiedName {
    let namespace = if is_standard { Namespace::Ua } else { Namespace::uri(ASI_NAMESPACE_URI) };
    QualifiedName { namespace, name: Some(name.into()) }
}
