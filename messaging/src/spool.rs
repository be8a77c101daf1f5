//! Messages that wait to be sent: what must hold of a store of them, and the pure decisions about
//! them.
//!
//! Two kinds of owner implement [`SpoolStore`] over their own SQL:
//!
//! - The *connector* keeps a report until the platform has receipted it. After the broker accepted
//!   it, a row is merely *sent*; `receipts` decides which rows may go and which must be sent again.
//! - The *platform* deletes a row when the broker accepted it.
//!
//! A row that waits is in one of two streams. *Control* rows (acknowledgements, decisions, gaps,
//! everything of the platform) travel strictly in their order. *Report* rows belong to a writer;
//! after an outage the newest row of each writer travels first, then the backlog in order, marked
//! as replay, while new rows go on to travel live.

mod coalescing;
mod expiry;
mod lanes;
#[cfg(any(test, feature = "test-support"))]
pub mod memory;
mod receipts;
mod rejections;

use std::fmt;

use async_trait::async_trait;
use serde::{Deserialize, Serialize};
use time::OffsetDateTime;

use crate::{address::LogicalAddress, envelope::Envelope, inbox::Rejection};

pub use coalescing::coalesce;
pub use expiry::expire;
pub use lanes::{LaneScheduler, NextLane, ReplayShare};
pub use receipts::{OverduePolicy, ReceiptEffect, apply_receipt, overdue};
pub use rejections::{ATTEMPTS_MAX, RejectionVerdict, after_rejection};

/// Why the store could not answer. The link logs the chain, waits and asks again.
pub type StoreError = Box<dyn std::error::Error + Send + Sync>;

/// The number of a row, given by the store in the order of insertion and never used again.
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

/// A message that waits to be sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SpoolRow {
    /// Its number.
    pub id: RowId,
    /// Where it goes.
    pub address: LogicalAddress,
    /// What goes. The link sets `replay` itself.
    pub envelope: Envelope,
    /// How often the broker has rejected it.
    pub attempts: u32,
}

/// Which waiting rows to fetch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Lane {
    /// Control rows, oldest first.
    Control,
    /// Of each writer's report rows within the range the newest one, unless a newer one of the
    /// writer has left already: this one would come behind it. Oldest first among these.
    Newest,
    /// Report rows, oldest first. Serves both what is live and what is replayed; the range tells
    /// them apart.
    Reports,
}

/// Asks for waiting rows. Rows that are sent, parked or gone are never returned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fetch {
    /// Which rows.
    pub lane: Lane,
    /// Only rows with a greater number.
    pub after: RowId,
    /// Only rows with at most this number; none for no bound.
    pub through: Option<RowId>,
    /// At most so many rows.
    pub limit: usize,
}

/// What became of a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowOutcome {
    /// The row.
    pub id: RowId,
    /// Its fate.
    pub outcome: SendOutcome,
    /// When it was known.
    pub at: OffsetDateTime,
}

/// The fate of one attempt to send a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SendOutcome {
    /// The broker has stored it. The connector marks a report as sent and removes a control row;
    /// the platform removes.
    Accepted,
    /// The broker rejected it; it stays waiting with one attempt more.
    Rejected(Rejection),
    /// It will not be sent again by itself: the store sets it aside with the reason, visible to
    /// people.
    Parked(Rejection),
    /// Its time to live had passed before it could be sent. The store removes it, announcing the
    /// gap where one arises.
    Expired,
}

/// How much waits, for the link's state and metrics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Backlog {
    /// Rows that wait to be sent.
    pub waiting: u64,
    /// Rows that are sent and wait for the receipt.
    pub sent: u64,
    /// Bytes of both.
    pub bytes: u64,
    /// When the oldest of both was written.
    #[serde(with = "time::serde::rfc3339::option")]
    pub oldest_at: Option<OffsetDateTime>,
}

