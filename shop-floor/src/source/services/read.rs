//! Read service: values and other attributes.

use asi_model::values::{
    DataValue, ExtensionBody, Namespace, NodeId, QualifiedName, Scalar, StatusCode, Variant,
};
use opcua_stack::{
    NamespaceTable,
    opcua::types::{
        AttributeId, NodeId as StackNodeId, ReadValueId, TimestampsToReturn,
        Variant as StackVariant,
    },
    values::{from_stack, node_id_to_stack, qualified_name_from_stack},
};

use crate::{
    ShopFloorError,
    source::{
        connection::Connection,
        request_size::{check_count, per_request},
    },
};

/// Reads the values of nodes, in order; the failure of a node is the status of its value. Loads the
/// server's data types when a structure needs them.
pub(crate) async fn read(
    connection: &Connection,
    nodes: &[NodeId],
) -> Result<Vec<DataValue>, ShopFloorError> {
    let values = read_values(connection, nodes).await?;
    if values.iter().any(is_undecoded)
        && !connection.are_types_settled()
        && connection.load_types().await
    {
        return read_values(connection, nodes).await;
    }
    Ok(values)
}

/// Reads the values of nodes as they can be decoded now.
pub(in crate::source) async fn read_values(
    connection: &Connection,
    nodes: &[NodeId],
) -> Result<Vec<DataValue>, ShopFloorError> {
    check_count(nodes.len())?;
    let namespaces = connection.namespaces();
    let mut values =
        vec![DataValue::status_only(StatusCode::BAD_NODE_ID_UNKNOWN, None); nodes.len()];
    let known: Vec<(usize, ReadValueId)> = nodes
        .iter()
        .enumerate()
        .filter_map(|(index, node)| {
            let node = node_id_to_stack(node, &namespaces).ok()?;
            Some((index, ReadValueId::new(node, AttributeId::Value)))
        })
        .collect();
    for chunk in known.chunks(per_request(connection.limits().nodes_per_read_max)) {
        let ids: Vec<_> = chunk.iter().map(|(_, id)| id.clone()).collect();
        let read = connection.session().read(&ids, TimestampsToReturn::Both, 0.0);
        let answers = connection.request(read).await?;
        for ((index, _), answer) in chunk.iter().zip(answers) {
            values[*index] = from_stack(answer, &namespaces);
        }
    }
    Ok(values)
}

/// Reads attributes without timestamps, in order.
pub(in crate::source) async fn read_attributes(
    connection: &Connection,
    ids: &[ReadValueId],
    namespaces: &NamespaceTable,
) -> Result<Vec<DataValue>, ShopFloorError> {
    let mut values = Vec::with_capacity(ids.len());
    for chunk in ids.chunks(per_request(connection.limits().nodes_per_read_max)) {
        let read = connection.session().read(chunk, TimestampsToReturn::Neither, 0.0);
        let answers = connection.request(read).await?;
        values.extend(answers.into_iter().map(|answer| from_stack(answer, namespaces)));
    }
    values.resize_with(ids.len(), DataValue::default);
    Ok(values)
}

/// Reads the browse names of nodes, in order; `None` for a node that the server does not know.
pub(in crate::source) async fn read_browse_names(
    connection: &Connection,
    nodes: &[StackNodeId],
) -> Result<Vec<Option<QualifiedName>>, ShopFloorError> {
    let namespaces = connection.namespaces();
    let mut names = Vec::with_capacity(nodes.len());
    for chunk in nodes.chunks(per_request(connection.limits().nodes_per_read_max)) {
        let ids: Vec<_> = chunk
            .iter()
            .map(|node| ReadValueId::new(node.clone(), AttributeId::BrowseName))
            .collect();
        let read = connection.session().read(&ids, TimestampsToReturn::Neither, 0.0);
        let answers = connection.request(read).await?;
        names.extend(answers.into_iter().map(|answer| match answer.value {
            Some(StackVariant::QualifiedName(name)) => {
                Some(qualified_name_from_stack(&name, &namespaces))
            }
            _ => None,
        }));
    }
    names.resize(nodes.len(), None);
    Ok(names)
}

/// Returns true for a structure of a server's own type whose fields are not known.
pub(in crate::source) fn is_undecoded(value: &DataValue) -> bool {
    let is_raw = |scalar: &Scalar| match scalar {
        Scalar::ExtensionObject(object) => {
            matches!(object.body, ExtensionBody::Binary(_))
                && object.type_id.node_id.namespace != Namespace::Ua
        }
        _ => false,
    };
    value.status != StatusCode::BAD_DECODING_ERROR
        && match &value.value {
            Variant::Scalar(scalar) => is_raw(scalar),
            Variant::Array(array) => array.elements.first().is_some_and(is_raw),
            Variant::Null => false,
        }
}
