//! The OPC UA type model of the Activity Status Interface as plain facts.

/// The namespace of the ASI types.
pub const ASI_NAMESPACE_URI: &str = "urn:verbund:UA:ASI";

/// The namespace of a factory's ASI instances.
#[must_use]
pub fn instance_namespace_uri(factory_id: &crate::FactoryId) -> String {
    format!("urn:verbund:cpt:{factory_id}")
}