/// The rows that wait to be sent, in their owner's database.
///
/// The link keeps the numbers of rows in flight and filters them, so a store needs no state *in
/// flight*: after a crash what was in flight is simply still waiting. The owner calls
/// [`LinkHandle::wake`](crate::LinkHandle::wake) after it committed new rows and
/// [`LinkHandle::rewind`](crate::LinkHandle::rewind) after it made older rows wait again.
#[async_trait]
pub trait SpoolStore: Send + Sync + 'static {
    /// The waiting rows of a lane within a range, oldest first.
    async fn fetch(&self, fetch: Fetch) -> Result<Vec<SpoolRow>, StoreError>;

    /// A connection was established; nothing has been fetched for it yet.
    fn connected(&self) {}

    /// Whether a row that was fetched some time ago may still leave, asked right before it is put
    /// on the wire. One that may not is dropped without an outcome; the store has to rewind where
    /// something else stands in its place.
    fn may_leave(&self, _row: &SpoolRow) -> bool {
        true
    }

    /// Records what became of rows, in one transaction. Rows that are gone meanwhile are passed
    /// over.
    async fn record(&self, outcomes: Vec<RowOutcome>) -> Result<(), StoreError>;

    /// The greatest row number so far, whatever its state; zero when there was none.
    async fn last_row(&self) -> Result<RowId, StoreError>;

    /// How much waits. Asked about once a second while something changes: keep it cheap.
    async fn backlog(&self) -> Result<Backlog, StoreError>;
}

/// What the decisions need to know of a report row: never its body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReportRow {
    /// Its number.
    pub id: RowId,
    /// Its writer.
    pub data_set_writer_id: u16,
    /// Its writer's epoch.
    pub epoch: u32,
    /// Its sequence number within the epoch.
    pub sequence: u32,
    /// Its size, in bytes.
    pub bytes: u64,
    /// When it was written.
    pub created_at: OffsetDateTime,
    /// When the broker accepted it last; none while it waits.
    pub sent_at: Option<OffsetDateTime>,
    /// How often it was sent.
    pub sent_count: u32,
}

/// Sequence numbers that will never come: a `gap` to commit with the removal of the rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SequenceGap {
    /// The writer.
    pub data_set_writer_id: u16,
    /// Its epoch.
    pub epoch: u32,
    /// The first that will not come.
    pub first_sequence: u32,
    /// The last that will not come.
    pub last_sequence: u32,
}

/// Rows that go without having been receipted, and what to announce in the same transaction.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Removal {
    /// The rows that go.
    pub rows: Vec<RowId>,
    /// The gaps to announce.
    pub gaps: Vec<SequenceGap>,
    /// Their size, in bytes.
    pub bytes: u64,
}

impl Removal {
    fn of(rows: &[ReportRow]) -> Self {
        Self {
            rows: rows.iter().map(|r| r.id).collect(),
            gaps: gaps_of(rows),
            bytes: rows.iter().map(|r| r.bytes).sum(),
        }
    }
}

/// Joins the rows' sequence numbers into as few gaps as possible, ordered by writer, epoch and
/// sequence.
#[must_use]
pub fn gaps_of(rows: &[ReportRow]) -> Vec<SequenceGap> {
    let mut keys: Vec<_> =
        rows.iter().map(|r| (r.data_set_writer_id, r.epoch, r.sequence)).collect();
    keys.sort_unstable();
    keys.dedup();
    let mut gaps: Vec<SequenceGap> = Vec::new();
    for (data_set_writer_id, epoch, sequence) in keys {
        match gaps.last_mut() {
            Some(gap)
                if gap.data_set_writer_id == data_set_writer_id
                    && gap.epoch == epoch
                    && gap.last_sequence.checked_add(1) == Some(sequence) =>
            {
                gap.last_sequence = sequence;
            }
            _ => gaps.push(SequenceGap {
                data_set_writer_id,
                epoch,
                first_sequence: sequence,
                last_sequence: sequence,
            }),
        }
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn moment() -> OffsetDateTime {
        OffsetDateTime::from_unix_timestamp(1_555_607_910).expect("a time")
    }

    pub(super) fn row(id: i64, data_set_writer_id: u16, sequence: u32) -> ReportRow {
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

    #[test]
    fn neighbours_join_into_one_gap() {
        let rows = [row(1, 7, 3), row(2, 7, 4), row(3, 8, 5), row(4, 7, 6), row(5, 7, 4)];
        let runs: Vec<_> = gaps_of(&rows)
            .into_iter()
            .map(|g| (g.data_set_writer_id, g.first_sequence, g.last_sequence))
            .collect();
        assert_eq!(runs, [(7, 3, 4), (7, 6, 6), (8, 5, 5)]);
    }
}
