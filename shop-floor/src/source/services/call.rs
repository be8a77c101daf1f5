//! Call service.

use asi_model::values::{NodeId, Variant};
use opcua_stack::{
    opcua::types::CallMethodRequest,
    values::{
        ConversionError, node_id_to_stack, status_from_stack, variant_from_stack, variant_to_stack,
    },
};

use crate::{ShopFloorError, SourceCallResult, source::connection::Connection};

/// Calls one method of an object.
pub(crate) async fn call(
    connection: &Connection,
    object: &NodeId,
    method: &NodeId,
    inputs: &[Variant],
) -> Result<SourceCallResult, ShopFloorError> {
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
    let answer = connection.request(connection.session().call_one(request)).await?;
    let outputs = answer
        .output_arguments
        .unwrap_or_default()
        .into_iter()
        .map(|output| variant_from_stack(output, &namespaces))
        .collect::<Result<Vec<_>, _>>()
        .map_err(invalid)?;
    Ok(SourceCallResult { status: status_from_stack(answer.status_code), outputs })
}
