//! TranslateBrowsePathsToNodeIds service within the providers' nodes, and from standard nodes to them.

use std::ops::ControlFlow;

use opcua_stack::opcua::{
    nodes::TypeTree,
    server::node_manager::{BrowsePathItem, RequestContext, matches_target_name},
    types::{NodeId, QualifiedName, RelativePathElement},
};

use super::ProviderTable;
use crate::provider::ProvidedReference;

/// Most nodes on one path: a path of wildcards over many nodes ends there.
const NODES_PER_PATH_MAX: usize = 100_000;

/// Follows a path within the providers' nodes. Nodes of other managers that it reaches are passed
/// on to them.
pub(super) fn translate(
    table: &ProviderTable,
    item: &mut BrowsePathItem<'_>,
    context: &RequestContext,
    types: &dyn TypeTree,
) {
    if let Some(expected) = item.unmatched_browse_name() {
        let is_match = table
            .node(item.node_id())
            .is_some_and(|n| matches_target_name(&n.browse_name, expected));
        if !is_match {
            return;
        }
        item.set_browse_name_matched(context.current_node_manager_index);
    }
    let mut found: Vec<(NodeId, usize, Option<QualifiedName>)> = Vec::new();
    let mut layer = vec![item.node_id().clone()];
    for (depth, element) in item.path().iter().enumerate() {
        let mut next = Vec::new();
        for node_id in &layer {
            follow(table, node_id, element, types, &mut |reference| {
                if found.len() >= NODES_PER_PATH_MAX {
                    return;
                }
                if table.owner(&reference.target).is_some() {
                    found.push((reference.target.clone(), depth + 1, None));
                    next.push(reference.target);
                } else {
                    // The node's own manager checks the name.
                    found.push((reference.target, depth + 1, Some(element.target_name.clone())));
                }
            });
        }
        layer = next;
    }
    for (node_id, depth, unmatched) in found {
        item.add_element(node_id, depth, unmatched);
    }
}

/// Visits the references of a node that match one element of a path. The name of targets of other
/// managers is not checked.
fn follow(
    table: &ProviderTable,
    node_id: &NodeId,
    element: &RelativePathElement,
    types: &dyn TypeTree,
    visit: &mut dyn FnMut(ProvidedReference),
) {
    let matches_filter = |reference: &ProvidedReference| {
        reference.is_forward != element.is_inverse
            && (element.reference_type_id.is_null()
                || reference.reference_type == element.reference_type_id
                || element.include_subtypes
                    && types.is_subtype_of(&reference.reference_type, &element.reference_type_id))
    };
    for provider in &table.providers {
        if !element.is_inverse
            && !element.target_name.name.as_ref().is_empty()
            && let Some(named) = provider.targets_named(node_id, &element.target_name)
        {
            named.into_iter().filter(|r| matches_filter(r)).for_each(&mut *visit);
            continue;
        }
        provider.references(node_id, 0, &mut |_, reference| {
            if matches_filter(&reference)
                && may_be_named(table, &reference.target, &element.target_name)
            {
                visit(reference);
            }
            ControlFlow::Continue(())
        });
    }
}

fn may_be_named(table: &ProviderTable, node_id: &NodeId, name: &QualifiedName) -> bool {
    match table.owner(node_id) {
        Some(owner) => {
            owner.node(node_id).is_some_and(|node| matches_target_name(&node.browse_name, name))
        }
        None => true,
    }
}
