//! All variables of a server, with as much as one walk through its address space tells.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use opcua_stack::{
    opcua::types::{
        BrowseDescription, BrowseDirection, NodeClass as StackClass, NodeClassMask, NodeId,
        ObjectId, ReferenceDescription, ReferenceTypeId,
    },
    values::node_id_from_stack,
};

use super::{
    Connection, downward, non_null, paths, references,
    walk::{Onward, walk},
};
use crate::{ListedVariable, ShopFloorError, VariableList};

/// Longest way up from a type to the base of all.
const SUPERTYPES_MAX: usize = 20;
/// The base types' names say nothing about a node.
const BASE_TYPES: [&str; 6] = [
    "BaseObjectType",
    "FolderType",
    "BaseVariableType",
    "BaseDataVariableType",
    "DataItemType",
    "PropertyType",
];

/// A variable whose types have no names yet: its own, and those of what stands above it.
struct Found {
    variable: ListedVariable,
    types: Arc<[NodeId]>,
}

pub(crate) async fn list(
    connection: &Connection,
    visited_max: usize,
) -> Result<VariableList, ShopFloorError> {
    let namespaces = connection.namespaces();
    let mut found: Vec<Found> = Vec::new();
    let is_complete =
        walk(connection, Arc::<[NodeId]>::default(), visited_max, |child, path, above| {
            if is_aside(child) {
                return Onward::Past;
            }
            let types = match non_null(child.type_definition.node_id.clone()) {
                Some(own) if !above.contains(&own) => above.iter().cloned().chain([own]).collect(),
                _ => Arc::clone(above),
            };
            if child.node_class == StackClass::Variable {
                let name = child.display_name.text.value().clone();
                let variable = ListedVariable {
                    node_id: node_id_from_stack(&child.node_id.node_id, &namespaces),
                    display_name: name.unwrap_or_else(|| {
                        path.0.last().map(|name| name.to_string()).unwrap_or_default()
                    }),
                    browse_path: path.clone(),
                    type_names: Vec::new(),
                };
                found.push(Found { variable, types: Arc::clone(&types) });
            }
            Onward::Below(types)
        })
        .await?;
    let distinct: HashSet<NodeId> =
        found.iter().flat_map(|found| found.types.iter().cloned()).collect();
    let names = names_with_supertypes(connection, distinct).await?;
    let variables = found.into_iter().map(|Found { mut variable, types }| {
        let named = types.iter().rev().filter_map(|id| names.get(id)).flatten();
        variable.type_names = named.cloned().collect();
        variable
    });
    Ok(VariableList { variables: variables.collect(), is_complete })
}

/// What nobody maps: the server's description of itself, properties, methods.
fn is_aside(child: &ReferenceDescription) -> bool {
    child.node_id.node_id == ObjectId::Server
        || child.reference_type_id == ReferenceTypeId::HasProperty
        || child.node_class == StackClass::Method
}

/// The names of types, each followed by those of its supertypes; base types left out.
async fn names_with_supertypes(
    connection: &Connection,
    types: HashSet<NodeId>,
) -> Result<HashMap<NodeId, Vec<Arc<str>>>, ShopFloorError> {
    let mut parents: HashMap<NodeId, Option<NodeId>> = HashMap::new();
    let mut level: Vec<NodeId> = types.iter().cloned().collect();
    for _ in 0..SUPERTYPES_MAX {
        if level.is_empty() {
            break;
        }
        let asked = level.iter().map(|id| BrowseDescription {
            browse_direction: BrowseDirection::Inverse,
            reference_type_id: ReferenceTypeId::HasSubtype.into(),
            include_subtypes: false,
            node_class_mask: NodeClassMask::all().bits(),
            ..downward(id.clone())
        });
        let answers = references(connection, asked.collect(), 1).await?;
        let mut next = Vec::new();
        for (id, answer) in level.drain(..).zip(answers) {
            let parent = answer.into_iter().next().map(|parent| parent.node_id.node_id);
            next.extend(parent.clone());
            parents.insert(id, parent);
        }
        next.retain(|id| !parents.contains_key(id));
        next.sort_unstable_by_key(ToString::to_string);
        next.dedup();
        level = next;
    }
    let ids: Vec<NodeId> = parents.keys().cloned().collect();
    let names = paths::browse_names(connection, &ids).await?;
    let names: HashMap<NodeId, Arc<str>> =
        ids.into_iter().zip(names).filter_map(|(id, name)| Some((id, name?.name?))).collect();
    let chain = |id: &NodeId| {
        let mut chain = Vec::new();
        let mut at = Some(id);
        while let Some(id) = at.filter(|_| chain.len() < SUPERTYPES_MAX) {
            chain.extend(names.get(id).filter(|name| !BASE_TYPES.contains(&&***name)).cloned());
            at = parents.get(id).and_then(Option::as_ref);
        }
        chain
    };
    Ok(types.iter().map(|id| (id.clone(), chain(id))).collect())
}
