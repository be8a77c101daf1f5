//! Node ids of a machine on one server: order of the namespaces, and identifiers.

use std::sync::Arc;

use asi_model::values::{Identifier, Namespace, NodeId};

use crate::{Layout, blueprint::Blueprint};

/// Most namespaces that come before a machine's own.
const NAMESPACES_BEFORE_MAX: u16 = 100;
/// The first number of a machine that numbers its nodes.
const FIRST_NUMBER: u32 = 5000;

/// The namespaces besides 0 and the server's own, in their order.
pub(super) fn namespaces(blueprint: &Blueprint, layout: Layout) -> Vec<String> {
    let before = layout.namespaces_before.min(NAMESPACES_BEFORE_MAX);
    let mut own: Vec<String> =
        blueprint.type_namespaces.iter().map(|uri| (*uri).to_owned()).collect();
    own.push(blueprint.namespace_uri.clone());
    if before > 0 {
        own.reverse();
    }
    (1..=before).map(|index| format!("urn:verbund:simulator:other:{index}")).chain(own).collect()
}

/// The id of the node at an index of the blueprint.
pub(super) fn node_id(blueprint: &Blueprint, layout: Layout, index: usize) -> NodeId {
    let node = &blueprint.nodes[index];
    if let Some(fixed) = &node.node_id {
        return fixed.clone();
    }
    let identifier = if blueprint.numbers_nodes {
        let count = blueprint.nodes.len();
        // Every number stays in use, so that an old one finds another node instead of none.
        let place = (index + layout.renumbered as usize * 7) % count;
        Identifier::Numeric(FIRST_NUMBER + u32::try_from(place).expect("machines have few nodes"))
    } else {
        let key = if node.key.is_empty() { "Machine" } else { &node.key };
        let text = if layout.renumbered == 0 {
            key.to_owned()
        } else {
            format!("{}:{key}", layout.renumbered)
        };
        Identifier::String(Arc::from(text))
    };
    NodeId { namespace: Namespace::uri(&blueprint.namespace_uri), identifier }
}
