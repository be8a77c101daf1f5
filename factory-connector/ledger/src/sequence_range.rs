//! Ranges of sequence numbers.

use serde::{Deserialize, Serialize};

/// Sequence numbers of one writer and epoch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SequenceRange {
    pub data_set_writer_id: u16,
    pub epoch: u32,
    pub first_sequence: u32,
    pub last_sequence: u32,
}
