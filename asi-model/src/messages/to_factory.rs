//! Messages from the platform to a factory.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{asset::AssetRequest, comment::Comment, lease::Lease, ledger::LedgerCosignature};
use crate::{
    ids::{CollaborationId, FactoryId, MessageId, OperationNetworkId},
    network::OperationNetwork,
};

/// Any message from the platform to a factory, told apart by `messageType`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(tag = "messageType", rename_all = "kebab-case")]
pub enum PlatformMessage {
    /// The factory's part of a network, in one revision.
    OperationNetwork(OperationNetworkMessage),
    /// A whole network is withdrawn.
    Withdraw(Withdraw),
    /// A comment by a person.
    Comment(Comment),
    /// A request for an asset's status.
    AssetRequest(AssetRequest),
    /// Confirmation of stored reports.
    Receipt(Receipt),
    /// The holder of the lease.
    Lease(Lease),
    /// Answer to a checkpoint of the ledger.
    LedgerCosignature(LedgerCosignature),
}

impl PlatformMessage {
    /// The wire name of the message type, also the AMQP subject.
    #[must_use]
    pub const fn message_type(&self) -> &'static str {
        match self {
            Self::OperationNetwork(_) => "operation-network",
            Self::Withdraw(_) => "withdraw",
            Self::Comment(_) => "comment",
            Self::AssetRequest(_) => "asset-request",
            Self::Receipt(_) => "receipt",
            Self::Lease(_) => "lease",
            Self::LedgerCosignature(_) => "ledger-cosignature",
        }
    }

    /// The message's id.
    #[must_use]
    pub const fn message_id(&self) -> &MessageId {
        match self {
            Self::OperationNetwork(m) => &m.message_id,
            Self::Withdraw(m) => &m.message_id,
            Self::Comment(m) => &m.message_id,
            Self::AssetRequest(m) => &m.message_id,
            Self::Receipt(m) => &m.message_id,
            Self::Lease(m) => &m.message_id,
            Self::LedgerCosignature(m) => &m.message_id,
        }
    }
}

/// The whole part of a network that concerns the factory. A higher revision replaces a lower one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct OperationNetworkMessage {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory it is for.
    pub factory_id: FactoryId,
    /// The collaboration it belongs to.
    pub collaboration_id: CollaborationId,
    /// Counts up with every change.
    pub revision: u64,
    pub operation_network: OperationNetwork,
}

/// Ends a whole network; its revision stays as a tombstone.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Withdraw {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory it is for.
    pub factory_id: FactoryId,
    /// The network that ends.
    pub operation_network_id: OperationNetworkId,
    /// The revision of the withdrawal itself: higher than any before.
    pub revision: u64,
}

/// Confirmation of the reports that the platform has stored. The connector keeps a report until its
/// receipt.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Receipt {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory it is for.
    pub factory_id: FactoryId,
    /// One entry per writer and epoch with changes since the last receipt.
    pub receipt_list: Vec<WriterReceipt>,
}

/// Stored reports of one writer within one epoch.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct WriterReceipt {
    pub data_set_writer_id: u16,
    /// Its epoch (MajorVersion).
    pub epoch: u32,
    /// The highest sequence number seen; all up to it are held but for the missing ones.
    pub through_sequence: u32,
    /// Sequence numbers below it that never came and were not announced as gaps.
    #[serde(default)]
    pub missing_list: Vec<u32>,
}
