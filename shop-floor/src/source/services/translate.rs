//! TranslateBrowsePathsToNodeIds service.

use opcua_stack::{
    NamespaceTable,
    opcua::types::{
        BrowsePath as StackPath, NodeId, ObjectId, ReferenceTypeId, RelativePath,
        RelativePathElement,
    },
    values::qualified_name_to_stack,
};

use crate::{
    BrowsePath, ShopFloorError,
    source::{connection::Connection, request_size::per_request},
};

/// Most paths per request: servers take long to translate one.
const PATHS_PER_REQUEST: usize = 200;

/// Returns the nodes at each path from the Objects folder, in order.
pub(in crate::source) async fn translate(
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
        let answers =
            connection.request(session.translate_browse_paths_to_node_ids(&requests)).await?;
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

/// Converts a path; `None` when the server does not have one of its namespaces.
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
