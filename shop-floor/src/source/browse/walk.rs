//! Breadth-first walk through an address space, from the Objects folder down.

use std::collections::{HashSet, VecDeque};

use opcua_stack::{
    opcua::types::{NodeId, ObjectId, ReferenceDescription},
    values::qualified_name_from_stack,
};

use crate::{
    BrowsePath, ShopFloorError,
    source::{
        connection::Connection,
        services::{children_of, references},
    },
};

/// Most levels below the Objects folder.
const DEPTH_MAX: usize = 20;
/// Most children of a node that are visited.
const CHILDREN_MAX: usize = 100_000;

/// Decision of a visitor about the nodes below the visited one.
pub(super) enum WalkStep<T> {
    /// Visits the children too, with this context.
    Descend(T),
    Skip,
    Stop,
}

/// Visits every node below the Objects folder once, with its path and the context of its parent.
/// Returns true when all were visited, false when `visited_max`, the depth or the visitor ended the
/// walk.
pub(super) async fn walk<T>(
    connection: &Connection,
    context: T,
    visited_max: usize,
    mut visit: impl FnMut(&ReferenceDescription, &BrowsePath, &T) -> WalkStep<T> + Send,
) -> Result<bool, ShopFloorError> {
    let namespaces = connection.namespaces();
    let root = NodeId::from(ObjectId::ObjectsFolder);
    let mut visited = HashSet::from([root.clone()]);
    let mut level = VecDeque::from([(root, BrowsePath::default(), context)]);
    for _ in 0..DEPTH_MAX {
        if level.is_empty() {
            return Ok(true);
        }
        let descriptions = level.iter().map(|(node, ..)| children_of(node.clone())).collect();
        let answers = references(connection, descriptions, CHILDREN_MAX).await?;
        let mut next = VecDeque::new();
        for ((_, path, context), children) in level.drain(..).zip(answers) {
            for child in children {
                if child.node_id.server_index != 0 || !visited.insert(child.node_id.node_id.clone())
                {
                    continue;
                }
                let mut path = path.clone();
                path.0.push(qualified_name_from_stack(&child.browse_name, &namespaces));
                match visit(&child, &path, &context) {
                    WalkStep::Descend(context) => {
                        next.push_back((child.node_id.node_id, path, context));
                    }
                    WalkStep::Skip => {}
                    WalkStep::Stop => return Ok(false),
                }
            }
        }
        level = next;
        if visited.len() >= visited_max {
            return Ok(level.is_empty());
        }
    }
    Ok(level.is_empty())
}
