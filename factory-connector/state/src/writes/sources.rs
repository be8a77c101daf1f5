//! Rows about sources of values.

/// Rows about sources of values.
#[derive(Debug, Default, PartialEq)]
pub struct SourceWrites {
    /// Sources that are new or changed.
    pub put: Vec<SourceRow>,
    /// Ids of sources that are removed.
    pub removed: Vec<String>,
}

impl SourceWrites {
    pub(super) fn merge(&mut self, later: Self) {
        let Self { put, removed } = later;
        // Rows are put before others are removed, so that of both about one source the later holds.
        self.put.retain(|row| !removed.contains(&row.source_id));
        self.removed.retain(|id| put.iter().all(|row| row.source_id != *id));
        self.put.extend(put);
        self.removed.extend(removed);
    }
}

/// A source of values.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceRow {
    pub source_id: String,
    /// The configuration as JSON, without the password.
    pub config: String,
    /// Password, sealed by the connector for this source alone.
    pub sealed_password: Option<String>,
}
