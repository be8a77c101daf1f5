//! List of all variables of a server, from one walk through its address space.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use opcua_stack::{
    opcua::types::{
        NodeClass, NodeClassMask, NodeId, ObjectId, ReferenceDescription, ReferenceTypeId,
    },
    values::node_id_from_stack,
};

use super::{
    details::non_null,
    walk::{WalkStep, walk},
};
use crate::{
    ListedVariable, ShopFloorError, VariableList,
    source::{
        connection::Connection,
        services::{read_browse_names, references, supertype_of},
    },
};

/// Most supertypes above a type.
const SUPERTYPES_MAX: usize = 20;
/// Base types. Their names say nothing about a variable.
const BASE_TYPES: [&str; 6] = [
    "BaseObjectType",
    "FolderType",
    "BaseVariableType",
    "BaseDataVariableType",
    "DataItemType",
    "PropertyType",
];

/// Variable whose type names are not read yet.
struct FoundVariable {
    variable: ListedVariable,
    /// Types of the nodes above it and its own, from the top down.
    types: Arc<[NodeId]>,
}

/// Lists all variables below the Objects folder, after a visit of at most `visited_max` nodes.
pub(crate) async fn list_variables(
    connection: &Connection,
    visited_max: usize,
) -> Result<VariableList, ShopFloorError> {
    let namespaces = connection.namespaces();
    let mut found: Vec<FoundVariable> = Vec::new();
    let is_complete =
        walk(connection, Arc::<[NodeId]>::default(), visited_max, |child, path, above| {
            if is_excluded(child) {
                return WalkStep::Skip;
            }
            let types = match non_null(child.type_definition.node_id.clone()) {
                Some(own) if !above.contains(&own) => above.iter().cloned().chain([own]).collect(),
                _ => Arc::clone(above),
            };
            if child.node_class == NodeClass::Variable {
                let name = child.display_name.text.value().clone();
                let variable = ListedVariable {
                    node_id: node_id_from_stack(&child.node_id.node_id, &namespaces),
                    display_name: name.unwrap_or_else(|| {
                        path.0.last().map(|name| name.to_string()).unwrap_or_default()
                    }),
                    browse_path: path.clone(),
                    type_names: Vec::new(),
                };
                found.push(FoundVariable { variable, types: Arc::clone(&types) });
            }
            WalkStep::Descend(types)
        })
        .await?;
    let types: HashSet<NodeId> =
        found.iter().flat_map(|found| found.types.iter().cloned()).collect();
    let names = names_with_supertypes(connection, types).await?;
    let variables = found.into_iter().map(|FoundVariable { mut variable, types }| {
        let named = types.iter().rev().filter_map(|id| names.get(id)).flatten();
        variable.type_names = named.cloned().collect();
        variable
    });
    Ok(VariableList { variables: variables.collect(), is_complete })
}

/// Returns true for nodes that are no process values: the Server object, properties and methods.
fn is_excluded(child: &ReferenceDescription) -> bool {
    child.node_id.node_id == ObjectId::Server
        || child.reference_type_id == ReferenceTypeId::HasProperty
        || child.node_class == NodeClass::Method
}

/// Returns the names of types, each followed by those of its supertypes, without base types.
async fn names_with_supertypes(
    connection: &Connection,
    types: HashSet<NodeId>,
) -> Result<HashMap<NodeId, Vec<Arc<str>>>, ShopFloorError> {
    let supertypes = supertypes(connection, &types).await?;
    let ids: Vec<NodeId> = supertypes.keys().cloned().collect();
    let names = read_browse_names(connection, &ids).await?;
    let names: HashMap<NodeId, Arc<str>> =
        ids.into_iter().zip(names).filter_map(|(id, name)| Some((id, name?.name?))).collect();
    let chain = |id: &NodeId| {
        let mut chain = Vec::new();
        let mut at = Some(id);
        while let Some(id) = at.filter(|_| chain.len() < SUPERTYPES_MAX) {
            chain.extend(names.get(id).filter(|name| !BASE_TYPES.contains(&&***name)).cloned());
            at = supertypes.get(id).and_then(Option::as_ref);
        }
        chain
    };
    Ok(types.iter().map(|id| (id.clone(), chain(id))).collect())
}

/// Returns the supertype of each type, and of each type above them.
async fn supertypes(
    connection: &Connection,
    types: &HashSet<NodeId>,
) -> Result<HashMap<NodeId, Option<NodeId>>, ShopFloorError> {
    let mut supertypes: HashMap<NodeId, Option<NodeId>> = HashMap::new();
    let mut level: Vec<NodeId> = types.iter().cloned().collect();
    for _ in 0..SUPERTYPES_MAX {
        if level.is_empty() {
            break;
        }
        let descriptions =
            level.iter().map(|id| supertype_of(id.clone(), NodeClassMask::all())).collect();
        let answers = references(connection, descriptions, 1).await?;
        let mut next = Vec::new();
        for (id, answer) in level.drain(..).zip(answers) {
            let parent = answer.into_iter().next().map(|parent| parent.node_id.node_id);
            next.extend(parent.clone());
            supertypes.insert(id, parent);
        }
        next.retain(|id| !supertypes.contains_key(id));
        next.sort_unstable_by_key(ToString::to_string);
        next.dedup();
        level = next;
    }
    Ok(supertypes)
}
