//! Tools: partners' programs on the broker.
//!
//! A tool posts `data-request` to `tool.<toolId>.requests`; it becomes a dynamic data request of
//! the tool's organisation in a new revision of the network, as if a planner of that organisation
//! had added it. The answer and the reports the tool is entitled to come on
//! `tool.<toolId>.reports`.

use asi_model::{
    MessageId, OperationId, OperationNetworkId, ToolId,
    messages::{AcknowledgementResult, Fault},
    network::DynamicDataRequest,
};
use serde::{Deserialize, Serialize};

/// A tool asks for data about an operation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct DataRequestMessage {
    pub message_type: String,
    /// Unique per message.
    pub message_id: MessageId,
    /// The tool that asks.
    pub tool_id: ToolId,
    pub operation_network_id: OperationNetworkId,
    /// The operation asked about.
    pub operation_id: OperationId,
    /// Requested data; the requester is the tool's organisation.
    pub dynamic_data_request: DynamicDataRequest,
}

/// Answer to a tool's request: the acknowledgement of the wire contract, with the tool in place of
/// a factory.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ToolAcknowledgement {
    pub message_type: &'static str,
    /// Unique per message.
    pub message_id: MessageId,
    /// The tool that asked.
    pub tool_id: ToolId,
    /// The message answered.
    pub correlation_id: MessageId,
    /// The network it was about.
    pub operation_network_id: OperationNetworkId,
    /// The revision that contains the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub revision: Option<u64>,
    pub result: AcknowledgementResult,
    /// Everything that was wrong.
    pub fault_list: Vec<Fault>,
}

/// Reads a tool's request; on failure code and reason.
///
/// # Errors
/// Code and reason for the dead letter.
pub fn parse_data_request(
    text: &str,
    tool: &ToolId,
) -> Result<DataRequestMessage, (&'static str, String)> {
    let message: DataRequestMessage = serde_json::from_str(text)
        .map_err(|error| ("INVALID_MESSAGE", format!("The message is not valid: {error}.")))?;
    if message.message_type != "data-request" {
        return Err(("INVALID_MESSAGE", "messageType must be data-request.".to_owned()));
    }
    if message.tool_id != *tool {
        let claimed = message.tool_id;
        return Err((
            "FORGED_PUBLISHER",
            format!("The message came from {tool} and claims to be of {claimed}."),
        ));
    }
    Ok(message)
}
