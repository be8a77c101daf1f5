//! Signed statement of a factory that consents ended.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::{
    DynamicDataRequestId, FactoryId, MessageId, OperationId, OperationNetworkId, OrganisationId,
};

/// Receipt of a revocation as far as it concerns one request, signed by the factory: what had left
/// when the consents ended. The platform passes it on as it is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct SignedRevocation {
    /// Unique per message.
    pub message_id: MessageId,
    pub factory_id: FactoryId,
    pub operation_network_id: OperationNetworkId,
    pub operation_id: OperationId,
    pub dynamic_data_request_id: DynamicDataRequestId,
    /// Organisations that received the values, and receive this.
    pub recipient_list: Vec<OrganisationId>,
    /// The receipt, a JSON document, byte by byte as it was signed.
    pub signed_text: String,
    /// Ed25519 signature over the UTF-8 text, hexadecimal.
    pub signature: String,
    /// Ed25519 key of the factory's ledger that verifies it, hexadecimal.
    pub public_key: String,
}
