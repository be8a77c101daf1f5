//! What there is to know of nodes: names, types, units, ranges.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use asi_model::values::{
    BuiltInType, DataValue, ExtensionBody, NodeId as ModelNodeId, QualifiedName, Scalar,
    Variant as ModelVariant,
};
use indexmap::IndexMap;
use opcua_stack::{
    NamespaceTable,
    opcua::types::{
        AttributeId, BrowseDescription, BrowseDirection, DataTypeId, NodeClass as StackClass,
        NodeClassMask, NodeId, ReadValueId, ReferenceDescription, ReferenceTypeId,
        TimestampsToReturn,
    },
    values::{from_stack, node_id_from_stack, node_id_to_stack},
};

use super::{Bare, Connection, downward, paths, per_request, references};
use crate::{BrowsePath, BrowsedNode, NodeClass, ShopFloorError, TypeName, UnitName};

/// Longest way up from a data type to a built-in one.
const SUPERTYPES_MAX: usize = 20;
/// Children looked at for properties.
const PROPERTIES_MAX: usize = 200;
/// Attributes read per node in one go.
const ATTRIBUTES: [AttributeId; 7] = [
    AttributeId::BrowseName,
    AttributeId::DisplayName,
    AttributeId::NodeClass,
    AttributeId::Description,
    AttributeId::DataType,
    AttributeId::ValueRank,
    AttributeId::UserAccessLevel,
];

/// Reads what is to know of nodes; leaves out those that are not there.
pub(super) async fn details(
    connection: &Connection,
    bare: Vec<Bare>,
) -> Result<Vec<BrowsedNode>, ShopFloorError> {
    let namespaces = connection.namespaces();
    let ids: Vec<_> = bare
        .iter()
        .flat_map(|bare| ATTRIBUTES.map(|attribute| ReadValueId::new(bare.id.clone(), attribute)))
        .collect();
    let attributes = read_all(connection, &ids, &namespaces).await?;
    let children = references(
        connection,
        bare.iter().map(|bare| downward(bare.id.clone())).collect(),
        PROPERTIES_MAX,
    )
    .await?;
    let properties = properties(connection, &children, &namespaces).await?;
    let types = type_names(connection, &bare, &attributes, &namespaces).await?;
    let built_in = built_in_types(connection, &types, &namespaces).await?;
    let mut nodes = Vec::with_capacity(bare.len());
    for (index, (bare, attributes)) in
        bare.iter().zip(attributes.chunks(ATTRIBUTES.len())).enumerate()
    {
        let [name, display, class, description, data_type, rank, access] = attributes else {
            continue;
        };
        let (Some(ModelVariant::Scalar(Scalar::QualifiedName(name))), Some(node_class)) =
            (name.status.is_good().then_some(&name.value), node_class(class))
        else {
            continue;
        };
        let is_variable = node_class == NodeClass::Variable;
        let data_type = is_variable.then(|| node_id_of(data_type)).flatten();
        let (unit, range) = properties[index].clone();
        let path = BrowsePath(vec![(**name).clone()]);
        nodes.push(BrowsedNode {
            node_id: node_id_from_stack(&bare.id, &namespaces),
            browse_name: path.to_texts().pop().unwrap_or_default(),
            display_name: text_of(display).unwrap_or_else(|| path.to_string()),
            description: text_of(description),
            node_class,
            type_definition: bare
                .type_definition
                .as_ref()
                .map(|id| type_name(&types, id, &namespaces)),
            built_in_type: data_type.as_ref().and_then(|id| built_in.get(id).copied()),
            data_type: data_type.and_then(|id| {
                let id = node_id_to_stack(&id, &namespaces).ok()?;
                Some(type_name(&types, &id, &namespaces))
            }),
            value_rank: is_variable
                .then(|| int_of(rank))
                .flatten()
                .and_then(|rank| i32::try_from(rank).ok()),
            unit,
            range,
            // CurrentWrite is bit 1 of the access level (OPC 10000-3 §8.57).
            is_writable: is_variable && int_of(access).is_some_and(|level| level & 2 != 0),
            has_children: !children[index].is_empty(),
            browse_path: None,
        });
    }
    Ok(nodes)
}

async fn read_all(
    connection: &Connection,
    ids: &[ReadValueId],
    namespaces: &NamespaceTable,
) -> Result<Vec<DataValue>, ShopFloorError> {
    let mut values = Vec::with_capacity(ids.len());
    for chunk in ids.chunks(per_request(connection.limits().nodes_per_read_max)) {
        let answers = connection
            .ask(connection.session().read(chunk, TimestampsToReturn::Neither, 0.0))
            .await?;
        values.extend(answers.into_iter().map(|answer| from_stack(answer, namespaces)));
    }
    values.resize_with(ids.len(), DataValue::default);
    Ok(values)
}

type UnitAndRange = (Option<UnitName>, Option<(f64, f64)>);

