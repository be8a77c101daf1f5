//! Stored records that a verification compares with the entries.

use std::collections::{HashMap, HashSet};

use super::StoredLog;
use crate::Hash;

/// A signed text with the columns beside it.
#[derive(Debug, Clone, Default)]
pub struct StoredStatement {
    /// Name or number in the column, which the text repeats.
    pub name: String,
    /// Time in the column, in microseconds since 1970.
    pub recorded_at: i64,
    /// The signed text.
    pub content: Vec<u8>,
    pub signature: Vec<u8>,
    pub public_key: Vec<u8>,
}

/// A chain's signed head as stored.
#[derive(Debug, Clone, Default)]
pub struct StoredHead {
    /// Organisation of the chain.
    pub recipient: String,
    /// Number of its last entry.
    pub number: i64,
    /// Hash of its last entry.
    pub hash: Vec<u8>,
    pub signature: Vec<u8>,
    pub public_key: Vec<u8>,
}

/// The signed number of the checkpoints as stored.
#[derive(Debug, Clone, Default)]
pub struct StoredSeal {
    pub number: i64,
    pub signature: Vec<u8>,
    pub public_key: Vec<u8>,
}

/// A consent in its own table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredConsent {
    /// `PENDING`, `MAPPED` or `REFUSED`.
    pub mapping_state: String,
    pub value_source: Option<String>,
    /// The policy as JSON.
    pub policy: String,
    pub decided_by: Option<String>,
    /// Time of the decision, in microseconds since 1970.
    pub decided_at: i64,
    /// Basis of the decision, as JSON.
    pub basis: Option<String>,
}

/// The signed records beside the entries, and the consents.
#[derive(Debug, Default)]
pub struct Surroundings {
    pub factory_id: String,
    /// The public key of all signatures; without it, any single key is accepted.
    pub trusted_key: Option<Hash>,
    /// Anchors in place of pruned entries.
    pub anchors: Vec<StoredStatement>,
    /// The daily checkpoints, in order.
    pub checkpoints: Vec<StoredStatement>,
    /// Their signed number.
    pub seal: Option<StoredSeal>,
    /// Receipts of ended consents.
    pub revocations: Vec<StoredStatement>,
    /// The signed heads.
    pub heads: Vec<StoredHead>,
    /// The logs of the chains.
    pub logs: Vec<StoredLog>,
    /// Checkpoints of logs that were kept elsewhere, as signed notes.
    pub kept_checkpoints: Vec<String>,
    /// The consents by field and number.
    pub consents: HashMap<(String, u32), StoredConsent>,
    /// Hashes of the previews whose stored texts have them.
    pub previews: HashSet<String>,
}
