//! Search for nodes by name.

use std::collections::HashMap;

use opcua_stack::{opcua::types::ReferenceDescription, values::node_id_from_stack};

use super::{
    details::{FoundNode, details, non_null},
    walk::{WalkStep, walk},
};
use crate::{BrowsedNode, ShopFloorError, source::connection::Connection};

/// Most nodes visited by a search, and most nodes found.
const VISITED_MAX: usize = 20_000;
const FOUND_MAX: usize = 1000;

/// Finds nodes whose browse or display name contains a text, ignoring case.
pub(crate) async fn search(
    connection: &Connection,
    text: &str,
    found_max: usize,
) -> Result<Vec<BrowsedNode>, ShopFloorError> {
    let text = text.to_lowercase();
    if text.is_empty() || text.len() > 1000 {
        return Err(ShopFloorError::Invalid(
            "a search needs a text of at most 1000 characters".into(),
        ));
    }
    let found_max = found_max.clamp(1, FOUND_MAX);
    let namespaces = connection.namespaces();
    let mut found = Vec::new();
    let mut paths = HashMap::new();
    walk(connection, (), VISITED_MAX, |child, path, ()| {
        if has_name_with(child, &text) {
            let id = child.node_id.node_id.clone();
            paths.insert(node_id_from_stack(&id, &namespaces), path.clone());
            let type_definition = non_null(child.type_definition.node_id.clone());
            found.push(FoundNode { id, type_definition });
        }
        if found.len() < found_max { WalkStep::Descend(()) } else { WalkStep::Stop }
    })
    .await?;
    let mut nodes = details(connection, found).await?;
    for node in &mut nodes {
        node.browse_path = paths.remove(&node.node_id);
    }
    Ok(nodes)
}

fn has_name_with(child: &ReferenceDescription, text: &str) -> bool {
    [&child.browse_name.name, &child.display_name.text]
        .into_iter()
        .any(|name| name.value().as_deref().is_some_and(|name| name.to_lowercase().contains(text)))
}
