//! Going through an address space, level by level from the Objects folder.

use std::collections::{HashSet, VecDeque};

use opcua_stack::{
    opcua::types::{NodeId, ObjectId, ReferenceDescription},
    values::qualified_name_from_stack,
};

use super::{CHILDREN_MAX, Connection, downward, references};
use crate::{BrowsePath, ShopFloorError};

/// How deep a walk goes.
const DEPTH_MAX: usize = 20;

/// Where to go from a node.
pub(super) enum Onward<T> {
    /// Below it too, with this note for its children.
    Below(T),
    /// Not below it.
    Past,
    /// Nowhere: what was looked for is found.
    Home,
}

/// Shows every node below the Objects folder once, with its path and the note left at its parent.
/// True where all were shown; false where `visited_max` nodes, the depth or the visitor ended it.
pub(super) async fn walk<T>(
    connection: &Connection,
    note: T,
    visited_max: usize,
    mut visit: impl FnMut(&ReferenceDescription, &BrowsePath, &T) -> Onward<T> + Send,
) -> Result<bool, ShopFloorError> {
    let namespaces = connection.namespaces();
    let root = NodeId::from(ObjectId::ObjectsFolder);
    let mut visited = HashSet::from([root.clone()]);
    let mut level = VecDeque::from([(root, BrowsePath::default(), note)]);
    for _ in 0..DEPTH_MAX {
        if level.is_empty() {
            return Ok(true);
        }
        let asked: Vec<_> = level.iter().map(|(node, ..)| downward(node.clone())).collect();
        let answers = references(connection, asked, CHILDREN_MAX).await?;
        let mut next = VecDeque::new();
        for ((_, path, note), children) in level.drain(..).zip(answers) {
            for child in children {
                if child.node_id.server_index != 0 || !visited.insert(child.node_id.node_id.clone())
                {
                    continue;
                }
                let mut path = path.clone();
                path.0.push(qualified_name_from_stack(&child.browse_name, &namespaces));
                match visit(&child, &path, &note) {
                    Onward::Below(note) => next.push_back((child.node_id.node_id, path, note)),
                    Onward::Past => {}
                    Onward::Home => return Ok(false),
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
