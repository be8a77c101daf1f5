//! Texts with a form of their own: what is read and written reads alike.

use asi_model::{
    DateTime, NodeId,
    network::{IsoDuration, Semantic},
    units,
    values::{ExpandedNodeId, QualifiedName},
};

fn check<T: std::str::FromStr + std::fmt::Display + PartialEq + std::fmt::Debug>(text: &str) {
    if let Ok(value) = text.parse::<T>() {
        assert_eq!(value.to_string().parse::<T>().ok(), Some(value), "{text}");
    }
}

/// Plays one input.
pub fn texts(text: &str) {
    check::<DateTime>(text);
    check::<NodeId>(text);
    check::<ExpandedNodeId>(text);
    check::<QualifiedName>(text);
    check::<IsoDuration>(text);
    let _ = text.parse::<Semantic>();
    let _ = units::lookup(text);
}
