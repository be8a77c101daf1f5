//! Browse service, with the continuation points of long answers.

use opcua_stack::opcua::types::{
    BrowseDescription, BrowseDirection, BrowseResult, BrowseResultMaskFlags, NodeClassMask, NodeId,
    ReferenceDescription, ReferenceTypeId,
};

use crate::{
    ShopFloorError,
    source::{connection::Connection, request_size::per_request},
};

/// Most references per node and answer.
const REFERENCES_PER_ANSWER: u32 = 1000;
/// Most nodes per request. Answers with all references of more nodes become very large.
const NODES_PER_REQUEST: usize = 250;

/// Describes the children of a node: its forward hierarchical references.
pub(in crate::source) fn children_of(node_id: NodeId) -> BrowseDescription {
    BrowseDescription {
        node_id,
        browse_direction: BrowseDirection::Forward,
        reference_type_id: ReferenceTypeId::HierarchicalReferences.into(),
        include_subtypes: true,
        node_class_mask: 0,
        result_mask: BrowseResultMaskFlags::all().bits(),
    }
}

/// Describes the supertype of a type node.
pub(in crate::source) fn supertype_of(
    node_id: NodeId,
    classes: NodeClassMask,
) -> BrowseDescription {
    BrowseDescription {
        browse_direction: BrowseDirection::Inverse,
        reference_type_id: ReferenceTypeId::HasSubtype.into(),
        include_subtypes: false,
        node_class_mask: classes.bits(),
        ..children_of(node_id)
    }
}

/// Browses nodes and returns at most `max` references of each, in order; none of a node that the
/// server refuses to browse.
pub(in crate::source) async fn references(
    connection: &Connection,
    nodes: Vec<BrowseDescription>,
    max: usize,
) -> Result<Vec<Vec<ReferenceDescription>>, ShopFloorError> {
    let limits = connection.limits();
    // Each long list in an answer takes one of the server's continuation points.
    let points = limits.browse_continuation_points_max.map_or(usize::MAX, |points| points as usize);
    let per_request =
        per_request(limits.nodes_per_browse_max).min(points.max(1)).min(NODES_PER_REQUEST);
    let per_answer = u32::try_from(max).unwrap_or(u32::MAX).min(REFERENCES_PER_ANSWER);
    let mut all = Vec::with_capacity(nodes.len());
    for chunk in nodes.chunks(per_request) {
        let browse = connection.session().browse(chunk, per_answer, None);
        let mut answers = connection.request(browse).await?;
        answers.resize_with(chunk.len(), BrowseResult::default);
        for answer in answers {
            all.push(read_to_end(connection, answer, max).await?);
        }
    }
    Ok(all)
}

/// Returns the references of an answer and of its continuation points.
async fn read_to_end(
    connection: &Connection,
    answer: BrowseResult,
    max: usize,
) -> Result<Vec<ReferenceDescription>, ShopFloorError> {
    let mut found = answer.references.unwrap_or_default();
    let mut point = answer.continuation_point;
    while !point.is_null_or_empty() {
        // With enough references the point is released, so that the server can reuse it.
        let is_enough = found.len() >= max;
        let points = [point];
        let next = connection.session().browse_next(is_enough, &points);
        let answers = connection.request(next).await?;
        if is_enough {
            break;
        }
        let Some(next) = answers.into_iter().next().filter(|next| next.status_code.is_good())
        else {
            break;
        };
        let more = next.references.unwrap_or_default();
        // A faulty server may return continuation points forever, without references.
        if more.is_empty() {
            break;
        }
        found.extend(more);
        point = next.continuation_point;
    }
    found.truncate(max);
    Ok(found)
}
