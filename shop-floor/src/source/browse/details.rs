//! Details of nodes: names, types, units and ranges.

use std::{collections::HashSet, sync::Arc};

use asi_model::values::{
    DataValue, ExtensionBody, NodeId as ModelNodeId, QualifiedName, Scalar, Variant,
};
use indexmap::IndexMap;
use opcua_stack::{
    NamespaceTable,
    opcua::types::{
        AttributeId, NodeClass as StackClass, NodeId, ReadValueId, ReferenceDescription,
    },
    values::{node_id_from_stack, node_id_to_stack},
};

use super::data_types::TypeNames;
use crate::{
    BrowsePath, BrowsedNode, NodeClass, ShopFloorError, UnitName,
    source::{
        connection::Connection,
        services::{children_of, read_attributes, references},
    },
};

/// Most children of a node among which properties are looked for.
const PROPERTIES_MAX: usize = 200;
/// Attributes of a node, in the order of [`Attributes`].
const ATTRIBUTES: [AttributeId; 7] = [
    AttributeId::BrowseName,
    AttributeId::DisplayName,
    AttributeId::NodeClass,
    AttributeId::Description,
    AttributeId::DataType,
    AttributeId::ValueRank,
    AttributeId::UserAccessLevel,
];

/// Node whose details are not read yet.
pub(super) struct FoundNode {
    pub(super) id: NodeId,
    pub(super) type_definition: Option<NodeId>,
}

/// Attributes of one node as they were read.
struct Attributes {
    browse_name: QualifiedName,
    display_name: Option<String>,
    node_class: NodeClass,
    description: Option<String>,
    data_type: Option<ModelNodeId>,
    value_rank: Option<i32>,
    access_level: Option<i128>,
}

/// Reads the details of nodes, and leaves out those that the server does not know.
pub(super) async fn details(
    connection: &Connection,
    found: Vec<FoundNode>,
) -> Result<Vec<BrowsedNode>, ShopFloorError> {
    let namespaces = connection.namespaces();
    let ids: Vec<_> = found
        .iter()
        .flat_map(|node| ATTRIBUTES.map(|attribute| ReadValueId::new(node.id.clone(), attribute)))
        .collect();
    let values = read_attributes(connection, &ids, &namespaces).await?;
    let attributes: Vec<_> = values.chunks(ATTRIBUTES.len()).map(Attributes::new).collect();
    let children = found.iter().map(|node| children_of(node.id.clone())).collect();
    let children = references(connection, children, PROPERTIES_MAX).await?;
    let properties = read_properties(connection, &children, &namespaces).await?;
    let data_types = attributes
        .iter()
        .flatten()
        .filter_map(|node| node_id_to_stack(node.data_type.as_ref()?, &namespaces).ok());
    let types = found.iter().filter_map(|node| node.type_definition.clone()).chain(data_types);
    let types = TypeNames::read(connection, types.collect::<HashSet<_>>()).await?;
    let built_in_types = types.built_in_types(connection, &namespaces).await?;
    let nodes =
        found.iter().zip(attributes).enumerate().filter_map(|(index, (node, attributes))| {
            let attributes = attributes?;
            let is_variable = attributes.node_class == NodeClass::Variable;
            let data_type = attributes.data_type.filter(|_| is_variable);
            let (unit, range) = properties[index].clone();
            let path = BrowsePath(vec![attributes.browse_name]);
            Some(BrowsedNode {
                node_id: node_id_from_stack(&node.id, &namespaces),
                browse_name: path.to_texts().pop().unwrap_or_default(),
                display_name: attributes.display_name.unwrap_or_else(|| path.to_string()),
                description: attributes.description,
                node_class: attributes.node_class,
                type_definition: node
                    .type_definition
                    .as_ref()
                    .map(|id| types.name(id, &namespaces)),
                built_in_type: data_type.as_ref().and_then(|id| built_in_types.get(id).copied()),
                data_type: data_type.and_then(|id| {
                    let id = node_id_to_stack(&id, &namespaces).ok()?;
                    Some(types.name(&id, &namespaces))
                }),
                value_rank: attributes.value_rank.filter(|_| is_variable),
                unit,
                range,
                // CurrentWrite is bit 1 of the access level (OPC 10000-3 §8.57).
                is_writable: is_variable
                    && attributes.access_level.is_some_and(|level| level & 2 != 0),
                has_children: !children[index].is_empty(),
                browse_path: None,
            })
        });
    Ok(nodes.collect())
}

impl Attributes {
    /// Interprets the values of [`ATTRIBUTES`]; `None` for a node that the server does not know.
    fn new(values: &[DataValue]) -> Option<Self> {
        let [name, display, class, description, data_type, rank, access] = values else {
            return None;
        };
        let Variant::Scalar(Scalar::QualifiedName(browse_name)) = &name.value else { return None };
        name.status.is_good().then_some(())?;
        Some(Self {
            browse_name: (**browse_name).clone(),
            display_name: text_of(display),
            node_class: node_class(class)?,
            description: text_of(description),
            data_type: node_id_of(data_type),
            value_rank: int_of(rank).and_then(|rank| i32::try_from(rank).ok()),
            access_level: int_of(access),
        })
    }
}

