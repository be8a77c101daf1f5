//! Comments on networks, requests and fields, which go both ways.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::{DynamicDataRequestId, FactoryId, FieldName, MessageId, OperationNetworkId};

/// A remark on a network, a request or a field; goes both ways.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct Comment {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory that takes part in the talk.
    pub factory_id: FactoryId,
    /// The network talked about.
    pub operation_network_id: OperationNetworkId,
    /// The request talked about, if one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dynamic_data_request_id: Option<DynamicDataRequestId>,
    /// The field talked about, if one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field_name: Option<FieldName>,
    /// Who says it.
    pub author_id: String,
    /// What is said.
    pub text: String,
}
