//! Parameters in the paths of requests and fields.

use asi_model::{
    DynamicDataRequestId, FieldKey, FieldName, OperationId, OperationNetworkId, RequestKey,
};
use serde::Deserialize;
use utoipa::IntoParams;

/// Path below which the operations on one field are; [`FieldPath`] has its parameters.
pub const FIELD: &str =
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}";

/// Address of a request in a path.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Path)]
pub struct RequestPath {
    operation_network_id: OperationNetworkId,
    operation_id: OperationId,
    dynamic_data_request_id: DynamicDataRequestId,
}

impl RequestPath {
    /// The key of the request.
    pub fn into_key(self) -> RequestKey {
        let Self { operation_network_id, operation_id, dynamic_data_request_id } = self;
        RequestKey { operation_network_id, operation_id, dynamic_data_request_id }
    }
}

/// Address of a field in a path.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Path)]
pub struct FieldPath {
    operation_network_id: OperationNetworkId,
    operation_id: OperationId,
    dynamic_data_request_id: DynamicDataRequestId,
    field_name: FieldName,
}

impl FieldPath {
    /// The key of the field.
    pub fn into_key(self) -> FieldKey {
        let Self { operation_network_id, operation_id, dynamic_data_request_id, field_name } = self;
        let request = RequestKey { operation_network_id, operation_id, dynamic_data_request_id };
        FieldKey { request, field_name }
    }
}
