//! Comments on networks, requests and fields, which go both ways.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::{DynamicDataRequestId, FactoryId, FieldName, MessageId, OperationNetworkId};

/// A comment on a network, a request or a field, in either direction.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Comment {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory that sends or receives the comment.
    pub factory_id: FactoryId,
    /// The network commented on.
    pub operation_network_id: OperationNetworkId,
    /// The request commented on, if one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dynamic_data_request_id: Option<DynamicDataRequestId>,
    /// The field commented on, if one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field_name: Option<FieldName>,
    /// The author's name in their own organisation, at most 256 characters.
    pub author_id: String,
    /// The comment, 1 to 8192 characters.
    pub text: String,
}
