//! Browse service: references of providers, filtered and in pages.

use std::ops::ControlFlow;

use opcua_stack::opcua::{
    nodes::{ReferenceDirection, TypeTree},
    server::node_manager::{BrowseNode, ExternalReference, NodeMetadata},
    types::{ExpandedNodeId, NodeId, ReferenceDescription, StatusCode},
};

use super::ProviderTable;
use crate::provider::{ProvidedNode, ProvidedReference};

/// Continuation of BrowseNext: a provider and the position within its references. A few bytes for
/// any number of remaining references.
struct Position {
    provider: usize,
    after: u64,
}

/// Adds the references of one node from all providers.
pub(super) fn browse(table: &ProviderTable, node: &mut BrowseNode, types: &dyn TypeTree) {
    if table.owner(node.node_id()).is_some() {
        let exists = table.node(node.node_id()).is_some();
        node.set_status(if exists { StatusCode::Good } else { StatusCode::BadNodeIdUnknown });
        if !exists {
            return;
        }
    }
    let (mut provider, mut after) = match node.take_continuation_point::<Position>() {
        Some(position) => (position.provider, position.after),
        None => (0, 0),
    };
    while let Some(source) = table.providers.get(provider) {
        let node_id = node.node_id().clone();
        let mut next = None;
        source.references(&node_id, after, &mut |position, reference| {
            if !matches_filter(node, &reference, types) {
                after = position;
                return ControlFlow::Continue(());
            }
            if node.remaining() == 0 {
                next = Some(Position { provider, after });
                return ControlFlow::Break(());
            }
            after = position;
            add(table, node, reference);
            ControlFlow::Continue(())
        });
        if let Some(next) = next {
            node.set_next_continuation_point(Box::new(next));
            return;
        }
        provider += 1;
        after = 0;
    }
}

fn add(table: &ProviderTable, browsed: &mut BrowseNode, reference: ProvidedReference) {
    let Some(owner) = table.owner(&reference.target) else {
        let direction = if reference.is_forward {
            ReferenceDirection::Forward
        } else {
            ReferenceDirection::Inverse
        };
        browsed.push_external_reference(ExternalReference::new(
            reference.target.into(),
            reference.reference_type,
            direction,
        ));
        return;
    };
    let Some(target) = owner.node(&reference.target) else { return };
    if browsed.allows_node_class(target.class.node_class()) {
        browsed.add_unchecked(describe(reference, target));
    }
}

/// Checks direction and reference type; the class of the target is checked once it is known.
fn matches_filter(node: &BrowseNode, reference: &ProvidedReference, types: &dyn TypeTree) -> bool {
    let direction =
        if reference.is_forward { node.allows_forward() } else { node.allows_inverse() };
    direction && node.allows_reference_type(&reference.reference_type, types)
}

fn describe(reference: ProvidedReference, target: ProvidedNode) -> ReferenceDescription {
    metadata(reference.target, target).into_ref_desc(reference.is_forward, reference.reference_type)
}

/// Returns the description of a node for other node managers.
pub(super) fn metadata(node_id: NodeId, node: ProvidedNode) -> NodeMetadata {
    NodeMetadata {
        node_id: ExpandedNodeId::new(node_id),
        type_definition: node
            .type_definition
            .map_or_else(ExpandedNodeId::null, ExpandedNodeId::new),
        browse_name: node.browse_name,
        display_name: node.display_name,
        node_class: node.class.node_class(),
    }
}
