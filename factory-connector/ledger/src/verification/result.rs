//! Result of a verification.

use serde::Serialize;

/// A difference from what was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LedgerFault {
    /// Organisation of the chain; empty when no single chain is affected.
    pub recipient: String,
    /// Number of the entry or checkpoint.
    pub number: u64,
    /// Description of the fault.
    pub message: String,
}

/// Result of a verification.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Verification {
    /// Number of verified entries.
    pub entries: u64,
    /// Number of entries that were compared with the values that they commit to.
    pub values_compared: u64,
    /// Number of entries whose values retention has emptied.
    pub values_emptied: u64,
    /// Number of entries that retention has removed, by the signed anchors.
    pub entries_pruned: u64,
    /// Number of verified checkpoints.
    pub checkpoints: u64,
    /// Number of verified receipts of ended consents.
    pub revocations: u64,
    /// The public key of all signatures, hexadecimal; to be compared with a copy outside of the
    /// connector.
    pub public_key: Option<String>,
    /// Number of all faults.
    pub fault_count: u64,
    /// The first hundred faults.
    pub fault_list: Vec<LedgerFault>,
}

impl Verification {
    /// Returns whether there is no fault.
    #[must_use]
    pub const fn is_intact(&self) -> bool {
        self.fault_count == 0
    }
}
