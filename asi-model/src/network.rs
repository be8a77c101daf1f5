//! Operation networks: operations in their order, with the data that partners request.
//!
//! These are the wire types of `operation-network` and the types that the rest of the workspace
//! works with. Structure is guaranteed by the types; meaning (unique ids, known relations, no
//! cycles, ...) by the validation.

mod operation;
mod relation;
mod request;

pub use operation::{EquipmentRequirement, Operation, OperationKind, OperationState};
pub use relation::{
    ConditionKind, IsoDuration, OperationRelation, RelationCondition, RelationType,
};
#[cfg(feature = "openapi")]
pub(crate) use request::SEMANTIC_IRI_PATTERN;
pub use request::{
    DynamicDataRequest, FieldType, ReportDataFormat, ReportField, Semantic, UpdateFrequencyUnit,
    VALUE_RANK_ARRAY, VALUE_RANK_SCALAR,
};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::{FieldKey, OperationNetworkId, RequestKey};

/// A network of operations, or the part of it that concerns one factory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct OperationNetwork {
    /// Unique on a platform.
    pub operation_network_id: OperationNetworkId,
    /// Name for people, at most 256 characters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// More about it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The operations, stubs of neighbours included.
    pub operation_list: Vec<Operation>,
    /// The relations between them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub operation_relation_list: Vec<OperationRelation>,
}

impl OperationNetwork {
    /// Every dynamic data request with its key and operation, in document order.
    pub fn requests(&self) -> impl Iterator<Item = (RequestKey, &Operation, &DynamicDataRequest)> {
        self.operation_list.iter().flat_map(move |operation| {
            operation.dynamic_data_request_list.iter().map(move |request| {
                let key = RequestKey {
                    operation_network_id: self.operation_network_id.clone(),
                    operation_id: operation.operation_id.clone(),
                    dynamic_data_request_id: request.dynamic_data_request_id.clone(),
                };
                (key, operation, request)
            })
        })
    }

    /// Every requested report field with its key, in document order.
    pub fn fields(&self) -> impl Iterator<Item = (FieldKey, &DynamicDataRequest, &ReportField)> {
        self.requests().flat_map(|(key, _, request)| {
            request
                .report_data_format
                .report_field_list
                .iter()
                .map(move |field| (key.field(field.name.clone()), request, field))
        })
    }
}
