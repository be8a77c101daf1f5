//! Rows as the decisions see them: numbers and times, never a body.

use std::fmt;

use serde::{Deserialize, Serialize};
use time::OffsetDateTime;

/// Number of a row, assigned by the store in the order of insertion and never used again.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct RowId(pub i64);

impl fmt::Display for RowId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Waiting report without its body: all that decisions about the spool need.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReportRow {
    pub id: RowId,
    pub data_set_writer_id: u16,
    /// The writer's epoch; sequence numbers restart with each.
    pub epoch: u32,
    /// The sequence number within the epoch.
    pub sequence: u32,
    /// Size of the body, in bytes.
    pub bytes: u64,
    pub created_at: OffsetDateTime,
    /// Time of the broker's last acceptance; none while the row waits.
    pub sent_at: Option<OffsetDateTime>,
    /// Number of times the row was sent.
    pub sent_count: u32,
}

#[cfg(test)]
pub(crate) mod fixtures {
    use super::*;

    pub(crate) fn moment() -> OffsetDateTime {
        OffsetDateTime::from_unix_timestamp(1_555_607_910).expect("a time")
    }

    /// A waiting row of 100 bytes in epoch 1.
    pub(crate) fn row(id: i64, data_set_writer_id: u16, sequence: u32) -> ReportRow {
        ReportRow {
            id: RowId(id),
            data_set_writer_id,
            epoch: 1,
            sequence,
            bytes: 100,
            created_at: moment(),
            sent_at: None,
            sent_count: 0,
        }
    }
}
