//! Browsing: children with everything a person needs to choose, and search by name.

mod details;
mod list;
mod walk;

use std::collections::{HashMap, HashSet};

use asi_model::values::NodeId as ModelNodeId;
use opcua_stack::{
    opcua::types::{
        BrowseDescription, BrowseDirection, BrowseResult, BrowseResultMaskFlags, NodeId, ObjectId,
        ReferenceDescription, ReferenceTypeId,
    },
    values::{node_id_from_stack, node_id_to_stack},
};

use super::{Connection, connection::per_request, paths};
use crate::{BrowsedNode, ShopFloorError};

use details::details;
pub(crate) use list::list;
use walk::{Onward, walk};

/// Most children of a node that are shown.
const CHILDREN_MAX: usize = 100_000;
/// Most references asked for per node and answer.
const REFERENCES_PER_ANSWER: u32 = 1000;
/// Most nodes visited by a search, and most found.
const VISITED_MAX: usize = 20_000;
const FOUND_MAX: usize = 1000;
/// A node before its details are known.
struct Bare {
    id: NodeId,
    type_definition: Option<NodeId>,
}

/// The children of a node from the one at `from` on, at most `limit` of them, and where the next
/// ones begin. A server with a hundred thousand children below one folder is asked for the details
/// of those only that are shown.
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
    // Repeated references may use up some of these; they are few, and then a page is a little
    // shorter.
    let asked_for = end.saturating_add(1).min(CHILDREN_MAX);
    let children =
        references(connection, vec![downward(parent)], asked_for).await?.pop().unwrap_or_default();
    let next = (children.len() > end).then_some(end);
    let mut seen = HashSet::new();
    let bare = children
        .into_iter()
        .take(end)
        .enumerate()
        .filter(|(_, child)| {
            child.node_id.server_index == 0 && seen.insert(child.node_id.node_id.clone())
        })
        .filter(|(index, _)| *index >= from)
        .map(|(_, child)| Bare {
            id: child.node_id.node_id,
            type_definition: non_null(child.type_definition.node_id),
        })
        .collect();
    Ok((details(connection, bare).await?, next))
}

pub(crate) async fn describe(
    connection: &Connection,
    node: &ModelNodeId,
) -> Result<BrowsedNode, ShopFloorError> {
    let described = describe_many(connection, std::slice::from_ref(node)).await?.pop();
    described.ok_or(ShopFloorError::Refused { status: asi_model::StatusCode::BAD_NODE_ID_UNKNOWN })
}

/// Nodes in the order asked; those that are not there are left out.
pub(crate) async fn describe_many(
    connection: &Connection,
    nodes: &[ModelNodeId],
) -> Result<Vec<BrowsedNode>, ShopFloorError> {
    if nodes.len() > FOUND_MAX {
        return Err(ShopFloorError::LimitReached { what: "nodes to describe", limit: FOUND_MAX });
    }
    let ids: Vec<NodeId> =
        nodes.iter().map(|node| to_stack(connection, node)).collect::<Result<_, _>>()?;
    let type_of = |id: &NodeId| BrowseDescription {
        reference_type_id: ReferenceTypeId::HasTypeDefinition.into(),
        ..downward(id.clone())
    };
    let types = references(connection, ids.iter().map(type_of).collect(), 1).await?;
    let bare = ids.into_iter().zip(types).map(|(id, types)| Bare {
        id,
        type_definition: types.into_iter().next().and_then(|found| non_null(found.node_id.node_id)),
    });
    details(connection, bare.collect()).await
}

