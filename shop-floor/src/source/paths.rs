//! Browse paths: where a node hangs, and what hangs there.

use std::{collections::HashMap, sync::Arc};

use asi_model::values::{NodeId as ModelNodeId, QualifiedName as ModelName};
use opcua_stack::{
    NamespaceTable,
    opcua::types::{
        AttributeId, BrowseDescription, BrowseDirection, BrowsePath as StackPath,
        BrowseResultMaskFlags, NodeId, ObjectId, ReadValueId, ReferenceDescription,
        ReferenceTypeId, RelativePath, RelativePathElement, TimestampsToReturn, Variant,
    },
    values::{node_id_to_stack, qualified_name_from_stack, qualified_name_to_stack},
};

use super::{Connection, browse::references, connection::per_request};
use shop_floor_model::PATH_ELEMENTS_MAX;

use crate::{BrowsePath, MonitorRequest, ShopFloorError};

/// Paths per request where the server declares no limit: translating is dear for servers.
const PATHS_PER_REQUEST: usize = 200;

pub(crate) async fn browse_path(
    connection: &Connection,
    node: &ModelNodeId,
) -> Result<BrowsePath, ShopFloorError> {
    let namespaces = connection.namespaces();
    let id = node_id_to_stack(node, &namespaces)
        .map_err(|error| ShopFloorError::Invalid(error.to_string()))?;
    let found = learn(connection, &[id]).await?.pop().flatten();
    found.ok_or_else(|| {
        ShopFloorError::Invalid(format!("{node} does not hang below the Objects folder"))
    })
}

/// The nodes at each path, from the Objects folder; none where nothing is there.
pub(super) async fn translate(
    connection: &Connection,
    paths: &[BrowsePath],
) -> Result<Vec<Vec<NodeId>>, ShopFloorError> {
    let namespaces = connection.namespaces();
    let mut found = vec![Vec::new(); paths.len()];
    let known: Vec<(usize, StackPath)> = paths
        .iter()
        .enumerate()
        .filter_map(|(index, path)| Some((index, stack_path(path, &namespaces)?)))
        .collect();
    let per_request =
        per_request(connection.limits().paths_per_translate_max).min(PATHS_PER_REQUEST);
    for chunk in known.chunks(per_request) {
        let requests: Vec<_> = chunk.iter().map(|(_, path)| path.clone()).collect();
        let session = connection.session();
        let answers = connection.ask(session.translate_browse_paths_to_node_ids(&requests)).await?;
        for ((index, _), answer) in chunk.iter().zip(answers) {
            let targets = answer.targets.into_iter().flatten();
            // Any other index than the highest means that the path leads to another server.
            found[*index] = targets
                .filter(|target| {
                    target.remaining_path_index == u32::MAX && target.target_id.server_index == 0
                })
                .map(|target| target.target_id.node_id)
                .collect();
        }
    }
    Ok(found)
}

fn stack_path(path: &BrowsePath, namespaces: &NamespaceTable) -> Option<StackPath> {
    let elements = path.0.iter().map(|name| {
        Some(RelativePathElement {
            reference_type_id: ReferenceTypeId::HierarchicalReferences.into(),
            is_inverse: false,
            include_subtypes: true,
            target_name: qualified_name_to_stack(name, namespaces).ok()?,
        })
    });
    Some(StackPath {
        starting_node: ObjectId::ObjectsFolder.into(),
        relative_path: RelativePath { elements: Some(elements.collect::<Option<_>>()?) },
    })
}

/// The way from the Objects folder to each node; `None` where there is none.
pub(super) async fn learn(
    connection: &Connection,
    nodes: &[NodeId],
) -> Result<Vec<Option<BrowsePath>>, ShopFloorError> {
    let namespaces = connection.namespaces();
    let objects = NodeId::from(ObjectId::ObjectsFolder);
    let mut parents: HashMap<NodeId, Option<NodeId>> = HashMap::new();
    let mut names: HashMap<NodeId, ModelName> = HashMap::new();
    let mut level: Vec<NodeId> = nodes.to_vec();
    for node in nodes.iter().zip(browse_names(connection, nodes).await?) {
        if let (node, Some(name)) = node {
            names.insert(node.clone(), name);
        }
    }
    // One level up per round, all nodes together.
    for _ in 0..PATH_ELEMENTS_MAX {
        level.retain(|node| *node != objects && !parents.contains_key(node));
        level.sort_unstable_by_key(ToString::to_string);
        level.dedup();
        if level.is_empty() {
            break;
        }
        let asked = level.iter().cloned().map(upward).collect();
        let answers = references(connection, asked, 1).await?;
        let mut next = Vec::new();
        for (node, answer) in level.drain(..).zip(answers) {
            let parent = answer.into_iter().find(|reference| reference.node_id.server_index == 0);
            if let Some(ReferenceDescription { node_id, browse_name, .. }) = &parent {
                names.insert(
                    node_id.node_id.clone(),
                    qualified_name_from_stack(browse_name, &namespaces),
                );
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
    names: &HashMap<NodeId, ModelName>,
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

fn upward(node_id: NodeId) -> BrowseDescription {
    BrowseDescription {
        node_id,
        browse_direction: BrowseDirection::Inverse,
        reference_type_id: ReferenceTypeId::HierarchicalReferences.into(),
        include_subtypes: true,
        node_class_mask: 0,
        result_mask: BrowseResultMaskFlags::BrowseName.bits(),
    }
}

/// The browse names of nodes; `None` where a node is not there.
pub(super) async fn browse_names(
    connection: &Connection,
    nodes: &[NodeId],
) -> Result<Vec<Option<ModelName>>, ShopFloorError> {
    let namespaces = connection.namespaces();
    let mut names = Vec::with_capacity(nodes.len());
    for chunk in nodes.chunks(per_request(connection.limits().nodes_per_read_max)) {
        let ids: Vec<_> = chunk
            .iter()
            .map(|node| ReadValueId::new(node.clone(), AttributeId::BrowseName))
            .collect();
        let answers = connection
            .ask(connection.session().read(&ids, TimestampsToReturn::Neither, 0.0))
            .await?;
        names.extend(answers.into_iter().map(|answer| match answer.value {
            Some(Variant::QualifiedName(name)) => {
                Some(qualified_name_from_stack(&name, &namespaces))
            }
            _ => None,
        }));
    }
    names.resize(nodes.len(), None);
    Ok(names)
}

/// Finds nodes that are not (any more) what their path says: each with the node that is there now.
///
/// An id that was given to another node after a restart would otherwise silently deliver another
/// variable.
pub(super) async fn moved(
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
    let names = browse_names(connection, &ids).await?;
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
