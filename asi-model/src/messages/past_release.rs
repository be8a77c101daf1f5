//! Release of the past: reports that had left for others are shown to one more recipient.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    ids::{
        DynamicDataRequestId, FactoryId, MessageId, OperationId, OperationNetworkId, OrganisationId,
    },
    values::DateTime,
};

/// Decision of the factory's engineer that a recipient of a request sees reports, too, which had
/// left before it was one. It cannot be taken back.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct PastRelease {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory that decided, and whose reports these are.
    pub factory_id: FactoryId,
    /// The network of the request.
    pub operation_network_id: OperationNetworkId,
    /// The operation that the request is about.
    pub operation_id: OperationId,
    /// The request that the reports answer.
    pub dynamic_data_request_id: DynamicDataRequestId,
    /// The recipient that sees them from now on.
    pub recipient_id: OrganisationId,
    /// Time of the decision, by the connector's clock.
    pub decided_at: DateTime,
    /// The reports, at most 500 ranges. A decision about more has several messages.
    pub range_list: Vec<ReportRange>,
}

/// Reports of one writer and epoch with neighbouring sequence numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct ReportRange {
    pub data_set_writer_id: u16,
    /// Its epoch (MajorVersion).
    pub epoch: u32,
    /// The first report.
    pub first_sequence: u32,
    /// The last report, not before the first.
    pub last_sequence: u32,
}