pub(crate) async fn search(
    connection: &Connection,
    text: &str,
    found_max: usize,
) -> Result<Vec<BrowsedNode>, ShopFloorError> {
    let wanted = text.to_lowercase();
    if wanted.is_empty() || wanted.len() > 1000 {
        return Err(ShopFloorError::Invalid(
            "a search needs a text of at most 1000 characters".into(),
        ));
    }
    let found_max = found_max.clamp(1, FOUND_MAX);
    let namespaces = connection.namespaces();
    let mut found = Vec::new();
    walk(connection, (), VISITED_MAX, |child, path, ()| {
        if matches(child, &wanted) {
            let type_definition = non_null(child.type_definition.node_id.clone());
            found.push((Bare { id: child.node_id.node_id.clone(), type_definition }, path.clone()));
        }
        if found.len() < found_max { Onward::Below(()) } else { Onward::Home }
    })
    .await?;
    let (bare, paths): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    let by_id: HashMap<_, _> =
        bare.iter().map(|bare| node_id_from_stack(&bare.id, &namespaces)).zip(paths).collect();
    let mut nodes = details(connection, bare).await?;
    for node in &mut nodes {
        node.browse_path = by_id.get(&node.node_id).cloned();
    }
    Ok(nodes)
}

fn matches(child: &ReferenceDescription, wanted: &str) -> bool {
    [&child.browse_name.name, &child.display_name.text].into_iter().any(|name| {
        name.value().as_deref().is_some_and(|name| name.to_lowercase().contains(wanted))
    })
}

fn to_stack(connection: &Connection, node: &ModelNodeId) -> Result<NodeId, ShopFloorError> {
    node_id_to_stack(node, &connection.namespaces())
        .map_err(|error| ShopFloorError::Invalid(error.to_string()))
}

fn non_null(id: NodeId) -> Option<NodeId> {
    (!id.is_null()).then_some(id)
}

fn downward(node_id: NodeId) -> BrowseDescription {
    BrowseDescription {
        node_id,
        browse_direction: BrowseDirection::Forward,
        reference_type_id: ReferenceTypeId::HierarchicalReferences.into(),
        include_subtypes: true,
        node_class_mask: 0,
        result_mask: BrowseResultMaskFlags::all().bits(),
    }
}

/// All references of nodes, in the order asked, each at most `max`; none where a node refuses.
pub(super) async fn references(
    connection: &Connection,
    asked: Vec<BrowseDescription>,
    max: usize,
) -> Result<Vec<Vec<ReferenceDescription>>, ShopFloorError> {
    let limits = connection.limits();
    // A server without room for continuation points must not be asked for many long lists at once.
    let points = limits.browse_continuation_points_max.map_or(usize::MAX, |points| points as usize);
    let per_request = per_request(limits.nodes_per_browse_max).min(points.max(1)).min(250);
    let per_answer = u32::try_from(max).unwrap_or(u32::MAX).min(REFERENCES_PER_ANSWER);
    let mut all = Vec::with_capacity(asked.len());
    for chunk in asked.chunks(per_request) {
        let session = connection.session();
        let mut answers = connection.ask(session.browse(chunk, per_answer, None)).await?;
        answers.resize_with(chunk.len(), BrowseResult::default);
        for answer in answers {
            all.push(follow(connection, answer, max).await?);
        }
    }
    Ok(all)
}

/// An answer with what its continuation points still hold.
async fn follow(
    connection: &Connection,
    answer: BrowseResult,
    max: usize,
) -> Result<Vec<ReferenceDescription>, ShopFloorError> {
    let mut found = answer.references.unwrap_or_default();
    let mut point = answer.continuation_point;
    while !point.is_null_or_empty() {
        let is_enough = found.len() >= max;
        let answers = connection.ask(connection.session().browse_next(is_enough, &[point])).await?;
        if is_enough {
            break;
        }
        let Some(next) = answers.into_iter().next().filter(|next| next.status_code.is_good())
        else {
            break;
        };
        let more = next.references.unwrap_or_default();
        // A server that goes on forever without giving anything.
        if more.is_empty() {
            break;
        }
        found.extend(more);
        point = next.continuation_point;
    }
    found.truncate(max);
    Ok(found)
}
