//! Read, write and call, within the server's limits.

use asi_model::values::{self as model, DataValue, NodeId};
use opcua_stack::{
    opcua::types::{
        AttributeId, CallMethodRequest, NumericRange, ReadValueId, StatusCode, TimestampsToReturn,
        WriteValue,
    },
    values::{
        ConversionError, from_stack, node_id_from_stack, node_id_to_stack, status_from_stack,
        to_stack, variant_from_stack, variant_to_stack,
    },
};

use super::{Connection, connection::per_request, feed::is_undecoded, life::Memory};
use crate::{CallOutcome, ShopFloorError};

/// Most values of one request from a caller.
const VALUES_MAX: usize = 100_000;

pub(crate) async fn read(
    connection: &Connection,
    nodes: &[NodeId],
) -> Result<Vec<DataValue>, ShopFloorError> {
    let values = read_attributes(connection, nodes, AttributeId::Value).await?;
    if values.iter().any(is_undecoded)
        && !connection.are_types_settled()
        && connection.load_types().await
    {
        return read_attributes(connection, nodes, AttributeId::Value).await;
    }
    Ok(values)
}

/// One attribute of many nodes, in order; the failure of a node is the status of its value.
pub(super) async fn read_attributes(
    connection: &Connection,
    nodes: &[NodeId],
    attribute: AttributeId,
) -> Result<Vec<DataValue>, ShopFloorError> {
    check_count(nodes.len())?;
    let namespaces = connection.namespaces();
    let mut values =
        vec![DataValue::status_only(model::StatusCode::BAD_NODE_ID_UNKNOWN, None); nodes.len()];
    let known: Vec<(usize, ReadValueId)> = nodes
        .iter()
        .enumerate()
        .filter_map(|(index, node)| {
            let node = node_id_to_stack(node, &namespaces).ok()?;
            Some((index, ReadValueId::new(node, attribute)))
        })
        .collect();
    for chunk in known.chunks(per_request(connection.limits().nodes_per_read_max)) {
        let ids: Vec<_> = chunk.iter().map(|(_, id)| id.clone()).collect();
        let answers =
            connection.ask(connection.session().read(&ids, TimestampsToReturn::Both, 0.0)).await?;
        for ((index, _), answer) in chunk.iter().zip(answers) {
            values[*index] = from_stack(answer, &namespaces);
        }
    }
    Ok(values)
}

pub(crate) async fn write(
    connection: &Connection,
    values: &[(NodeId, DataValue)],
) -> Result<Vec<model::StatusCode>, ShopFloorError> {
    check_count(values.len())?;
    let mut namespaces = connection.namespaces();
    let has_structure = values
        .iter()
        .any(|(_, value)| value.value.built_in_type() == Some(model::BuiltInType::ExtensionObject));
    if has_structure && connection.load_types().await {
        namespaces = connection.namespaces();
    }
    let mut statuses = vec![model::StatusCode::BAD_NODE_ID_UNKNOWN; values.len()];
    let mut writable = Vec::with_capacity(values.len());
    for (index, (node, value)) in values.iter().enumerate() {
        match (node_id_to_stack(node, &namespaces), to_stack(value, &namespaces)) {
            (Ok(node), Ok(value)) => writable.push((index, write_value(node, value))),
            (Ok(_), Err(error)) => statuses[index] = conversion_status(&error),
            (Err(_), _) => {}
        }
    }
    for chunk in writable.chunks(per_request(connection.limits().nodes_per_write_max)) {
        let requests: Vec<_> = chunk.iter().map(|(_, value)| value.clone()).collect();
        let answers = connection.ask(connection.session().write(&requests)).await?;
        for ((index, _), answer) in chunk.iter().zip(answers) {
            statuses[*index] = status_from_stack(answer);
        }
    }
    Ok(statuses)
}

pub(crate) async fn call(
    connection: &Connection,
    object: &NodeId,
    method: &NodeId,
    inputs: &[model::Variant],
) -> Result<CallOutcome, ShopFloorError> {
    let invalid = |error: ConversionError| ShopFloorError::Invalid(error.to_string());
    let namespaces = connection.namespaces();
    let inputs = inputs
        .iter()
        .map(|input| variant_to_stack(input, &namespaces))
        .collect::<Result<Vec<_>, _>>()
        .map_err(invalid)?;
    let request = CallMethodRequest {
        object_id: node_id_to_stack(object, &namespaces).map_err(invalid)?,
        method_id: node_id_to_stack(method, &namespaces).map_err(invalid)?,
        input_arguments: (!inputs.is_empty()).then_some(inputs),
    };
    let answer = connection.ask(connection.session().call_one(request)).await?;
    let outputs = answer
        .output_arguments
        .unwrap_or_default()
        .into_iter()
        .map(|output| variant_from_stack(output, &namespaces))
        .collect::<Result<Vec<_>, _>>()
        .map_err(invalid)?;
    Ok(CallOutcome { status: status_from_stack(answer.status_code), outputs })
}

/// `2` or `1:3` (OPC 10000-4 §7.27).
pub(crate) fn parse_range(text: &str) -> Option<NumericRange> {
    text.parse().ok().filter(|range| *range != NumericRange::None)
}

fn write_value(
    node_id: opcua_stack::opcua::types::NodeId,
    value: opcua_stack::opcua::types::DataValue,
) -> WriteValue {
    WriteValue {
        node_id,
        attribute_id: AttributeId::Value as u32,
        index_range: NumericRange::None,
        value,
    }
}

fn conversion_status(error: &ConversionError) -> model::StatusCode {
    match error {
        ConversionError::StructureMismatch { .. } | ConversionError::InvalidArray => {
            model::StatusCode::BAD_TYPE_MISMATCH
        }
        _ => model::StatusCode::BAD_ENCODING_ERROR,
    }
}

fn check_count(count: usize) -> Result<(), ShopFloorError> {
    if count > VALUES_MAX {
        return Err(ShopFloorError::LimitReached {
            what: "values in one request",
            limit: VALUES_MAX,
        });
    }
    Ok(())
}

/// True for statuses that say: this node is not there (any more).
pub(super) fn is_gone(status: StatusCode) -> bool {
    matches!(status, StatusCode::BadNodeIdUnknown | StatusCode::BadNodeIdInvalid)
}

/// The values of monitored nodes, those that were found under another id there.
pub(super) async fn read_monitored(
    connection: &Connection,
    nodes: &[NodeId],
    memory: &Memory,
) -> Result<Vec<DataValue>, ShopFloorError> {
    let namespaces = connection.namespaces();
    let nodes: Vec<_> = nodes
        .iter()
        .map(|node| match memory.moved.get(node) {
            Some(moved) => node_id_from_stack(moved, &namespaces),
            None => node.clone(),
        })
        .collect();
    read_attributes(connection, &nodes, AttributeId::Value).await
}
