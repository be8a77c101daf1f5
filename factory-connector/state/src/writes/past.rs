//! Rows about decisions on the past.

use asi_model::{DateTime, OrganisationId, RequestKey};

/// A decision whether a recipient that was added later sees what had left before.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PastDecisionRow {
    pub request: RequestKey,
    pub recipient: OrganisationId,
    /// Shown (true), or not.
    pub is_released: bool,
    /// Number of the newest report that was decided about.
    pub through_report: i64,
    /// Number of reports that are shown.
    pub report_count: u64,
    /// Root over all of them, hexadecimal; `None` where none is shown.
    pub root: Option<String>,
    pub reason: Option<String>,
    /// Name of the user.
    pub decided_by: String,
    pub decided_at: DateTime,
}