/// Returns the id unless it is null.
pub(super) fn non_null(id: NodeId) -> Option<NodeId> {
    (!id.is_null()).then_some(id)
}

type UnitAndRange = (Option<UnitName>, Option<(f64, f64)>);

/// Reads unit and range of each node from the properties among its children, in order.
async fn read_properties(
    connection: &Connection,
    children: &[Vec<ReferenceDescription>],
    namespaces: &NamespaceTable,
) -> Result<Vec<UnitAndRange>, ShopFloorError> {
    let property = |children: &[ReferenceDescription], name: &str| {
        let is_named = |child: &&ReferenceDescription| {
            child.browse_name.namespace_index == 0 && child.browse_name.name.as_ref() == name
        };
        children.iter().find(is_named).map(|child| child.node_id.node_id.clone())
    };
    let found: Vec<(usize, NodeId)> = children
        .iter()
        .enumerate()
        .flat_map(|(index, children)| {
            ["EngineeringUnits", "EURange"]
                .into_iter()
                .filter_map(move |name| Some((index, property(children, name)?)))
        })
        .collect();
    let ids: Vec<_> =
        found.iter().map(|(_, id)| ReadValueId::new(id.clone(), AttributeId::Value)).collect();
    let values = read_attributes(connection, &ids, namespaces).await?;
    let mut properties: Vec<UnitAndRange> = vec![(None, None); children.len()];
    for ((index, _), value) in found.into_iter().zip(values) {
        let Some(fields) = structure_of(&value) else { continue };
        let number = |name: &str| fields.get(name).and_then(Variant::as_f64);
        if let (Some(low), Some(high)) = (number("Low"), number("High")) {
            properties[index].1 = Some((low, high));
        } else if let Some(Variant::Scalar(Scalar::LocalizedText(text))) = fields.get("DisplayName")
        {
            let code = number("UnitId").and_then(|id| unit_code(id as i64));
            let display_name = text.text.as_deref().unwrap_or_default().to_owned();
            properties[index].0 = Some(UnitName { display_name, code });
        }
    }
    Ok(properties)
}

fn structure_of(value: &DataValue) -> Option<&IndexMap<Arc<str>, Variant>> {
    match &value.value {
        Variant::Scalar(Scalar::ExtensionObject(object)) => match &object.body {
            ExtensionBody::Structure(structure) => Some(&structure.fields),
            _ => None,
        },
        _ => None,
    }
}

/// Decodes the UNECE code in a unit id (OPC 10000-8 §5.6.4.3): one to three ASCII letters or
/// digits.
fn unit_code(unit_id: i64) -> Option<String> {
    let bytes = u32::try_from(unit_id).ok().filter(|id| *id > 0)?.to_be_bytes();
    let code: Vec<u8> = bytes.into_iter().skip_while(|byte| *byte == 0).collect();
    let is_code = code.len() <= 3 && code.iter().all(u8::is_ascii_alphanumeric);
    is_code.then(|| String::from_utf8_lossy(&code).into_owned())
}

fn node_class(value: &DataValue) -> Option<NodeClass> {
    let class = StackClass::try_from(i32::try_from(int_of(value)?).ok()?).ok()?;
    Some(match class {
        StackClass::Object => NodeClass::Object,
        StackClass::Variable => NodeClass::Variable,
        StackClass::Method => NodeClass::Method,
        StackClass::ObjectType => NodeClass::ObjectType,
        StackClass::VariableType => NodeClass::VariableType,
        StackClass::ReferenceType => NodeClass::ReferenceType,
        StackClass::DataType => NodeClass::DataType,
        StackClass::View => NodeClass::View,
        StackClass::Unspecified => return None,
    })
}

fn int_of(value: &DataValue) -> Option<i128> {
    value.value.as_scalar().and_then(Scalar::as_i128)
}

fn node_id_of(value: &DataValue) -> Option<ModelNodeId> {
    match value.value.as_scalar()? {
        Scalar::NodeId(id) => Some((**id).clone()),
        _ => None,
    }
}

fn text_of(value: &DataValue) -> Option<String> {
    match value.value.as_scalar()? {
        Scalar::LocalizedText(text) => {
            text.text.as_deref().filter(|text| !text.is_empty()).map(str::to_owned)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_ids_decode_to_unece_codes() {
        for (id, code) in
            [(4_408_652, Some("CEL")), (17_476, Some("DD")), (-1, None), (0, None), (1, None)]
        {
            assert_eq!(unit_code(id).as_deref(), code, "{id}");
        }
    }
}
