//! Children of a node in pages, and single nodes, with their details.

use std::collections::HashSet;

use asi_model::values::{NodeId as ModelNodeId, StatusCode};
use opcua_stack::{
    opcua::types::{BrowseDescription, NodeId, ObjectId, ReferenceTypeId},
    values::node_id_to_stack,
};

use super::details::{FoundNode, details, non_null};
use crate::{
    BrowsedNode, ShopFloorError,
    source::{
        connection::Connection,
        services::{children_of, references},
    },
};

/// Most children of a node that are shown.
const CHILDREN_MAX: usize = 100_000;
/// Most nodes described in one request of a caller.
const DESCRIBED_MAX: usize = 1000;

/// Returns at most `limit` children of a node, starting at the index `from`, and the index of the
/// next page. Details are read for the returned children only: a folder may have a hundred thousand
/// of them.
pub(crate) async fn browse(
    connection: &Connection,
    parent: Option<&ModelNodeId>,
    from: usize,
    limit: usize,
) -> Result<(Vec<BrowsedNode>, Option<usize>), ShopFloorError> {
    let parent = match parent {
        Some(parent) => to_stack(connection, parent)?,
        None => ObjectId::ObjectsFolder.into(),
    };
    let end = from.saturating_add(limit);
    // Duplicate references take up some of these; they are few, and only make a page shorter.
    let references_max = end.saturating_add(1).min(CHILDREN_MAX);
    let children = references(connection, vec![children_of(parent)], references_max).await?;
    let children = children.into_iter().next().unwrap_or_default();
    let next = (children.len() > end).then_some(end);
    let mut seen = HashSet::new();
    let found = children
        .into_iter()
        .take(end)
        .enumerate()
        .filter(|(_, child)| {
            child.node_id.server_index == 0 && seen.insert(child.node_id.node_id.clone())
        })
        .filter(|(index, _)| *index >= from)
        .map(|(_, child)| FoundNode {
            id: child.node_id.node_id,
            type_definition: non_null(child.type_definition.node_id),
        })
        .collect();
    Ok((details(connection, found).await?, next))
}

pub(crate) async fn describe(
    connection: &Connection,
    node: &ModelNodeId,
) -> Result<BrowsedNode, ShopFloorError> {
    let described = describe_many(connection, std::slice::from_ref(node)).await?.pop();
    described.ok_or(ShopFloorError::Refused { status: StatusCode::BAD_NODE_ID_UNKNOWN })
}

/// Returns nodes in the order of the request, without those that the server does not know.
pub(crate) async fn describe_many(
    connection: &Connection,
    nodes: &[ModelNodeId],
) -> Result<Vec<BrowsedNode>, ShopFloorError> {
    if nodes.len() > DESCRIBED_MAX {
        let what = "nodes to describe";
        return Err(ShopFloorError::LimitReached { what, limit: DESCRIBED_MAX });
    }
    let ids: Vec<NodeId> =
        nodes.iter().map(|node| to_stack(connection, node)).collect::<Result<_, _>>()?;
    let type_of = |id: &NodeId| BrowseDescription {
        reference_type_id: ReferenceTypeId::HasTypeDefinition.into(),
        ..children_of(id.clone())
    };
    let types = references(connection, ids.iter().map(type_of).collect(), 1).await?;
    let found = ids.into_iter().zip(types).map(|(id, types)| {
        let type_definition = types.into_iter().next();
        let type_definition = type_definition.and_then(|found| non_null(found.node_id.node_id));
        FoundNode { id, type_definition }
    });
    details(connection, found.collect()).await
}

fn to_stack(connection: &Connection, node: &ModelNodeId) -> Result<NodeId, ShopFloorError> {
    node_id_to_stack(node, &connection.namespaces())
        .map_err(|error| ShopFloorError::Invalid(error.to_string()))
}
