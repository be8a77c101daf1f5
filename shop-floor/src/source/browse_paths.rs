//! Browse paths of nodes, and nodes that are no longer at theirs.

use std::{collections::HashMap, sync::Arc};

use asi_model::values::{NodeId as ModelNodeId, QualifiedName};
use opcua_stack::{
    opcua::types::{
        BrowseDescription, BrowseDirection, BrowseResultMaskFlags, NodeId, ObjectId,
        ReferenceDescription,
    },
    values::{node_id_to_stack, qualified_name_from_stack},
};
use shop_floor_model::PATH_ELEMENTS_MAX;

use super::{
    connection::Connection,
    services::{children_of, read_browse_names, references, translate},
};
use crate::{BrowsePath, MonitorRequest, ShopFloorError};

/// Returns the browse path from the Objects folder to a node.
pub(crate) async fn browse_path(
    connection: &Connection,
    node: &ModelNodeId,
) -> Result<BrowsePath, ShopFloorError> {
    let id = node_id_to_stack(node, &connection.namespaces())
        .map_err(|error| ShopFloorError::Invalid(error.to_string()))?;
    let found = look_up_paths(connection, &[id]).await?.pop().flatten();
    found.ok_or_else(|| {
        ShopFloorError::Invalid(format!("{node} does not hang below the Objects folder"))
    })
}

/// Looks up the path from the Objects folder to each node, upwards along hierarchical references;
/// `None` for a node without one.
pub(super) async fn look_up_paths(
    connection: &Connection,
    nodes: &[NodeId],
) -> Result<Vec<Option<BrowsePath>>, ShopFloorError> {
    let namespaces = connection.namespaces();
    let objects = NodeId::from(ObjectId::ObjectsFolder);
    let mut parents: HashMap<NodeId, Option<NodeId>> = HashMap::new();
    let names = nodes.iter().cloned().zip(read_browse_names(connection, nodes).await?);
    let mut names: HashMap<NodeId, QualifiedName> =
        names.filter_map(|(node, name)| Some((node, name?))).collect();
    let mut level: Vec<NodeId> = nodes.to_vec();
    // One level up per round, all nodes together.
    for _ in 0..PATH_ELEMENTS_MAX {
        level.retain(|node| *node != objects && !parents.contains_key(node));
        level.sort_unstable_by_key(ToString::to_string);
        level.dedup();
        if level.is_empty() {
            break;
        }
        let descriptions = level.iter().cloned().map(parents_of).collect();
        let answers = references(connection, descriptions, 1).await?;
        let mut next = Vec::new();
        for (node, answer) in level.drain(..).zip(answers) {
            let parent = answer.into_iter().find(|reference| reference.node_id.server_index == 0);
            if let Some(ReferenceDescription { node_id, browse_name, .. }) = &parent {
                let name = qualified_name_from_stack(browse_name, &namespaces);
                names.insert(node_id.node_id.clone(), name);
                next.push(node_id.node_id.clone());
            }
            parents.insert(node, parent.map(|parent| parent.node_id.node_id));
        }
        level = next;
    }
    Ok(nodes.iter().map(|node| path_from(node, &objects, &parents, &names)).collect())
}

fn path_from(
    node: &NodeId,
    objects: &NodeId,
    parents: &HashMap<NodeId, Option<NodeId>>,
    names: &HashMap<NodeId, QualifiedName>,
) -> Option<BrowsePath> {
    let mut elements = Vec::new();
    let mut at = node;
    while at != objects {
        if elements.len() >= PATH_ELEMENTS_MAX {
            return None;
        }
        elements.push(names.get(at)?.clone());
        at = parents.get(at)?.as_ref()?;
    }
    elements.reverse();
    elements.shrink_to_fit();
    (!elements.is_empty()).then_some(BrowsePath(elements))
}

fn parents_of(node_id: NodeId) -> BrowseDescription {
    BrowseDescription {
        browse_direction: BrowseDirection::Inverse,
        result_mask: BrowseResultMaskFlags::BrowseName.bits(),
        ..children_of(node_id)
    }
}

/// Finds requested nodes that are not what their path says, and returns for each the node that is
/// at the path now.
///
/// A server may give an id to another node after a restart. Without this check the input would
/// silently deliver another variable.
pub(super) async fn find_relocated(
    connection: &Connection,
    requests: &[(Arc<MonitorRequest>, BrowsePath)],
) -> Result<HashMap<ModelNodeId, NodeId>, ShopFloorError> {
    let namespaces = connection.namespaces();
    let mut suspects = Vec::new();
    let mut known = Vec::new();
    for (request, path) in requests {
        match node_id_to_stack(&request.node_id, &namespaces) {
            Ok(id) => known.push((request, path, id)),
            Err(_) => suspects.push((request, path)),
        }
    }
    let ids: Vec<_> = known.iter().map(|(_, _, id)| id.clone()).collect();
    let names = read_browse_names(connection, &ids).await?;
    suspects.extend(
        known
            .into_iter()
            .zip(names)
            .filter(|((_, path, _), name)| path.0.last() != name.as_ref())
            .map(|((request, path, _), _)| (request, path)),
    );
    let paths: Vec<_> = suspects.iter().map(|(_, path)| (*path).clone()).collect();
    let found = translate(connection, &paths).await?;
    Ok(suspects
        .into_iter()
        .zip(found)
        .filter_map(|((request, _), targets)| {
            Some((request.node_id.clone(), targets.into_iter().next()?))
        })
        .collect())
}
