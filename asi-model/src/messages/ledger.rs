//! Witness of a ledger: the platform countersigns the checkpoints of a factory's logs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ids::{FactoryId, MessageId, OrganisationId};

/// Returns the origin (C2SP tlog-checkpoint) of the log of what a factory discloses to an
/// organisation: its name among all logs. All ids have letters, digits, `_` and `-` only. `epoch`
/// counts the logs that replaced each other, from 1.
#[must_use]
pub fn ledger_log_origin(factory: &FactoryId, recipient: &OrganisationId, epoch: u32) -> String {
    match epoch {
        0 | 1 => format!("{factory}/to/{recipient}"),
        later => format!("{factory}/to/{recipient}/{later}"),
    }
}

/// A checkpoint of the log of what the factory discloses to one organisation. The platform answers
/// with a [`LedgerCosignature`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct LedgerCheckpoint {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory of the log.
    pub factory_id: FactoryId,
    /// The organisation whose values the log is about.
    pub recipient_id: OrganisationId,
    /// Number of the log among those that replaced each other, from 1.
    pub epoch: u32,
    /// The key of the log, as in C2SP signed-note: name, id and key. The first one is pinned.
    pub verifier_key: String,
    /// The checkpoint with its consistency proof: the body of `add-checkpoint`, C2SP tlog-witness.
    pub add_checkpoint: String,
}

/// The platform's answer to a checkpoint.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct LedgerCosignature {
    /// Unique per message.
    pub message_id: MessageId,
    /// The factory it is for.
    pub factory_id: FactoryId,
    /// The message answered.
    pub correlation_id: MessageId,
    /// The organisation whose values the log is about.
    pub recipient_id: OrganisationId,
    /// Number of the log that the platform holds last; that of the message where it holds none.
    pub epoch: u32,
    pub result: LedgerCheckpointResult,
    /// The newest checkpoint that the platform holds, signed by log and platform (C2SP signed-note);
    /// absent where it holds none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checkpoint: Option<String>,
    /// The platform's key as a witness, as in C2SP signed-note: name, id and key.
    pub witness_key: String,
}

/// Result of a checkpoint at its witness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum LedgerCheckpointResult {
    /// Countersigned, and the newest one now.
    Cosigned,
    /// Without a countersignature: its proof does not begin at the newest checkpoint that the
    /// platform holds.
    Stale,
    /// Refused: the log is not an extension of the one that the platform holds.
    Inconsistent,
    /// Refused: another key signed the log before.
    OtherKey,
}
