//! Rows about gaps that were announced. A broker may lose the announcement: it is remembered until a
//! receipt covers it.

use asi_model::{
    DateTime,
    messages::{GapCause, WriterReceipt},
};
use spool::SequenceGap;

/// Rows about announced gaps.
#[derive(Debug, Default, PartialEq)]
pub struct GapWrites {
    /// Receipts, each of which settles the gaps that it covers. They are older than what is announced in
    /// the same transaction.
    pub receipts: Vec<WriterReceipt>,
    /// Gaps that are announced, once more where they were before.
    pub announced: Vec<AnnouncedGapRow>,
}

impl GapWrites {
    pub(super) fn merge(&mut self, later: Self) {
        let Self { receipts, announced } = later;
        self.receipts.extend(receipts);
        self.announced.extend(announced);
    }
}

/// Sequence numbers that were announced as given up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AnnouncedGapRow {
    pub gap: SequenceGap,
    pub cause: GapCause,
    /// Time of the last announcement.
    pub announced_at: DateTime,
}
