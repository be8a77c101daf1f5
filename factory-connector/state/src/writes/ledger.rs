//! Rows of the ledger.

use asi_model::{DateTime, OrganisationId};
use ledger::{CheckpointSeal, LinkedEntry, Log, SignedHead};

use super::PastDecisionRow;

/// Rows of the ledger.
#[derive(Debug, Default, PartialEq)]
pub struct LedgerWrites {
    /// New entries, each with the number of the report it is about.
    pub entries: Vec<(LinkedEntry, Option<i64>)>,
    /// Signed heads of the chains that grew.
    pub heads: Vec<SignedHead>,
    /// Logs that grew or were signed.
    pub logs: Vec<Log>,
    /// Logs of which the platform countersigned more, or about which it is in conflict.
    pub witnessed: Vec<Log>,
    /// Receipts of consents that ended.
    pub revocations: Vec<RevocationRow>,
    pub checkpoint: Option<CheckpointRow>,
    /// Signed number of the checkpoints.
    pub seal: Option<CheckpointSeal>,
    /// Entries that retention removes.
    pub removed: Vec<RemovedEntries>,
    /// Retention of former versions is stated from now on.
    pub is_former_retention_stated: bool,
    /// Decisions about the past.
    pub past_decisions: Vec<PastDecisionRow>,
}

impl LedgerWrites {
    pub(super) fn merge(&mut self, later: Self) {
        let Self {
            entries,
            heads,
            logs,
            witnessed,
            revocations,
            checkpoint,
            seal,
            removed,
            is_former_retention_stated,
            past_decisions,
        } = later;
        self.entries.extend(entries);
        self.heads.extend(heads);
        self.logs.extend(logs);
        self.witnessed.extend(witnessed);
        self.revocations.extend(revocations);
        self.checkpoint = checkpoint.or(self.checkpoint.take());
        self.seal = seal.or(self.seal.take());
        self.removed.extend(removed);
        self.is_former_retention_stated |= is_former_retention_stated;
        self.past_decisions.extend(past_decisions);
    }
}

/// A signed statement of the heads of all chains.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckpointRow {
    /// Number of the checkpoint, from 1.
    pub number: u64,
    pub recorded_at: DateTime,
    /// The signed text.
    pub content: String,
    /// Ed25519 signature of the text.
    pub signature: [u8; 64],
    /// Ed25519 key that verifies the signature.
    pub public_key: [u8; 32],
}

/// A signed receipt of consents that ended.
#[derive(Debug, Clone, PartialEq)]
pub struct RevocationRow {
    pub revocation_id: String,
    pub revoked_at: DateTime,
    /// The signed text.
    pub content: String,
    /// Ed25519 signature of the text.
    pub signature: [u8; 64],
    /// Ed25519 key that verifies the signature.
    pub public_key: [u8; 32],
}

/// The oldest entries of a chain, which retention removes, with the anchor in their place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RemovedEntries {
    pub anchor: AnchorRow,
    /// Numbers of the reports that they are about.
    pub reports: Vec<i64>,
}

/// A signed statement in place of a chain's oldest entries.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AnchorRow {
    /// Organisation of the chain.
    pub recipient: OrganisationId,
    /// Number of the last entry that is removed.
    pub number: u64,
    pub recorded_at: DateTime,
    /// The signed text.
    pub content: String,
    /// Ed25519 signature of the text.
    pub signature: [u8; 64],
    /// Ed25519 key that verifies the signature.
    pub public_key: [u8; 32],
}
