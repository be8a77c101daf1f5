//! Names of types, and the built-in types behind data types.

use std::collections::{HashMap, HashSet};

use asi_model::values::{BuiltInType, NodeId as ModelNodeId};
use opcua_stack::{
    NamespaceTable,
    opcua::types::{DataTypeId, NodeClassMask, NodeId},
    values::node_id_from_stack,
};

use crate::{
    NodeType, ShopFloorError,
    source::{
        connection::Connection,
        services::{read_browse_names, references, supertype_of},
    },
};

/// Most supertypes between a data type and a built-in one.
const SUPERTYPES_MAX: usize = 20;

/// Browse names of types without their namespaces; empty for types that the server does not know.
pub(super) struct TypeNames(HashMap<NodeId, String>);

impl TypeNames {
    pub(super) async fn read(
        connection: &Connection,
        ids: HashSet<NodeId>,
    ) -> Result<Self, ShopFloorError> {
        let ids: Vec<_> = ids.into_iter().collect();
        let names = read_browse_names(connection, &ids).await?.into_iter();
        let names = names.map(|name| {
            name.and_then(|name| name.name).map(|name| name.to_string()).unwrap_or_default()
        });
        Ok(Self(ids.into_iter().zip(names).collect()))
    }

    pub(super) fn name(&self, id: &NodeId, namespaces: &NamespaceTable) -> NodeType {
        NodeType {
            node_id: node_id_from_stack(id, namespaces),
            name: self.0.get(id).cloned().unwrap_or_default(),
        }
    }

    /// Finds the built-in types behind these types, along their supertypes.
    pub(super) async fn built_in_types(
        &self,
        connection: &Connection,
        namespaces: &NamespaceTable,
    ) -> Result<HashMap<ModelNodeId, BuiltInType>, ShopFloorError> {
        let mut found = HashMap::new();
        // Pairs of a type and the supertype of it that was reached.
        let mut open: Vec<(NodeId, NodeId)> =
            self.0.keys().map(|id| (id.clone(), id.clone())).collect();
        for _ in 0..SUPERTYPES_MAX {
            open.retain(|(id, at)| match built_in_type(at) {
                Some(built_in) => {
                    found.insert(node_id_from_stack(id, namespaces), built_in);
                    false
                }
                None => true,
            });
            if open.is_empty() {
                break;
            }
            let descriptions =
                open.iter().map(|(_, at)| supertype_of(at.clone(), NodeClassMask::DATA_TYPE));
            let answers = references(connection, descriptions.collect(), 1).await?;
            open = open
                .into_iter()
                .zip(answers)
                .filter_map(|((id, _), parents)| {
                    Some((id, parents.into_iter().next()?.node_id.node_id))
                })
                .collect();
        }
        Ok(found)
    }
}

/// Returns the built-in type that a data type of namespace 0 is, or that carries its values.
fn built_in_type(id: &NodeId) -> Option<BuiltInType> {
    if id.namespace != 0 {
        return None;
    }
    let id = id.as_u32()?;
    if id == DataTypeId::Enumeration as u32 {
        return Some(BuiltInType::Int32);
    }
    // The DataTypes of namespace 0 have their built-in types' ids up to DiagnosticInfo (25).
    BuiltInType::from_id(u64::from(id))
}
