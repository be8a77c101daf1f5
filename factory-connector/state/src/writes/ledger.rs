//! Rows of the ledger.

use asi_model::DateTime;
use ledger::{LinkedEntry, Log, SignedHead};

/// Rows of the ledger.
#[derive(Debug, Default, PartialEq)]
pub struct LedgerWrites {
    /// New entries, each with the number of the report it is about.
    pub entries: Vec<(LinkedEntry, Option<i64>)>,
    /// Signed heads of the chains that grew.
    pub heads: Vec<SignedHead>,
    /// Logs that grew or were signed.
    pub logs: Vec<Log>,
    /// Receipts of consents that ended.
    pub revocations: Vec<RevocationRow>,
    pub checkpoint: Option<CheckpointRow>,
}

impl LedgerWrites {
    pub(super) fn merge(&mut self, later: Self) {
        let Self { entries, heads, logs, revocations, checkpoint } = later;
        self.entries.extend(entries);
        self.heads.extend(heads);
        self.logs.extend(logs);
        self.revocations.extend(revocations);
        self.checkpoint = checkpoint.or(self.checkpoint.take());
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