/// Unit and range of each node, read from the properties among its children.
async fn properties(
    connection: &Connection,
    children: &[Vec<ReferenceDescription>],
    namespaces: &NamespaceTable,
) -> Result<Vec<UnitAndRange>, ShopFloorError> {
    let property = |children: &[ReferenceDescription], name: &str| {
        let is_wanted = |child: &&ReferenceDescription| {
            child.browse_name.namespace_index == 0 && child.browse_name.name.as_ref() == name
        };
        children.iter().find(is_wanted).map(|child| child.node_id.node_id.clone())
    };
    let asked: Vec<(usize, NodeId)> = children
        .iter()
        .enumerate()
        .flat_map(|(index, children)| {
            ["EngineeringUnits", "EURange"]
                .into_iter()
                .filter_map(move |name| Some((index, property(children, name)?)))
        })
        .collect();
    let ids: Vec<_> =
        asked.iter().map(|(_, id)| ReadValueId::new(id.clone(), AttributeId::Value)).collect();
    let values = read_all(connection, &ids, namespaces).await?;
    let mut found: Vec<UnitAndRange> = vec![(None, None); children.len()];
    for ((index, _), value) in asked.into_iter().zip(values) {
        let Some(fields) = structure_of(&value) else { continue };
        let number = |name: &str| fields.get(name).and_then(ModelVariant::as_f64);
        if let (Some(low), Some(high)) = (number("Low"), number("High")) {
            found[index].1 = Some((low, high));
        } else if let Some(ModelVariant::Scalar(Scalar::LocalizedText(text))) =
            fields.get("DisplayName")
        {
            let code = number("UnitId").and_then(|id| unit_code(id as i64));
            let display_name = text.text.as_deref().unwrap_or_default().to_owned();
            found[index].0 = Some(UnitName { display_name, code });
        }
    }
    Ok(found)
}

fn structure_of(value: &DataValue) -> Option<&IndexMap<Arc<str>, ModelVariant>> {
    match &value.value {
        ModelVariant::Scalar(Scalar::ExtensionObject(object)) => match &object.body {
            ExtensionBody::Structure(structure) => Some(&structure.fields),
            _ => None,
        },
        _ => None,
    }
}

/// The UNECE code that a unit id spells (OPC 10000-8 §5.6.4.3): one to three ASCII letters or
/// digits.
fn unit_code(unit_id: i64) -> Option<String> {
    let bytes = u32::try_from(unit_id).ok().filter(|id| *id > 0)?.to_be_bytes();
    let code: Vec<u8> = bytes.into_iter().skip_while(|byte| *byte == 0).collect();
    let is_code = code.len() <= 3 && code.iter().all(u8::is_ascii_alphanumeric);
    is_code.then(|| String::from_utf8_lossy(&code).into_owned())
}

/// The names of all types that nodes refer to.
async fn type_names(
    connection: &Connection,
    bare: &[Bare],
    attributes: &[DataValue],
    namespaces: &NamespaceTable,
) -> Result<HashMap<NodeId, String>, ShopFloorError> {
    let data_types = attributes.chunks(ATTRIBUTES.len()).filter_map(|attributes| {
        node_id_to_stack(&node_id_of(attributes.get(4)?)?, namespaces).ok()
    });
    let ids: HashSet<NodeId> =
        bare.iter().filter_map(|bare| bare.type_definition.clone()).chain(data_types).collect();
    let ids: Vec<_> = ids.into_iter().collect();
    let names = paths::browse_names(connection, &ids).await?;
    let name = |name: Option<QualifiedName>| name.and_then(|name| name.name).unwrap_or_default();
    Ok(ids.into_iter().zip(names.into_iter().map(|found| name(found).to_string())).collect())
}

fn type_name(
    names: &HashMap<NodeId, String>,
    id: &NodeId,
    namespaces: &NamespaceTable,
) -> TypeName {
    TypeName {
        node_id: node_id_from_stack(id, namespaces),
        name: names.get(id).cloned().unwrap_or_default(),
    }
}

/// The built-in type behind each of some types: found upwards along their supertypes.
async fn built_in_types(
    connection: &Connection,
    types: &HashMap<NodeId, String>,
    namespaces: &NamespaceTable,
) -> Result<HashMap<ModelNodeId, BuiltInType>, ShopFloorError> {
    let mut found = HashMap::new();
    let mut open: Vec<(NodeId, NodeId)> = types.keys().map(|id| (id.clone(), id.clone())).collect();
    for _ in 0..SUPERTYPES_MAX {
        open.retain(|(asked, at)| match built_in(at) {
            Some(built_in) => {
                found.insert(node_id_from_stack(asked, namespaces), built_in);
                false
            }
            None => true,
        });
        if open.is_empty() {
            break;
        }
        let upward = open.iter().map(|(_, at)| BrowseDescription {
            browse_direction: BrowseDirection::Inverse,
            reference_type_id: ReferenceTypeId::HasSubtype.into(),
            include_subtypes: false,
            node_class_mask: NodeClassMask::DATA_TYPE.bits(),
            ..downward(at.clone())
        });
        let answers = references(connection, upward.collect(), 1).await?;
        open = open
            .into_iter()
            .zip(answers)
            .filter_map(|((asked, _), parents)| {
                Some((asked, parents.into_iter().next()?.node_id.node_id))
            })
            .collect();
    }
    Ok(found)
}

/// Ends the way up: a built-in type, or an abstract type of namespace 0 that one carries.
fn built_in(id: &NodeId) -> Option<BuiltInType> {
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
    fn unit_ids_spell_codes() {
        for (id, code) in
            [(4_408_652, Some("CEL")), (17_476, Some("DD")), (-1, None), (0, None), (1, None)]
        {
            assert_eq!(unit_code(id).as_deref(), code, "{id}");
        }
    }
}
