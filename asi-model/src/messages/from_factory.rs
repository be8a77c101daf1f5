//! Messages from a factory to the platform, besides reports.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    asset::{AssetKind, AssetOffer},
    comment::Comment,
    disclosure::DisclosureStatement,
    lease::LeaseRequest,
    ledger::LedgerCheckpoint,
    past_release::PastRelease,
    revocation::SignedRevocation,
};
use crate::{
    ids::{
        AssetId, DynamicDataRequestId, FactoryId, FieldName, MessageId, OperationId,
        OperationNetworkId,
    },
    values::DateTime,
};

/// Any message from a factory besides reports, told apart by `messageType`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(tag = "messageType", rename_all = "kebab-case")]
pub enum FactoryMessage {
    /// The result of a message of the platform.
    Acknowledgement(Acknowledgement),
    /// A decision of the factory's engineer on a field or an asset's data set.
    Decision(Decision),
    /// Sequence numbers that will never come.
    Gap(Gap),
    /// A comment by a person.
    Comment(Comment),
    /// Status data sets that could be asked for.
    AssetOffer(AssetOffer),
    /// A running connector asks for the lease.
    LeaseRequest(LeaseRequest),
    /// The signed receipt of a revocation.
    Revocation(SignedRevocation),
    /// A checkpoint of the ledger, to be countersigned.
    LedgerCheckpoint(LedgerCheckpoint),
    /// Reports of the past are shown to one more recipient.
    PastRelease(PastRelease),
    /// The connector asks which of its reports the platform holds.
    ReceiptRequest(ReceiptRequest),
}

impl FactoryMessage {
    /// The wire name of the message type, also the AMQP subject.
    #[must_use]
    pub const fn message_type(&self) -> &'static str {
        match self {
            Self::Acknowledgement(_) => "acknowledgement",
            Self::Decision(_) => "decision",
            Self::Gap(_) => "gap",
            Self::Comment(_) => "comment",
            Self::AssetOffer(_) => "asset-offer",
            Self::LeaseRequest(_) => "lease-request",
            Self::Revocation(_) => "revocation",
            Self::LedgerCheckpoint(_) => "ledger-checkpoint",
            Self::PastRelease(_) => "past-release",
            Self::ReceiptRequest(_) => "receipt-request",
        }
    }

    /// The message's id.
    #[must_use]
    pub const fn message_id(&self) -> &MessageId {
        match self {
            Self::Acknowledgement(m) => &m.message_id,
            Self::Decision(m) => &m.message_id,
            Self::Gap(m) => &m.message_id,
            Self::Comment(m) => &m.message_id,
            Self::AssetOffer(m) => &m.message_id,
            Self::LeaseRequest(m) => &m.message_id,
            Self::Revocation(m) => &m.message_id,
            Self::LedgerCheckpoint(m) => &m.message_id,
            Self::PastRelease(m) => &m.message_id,
            Self::ReceiptRequest(m) => &m.message_id,
        }
    }

    /// The factory that the message claims to be of.
    #[must_use]
    pub const fn factory_id(&self) -> &FactoryId {
        match self {
            Self::Acknowledgement(m) => &m.factory_id,
            Self::Decision(m) => &m.factory_id,
            Self::Gap(m) => &m.factory_id,
            Self::Comment(m) => &m.factory_id,
            Self::AssetOffer(m) => &m.factory_id,
            Self::LeaseRequest(m) => &m.factory_id,
            Self::Revocation(m) => &m.factory_id,
            Self::LedgerCheckpoint(m) => &m.factory_id,
            Self::PastRelease(m) => &m.factory_id,
            Self::ReceiptRequest(m) => &m.factory_id,
        }
    }
}

/// Fault of a message that a partner can mend.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Fault {
    /// JSON pointer (RFC 6901) into the message; empty for the whole.
    pub pointer: String,
    /// A stable code, as `UNKNOWN_OPERATION`.
    pub code: String,
    /// A sentence that says what is wrong and what to do.
    pub message: String,
}

/// The result of a message of the platform. A rejected message changes nothing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Acknowledgement {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory that answers.
    pub factory_id: FactoryId,
    /// The message answered; the transport's message id where the body could not be parsed.
    pub correlation_id: MessageId,
    /// The network it was about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operation_network_id: Option<OperationNetworkId>,
    /// The revision it was about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub revision: Option<u64>,
    pub result: AcknowledgementResult,
    /// Everything that was wrong; empty unless rejected.
    #[serde(default)]
    pub fault_list: Vec<Fault>,
}

/// The outcome of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum AcknowledgementResult {
    /// The message is in effect.
    Accepted,
    /// A repetition, without anything new.
    Unchanged,
    /// Wrong; nothing was changed.
    Rejected,
}

/// State of a field's decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum MappingState {
    /// Undecided so far.
    #[default]
    Pending,
    /// Decided: values flow from the named source.
    Mapped,
    /// Decided: no values.
    Refused,
}

/// Source of a mapped field's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum ValueSource {
    /// A mapping from local OPC UA data.
    Mapping,
    /// People on the operator's page.
    Manual,
    /// OPC UA clients that write the node.
    External,
}

/// Subject of a decision.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(untagged, rename_all_fields = "camelCase")]
pub enum DecisionTarget {
    /// A report field.
    #[cfg_attr(feature = "openapi", schema(rename_all = "camelCase"))]
    Field {
        operation_network_id: OperationNetworkId,
        operation_id: OperationId,
        dynamic_data_request_id: DynamicDataRequestId,
        field_name: FieldName,
    },
    /// A status data set of an asset.
    #[cfg_attr(feature = "openapi", schema(rename_all = "camelCase"))]
    Asset {
        asset_id: AssetId,
        /// The data set.
        kind: AssetKind,
    },
}

/// A decision of the factory's engineer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Decision {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory that decided.
    pub factory_id: FactoryId,
    #[serde(flatten)]
    pub target: DecisionTarget,
    pub mapping_state: MappingState,
    /// Reason in words for the partner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Time of the decision, by the connector's clock.
    pub decided_at: DateTime,
    /// The precision the partner gets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disclosure: Option<Box<DisclosureStatement>>,
}

/// Sequence numbers that will never come, committed with their deletion.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct Gap {
    /// Unique per message.
    pub message_id: MessageId,
    pub factory_id: FactoryId,
    pub data_set_writer_id: u16,
    /// Its epoch (MajorVersion).
    pub epoch: u32,
    /// The first that will not come.
    pub first_sequence: u32,
    /// The last that will not come.
    pub last_sequence: u32,
    pub cause: GapCause,
}

/// Reason for sequence numbers that will never come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum GapCause {
    /// The spool was full and retained only newer values.
    Coalesced,
    /// The values were older than the spool retains them.
    Expired,
    /// The request was withdrawn.
    Withdrawn,
    /// The engineer revoked the consent.
    Revoked,
}

/// Question which of these writers' reports the platform holds, answered with a receipt.
///
/// A report that was sent and whose consent ended since is not sent again, and neither is a gap that was
/// announced: where a broker loses the receipt, or the announcement, nothing else would prompt the
/// platform.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct ReceiptRequest {
    /// Unique per message.
    pub message_id: MessageId,
    pub factory_id: FactoryId,
    /// The writers, at most 500.
    pub writer_list: Vec<WriterSequences>,
}

/// Sequence numbers that a writer has given in an epoch. Those of them that the platform neither holds
/// nor has been announced as a gap are missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct WriterSequences {
    pub data_set_writer_id: u16,
    /// Its epoch (MajorVersion).
    pub epoch: u32,
    /// The last number that is asked about; the first is zero.
    pub through_sequence: u32,
}
