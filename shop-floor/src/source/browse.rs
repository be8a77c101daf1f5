//! Browsing: children with everything a person needs to choose, and search by name.

mod details;

use std::collections::{HashMap, HashSet, VecDeque};

use asi_model::values::NodeId as ModelNodeId;
use opcua_stack::{
    opcua::types::{
        BrowseDescription, BrowseDirection, BrowseResult, BrowseResultMaskFlags, NodeId, ObjectId,
        ReferenceDescription, ReferenceTypeId,
    },
    values::{node_id_from_stack, node_id_to_stack, qualified_name_from_stack},
};

use super::{Connection, connection::per_request, paths};
use crate::{BrowsePath, BrowsedNode, ShopFloorError};

use details::details;

/// Most children of a node that are shown.
const CHILDREN_MAX: usize = 100_000;
/// Most references asked for per node and answer.
const REFERENCES_PER_ANSWER: u32 = 1000;
/// Most nodes visited by a search, most found, and how deep it goes.
const VISITED_MAX: usize = 20_000;
const FOUND_MAX: usize = 1000;
const SEARCH_DEPTH_MAX: usize = 20;
/// A node before its details are known.
struct Bare {
    id: NodeId,
    type_definition: Option<NodeId>,
}

/// The children of a node from the one at `from` on, at most `limit` of them, and where the next ones begin. A server
/// with a hundred thousand children below one folder is asked for the details of those only that are shown.
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
    // Repeated references may use up some of these; they are few, and then a page is a little shorter.
    let asked_for = end.saturating_add(1).min(CHILDREN_MAX);
    let children = references(connection, vec![downward(parent)], asked_for).await?.pop().unwrap_or_default();
    let next = (children.len() > end).then_some(end);
    let mut seen = HashSet::new();
    let bare = children
        .into_iter()
        .take(end)
        .enumerate()
        .filter(|(_, child)| child.node_id.server_index == 0 && seen.insert(child.node_id.node_id.clone()))
        .filter(|(index, _)| *index >= from)
        .map(|(_, child)| Bare { id: child.node_id.node_id, type_definition: non_null(child.type_definition.node_id) })
        .collect();
    Ok((details(connection, bare).await?, next))
}

pub(crate) async fn describe(connection: &Connection, node: &ModelNodeId) -> Result<BrowsedNode, ShopFloorError> {
    let id = to_stack(connection, node)?;
    let asked =
        BrowseDescription { reference_type_id: ReferenceTypeId::HasTypeDefinition.into(), ..downward(id.clone()) };
    let types = references(connection, vec![asked], 1).await?.pop().unwrap_or_default();
    let type_definition = types.into_iter().next().and_then(|found| non_null(found.node_id.node_id));
    let described = details(connection, vec![Bare { id, type_definition }]).await?.pop();
    described.ok_or(ShopFloorError::Refused { status: asi_model::StatusCode::BAD_NODE_ID_UNKNOWN })
}

pub(crate) async fn search(
    connection: &Connection,
    text: &str,
    found_max: usize,
) -> Result<Vec<BrowsedNode>, ShopFloorError> {
    let wanted = text.to_lowercase();
    if wanted.is_empty() || wanted.len() > 1000 {
        return Err(ShopFloorError::Invalid("a search needs a text of at most 1000 characters".into()));
    }
    let found_max = found_max.clamp(1, FOUND_MAX);
    let namespaces = connection.namespaces();
    let root = NodeId::from(ObjectId::ObjectsFolder);
    let mut visited = HashSet::from([root.clone()]);
    let mut level = VecDeque::from([(root, BrowsePath::default())]);
    let mut found = Vec::new();
    for _ in 0..SEARCH_DEPTH_MAX {
        let asked: Vec<_> = level.iter().map(|(node, _)| downward(node.clone())).collect();
        let answers = references(connection, asked, CHILDREN_MAX).await?;
        let mut next = VecDeque::new();
        for ((_, path), children) in level.drain(..).zip(answers) {
            for child in children {
                if child.node_id.server_index != 0 || !visited.insert(child.node_id.node_id.clone()) {
                    continue;
                }
                let mut path = path.clone();
                path.0.push(qualified_name_from_stack(&child.browse_name, &namespaces));
                if found.len() < found_max && matches(&child, &wanted) {
                    let type_definition = non_null(child.type_definition.node_id.clone());
                    found.push((Bare { id: child.node_id.node_id.clone(), type_definition }, path.clone()));
                }
                next.push_back((child.node_id.node_id, path));
            }
        }
        level = next;
        if level.is_empty() || found.len() >= found_max || visited.len() >= VISITED_MAX {
            break;
        }
    }
    let (bare, paths): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    let by_id: HashMap<_, _> = bare.iter().map(|bare| node_id_from_stack(&bare.id, &namespaces)).zip(paths).collect();
    let mut nodes = details(connection, bare).await?;
    for node in &mut nodes {
        node.browse_path = by_id.get(&node.node_id).cloned();
    }
    Ok(nodes)
}

fn matches(child: &ReferenceDescription, wanted: &str) -> bool {
    [&child.browse_name.name, &child.display_name.text]
        .into_iter()
        .any(|name| name.value().as_deref().is_some_and(|name| name.to_lowercase().contains(wanted)))
}

fn to_stack(connection: &Connection, node: &ModelNodeId) -> Result<NodeId, ShopFloorError> {
    node_id_to_stack(node, &connection.namespaces()).map_err(|error| ShopFloorError::Invalid(error.to_string()))
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
        let Some(next) = answers.into_iter().next().filter(|next| next.status_code.is_good()) else { break };
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
