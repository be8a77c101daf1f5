//! Schemas of types that belong to the shared language, for the API's description only.

use serde::Serialize;
use utoipa::ToSchema;

/// One dynamic data request, addressed through its network and operation.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
#[schema(as = RequestKey)]
pub struct RequestKeySchema {
    /// The network.
    pub operation_network_id: String,
    /// The operation.
    pub operation_id: String,
    /// The request.
    pub dynamic_data_request_id: String,
}

/// One report field, addressed from the network down.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
#[schema(as = FieldKey)]
pub struct FieldKeySchema {
    /// The network.
    pub operation_network_id: String,
    /// The operation.
    pub operation_id: String,
    /// The request.
    pub dynamic_data_request_id: String,
    /// The field.
    pub field_name: String,
}

/// Where a field stands.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[schema(as = MappingState)]
pub enum MappingStateSchema {
    /// Not yet decided.
    Pending,
    /// Values flow.
    Mapped,
    /// No values.
    Refused,
}
