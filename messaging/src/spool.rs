//! Rows that wait to be sent, and the [`SpoolStore`] in whose database they wait. The pure decisions
//! about them are the `spool` crate's, re-exported here.

#[cfg(any(test, feature = "test-support"))]
pub mod memory;

use async_trait::async_trait;

use crate::{address::LogicalAddress, envelope::Envelope};

pub use ::spool::{
    ATTEMPTS_MAX, Backlog, LaneScheduler, NextLane, OverduePolicy, ReceiptEffect, Rejection,
    RejectionAction, Removal, ReplayShare, ReportRow, RowId, RowOutcome, SendOutcome, SequenceGap,
    after_rejection, apply_receipt, coalesce, expire, gaps_of, overdue,
};

/// Cause for which the store could not answer. The link logs the chain, waits and asks again.
pub type SpoolError = Box<dyn std::error::Error + Send + Sync>;

/// A message that waits to be sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SpoolRow {
    pub id: RowId,
    pub address: LogicalAddress,
    /// The message. The link sets `replay` itself.
    pub envelope: Envelope,
    /// Number of times the broker has rejected the message.
    pub attempts: u32,
}

/// Selection of waiting rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Lane {
    /// Control rows, oldest first.
    Control,
    /// The newest report row of each writer within the range, oldest first. A writer is skipped
    /// when a newer row of it has been sent already: this one would arrive behind it.
    Newest,
    /// Report rows, oldest first. Serves the live lane and the replay lane; the range separates
    /// them.
    Reports,
}

/// A query for waiting rows. Rows that are sent, parked or removed are never returned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fetch {
    pub lane: Lane,
    /// Exclusive lower bound.
    pub after: RowId,
    /// Inclusive upper bound; none for no bound.
    pub through: Option<RowId>,
    /// Most rows to return.
    pub limit: usize,
}

/// The rows that wait to be sent, in their owner's database.
///
/// The link remembers the rows in flight and filters them, so a store needs no state *in flight*:
/// after a crash a row that was in flight is simply still waiting. The owner calls
/// [`LinkHandle::wake`](crate::LinkHandle::wake) after it committed new rows and
/// [`LinkHandle::rewind`](crate::LinkHandle::rewind) after it made older rows wait again.
#[async_trait]
pub trait SpoolStore: Send + Sync + 'static {
    /// Returns the waiting rows of a lane within a range, oldest first.
    async fn fetch(&self, fetch: Fetch) -> Result<Vec<SpoolRow>, SpoolError>;

    /// Called when a connection was established, before anything is fetched for it.
    fn connected(&self) {}

    /// Returns whether a row that was fetched some time ago may still be sent. Called right before
    /// it is written to the wire. A row that may not is dropped without an outcome; the store has
    /// to rewind where another row takes its place.
    fn may_leave(&self, _row: &SpoolRow) -> bool {
        true
    }

    /// Returns whether the receiver of a row sends a receipt for it. What has none counts as sent only when its broker
    /// has had the time to store it, where a broker accepts messages before that.
    fn is_receipted(&self, _row: &SpoolRow) -> bool {
        false
    }

    /// Signs a message right before it is written to the wire, after [`Self::may_leave`]; messages
    /// that are not in the spool, too. A store that signs none says so by doing nothing.
    fn sign(&self, envelope: &mut Envelope);

    /// Records outcomes in one transaction. Rows that were removed meanwhile are ignored.
    async fn record(&self, outcomes: Vec<RowOutcome>) -> Result<(), SpoolError>;

    /// Returns the greatest row id so far, whatever the row's state; zero when there was none.
    async fn last_row(&self) -> Result<RowId, SpoolError>;

    /// Counts waiting and sent rows. Called about once a second while something changes: keep it
    /// cheap.
    async fn backlog(&self) -> Result<Backlog, SpoolError>;
}
