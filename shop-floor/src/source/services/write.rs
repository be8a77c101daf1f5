//! Write service.

use asi_model::values::{BuiltInType, DataValue, NodeId, StatusCode};
use opcua_stack::{
    opcua::types::{AttributeId, NumericRange, WriteValue},
    values::{ConversionError, node_id_to_stack, status_from_stack, to_stack},
};

use crate::{
    ShopFloorError,
    source::{
        connection::Connection,
        request_size::{check_count, per_request},
    },
};

/// Writes values and returns a status for each, in order.
pub(crate) async fn write(
    connection: &Connection,
    values: &[(NodeId, DataValue)],
) -> Result<Vec<StatusCode>, ShopFloorError> {
    check_count(values.len())?;
    let is_structure =
        |value: &DataValue| value.value.built_in_type() == Some(BuiltInType::ExtensionObject);
    if values.iter().any(|(_, value)| is_structure(value)) {
        connection.load_types().await;
    }
    let namespaces = connection.namespaces();
    let mut statuses = vec![StatusCode::BAD_NODE_ID_UNKNOWN; values.len()];
    let mut writable = Vec::with_capacity(values.len());
    for (index, (node, value)) in values.iter().enumerate() {
        match (node_id_to_stack(node, &namespaces), to_stack(value, &namespaces)) {
            (Ok(node_id), Ok(value)) => {
                let attribute_id = AttributeId::Value as u32;
                let index_range = NumericRange::None;
                writable.push((index, WriteValue { node_id, attribute_id, index_range, value }));
            }
            (Ok(_), Err(error)) => statuses[index] = conversion_status(&error),
            (Err(_), _) => {}
        }
    }
    for chunk in writable.chunks(per_request(connection.limits().nodes_per_write_max)) {
        let requests: Vec<_> = chunk.iter().map(|(_, value)| value.clone()).collect();
        let answers = connection.request(connection.session().write(&requests)).await?;
        for ((index, _), answer) in chunk.iter().zip(answers) {
            statuses[*index] = status_from_stack(answer);
        }
    }
    Ok(statuses)
}

fn conversion_status(error: &ConversionError) -> StatusCode {
    match error {
        ConversionError::StructureMismatch { .. } | ConversionError::InvalidArray => {
            StatusCode::BAD_TYPE_MISMATCH
        }
        _ => StatusCode::BAD_ENCODING_ERROR,
    }
}
