//! A spool in memory, for tests only: behaves as an owner's store must, but does not survive the
//! process.

use std::collections::BTreeMap;

use async_trait::async_trait;
use parking_lot::Mutex;
use time::OffsetDateTime;

use super::{
    Backlog, Fetch, Lane, Rejection, RowId, RowOutcome, SendOutcome, SpoolError, SpoolRow,
    SpoolStore,
};
use crate::{address::LogicalAddress, clock, envelope::Envelope};

/// Treatment of an accepted report by a [`MemorySpool`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AcceptedReports {
    /// Removes the row, as the platform does.
    Leave,
    /// Keeps the row as *sent*, as the connector does.
    WaitForReceipt,
}

#[derive(Debug, Clone)]
struct Row {
    row: SpoolRow,
    writer: Option<u16>,
    state: RowState,
    created_at: OffsetDateTime,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum RowState {
    Waiting,
    Sent,
    Parked(Rejection),
}

/// Rows without a store: they are gone with the process.
#[derive(Debug)]
pub struct MemorySpool {
    accepted_reports: AcceptedReports,
    rows: Mutex<(i64, BTreeMap<RowId, Row>)>,
}

impl MemorySpool {
    /// Creates an empty spool.
    #[must_use]
    pub fn new(accepted_reports: AcceptedReports) -> Self {
        Self { accepted_reports, rows: Mutex::new((0, BTreeMap::new())) }
    }

    /// Adds a control row.
    pub fn push(&self, address: LogicalAddress, envelope: Envelope) -> RowId {
        self.insert(address, envelope, None)
    }

    /// Adds a report row of a writer.
    pub fn push_report(&self, address: LogicalAddress, envelope: Envelope, writer: u16) -> RowId {
        self.insert(address, envelope, Some(writer))
    }

    /// Returns the number of waiting rows.
    #[must_use]
    pub fn waiting(&self) -> usize {
        self.count(|state| *state == RowState::Waiting)
    }

    /// Returns the number of rows that are sent and wait for a receipt.
    #[must_use]
    pub fn sent(&self) -> usize {
        self.count(|state| *state == RowState::Sent)
    }

    /// Returns the parked rows, with the reason.
    #[must_use]
    pub fn parked(&self) -> Vec<(RowId, Rejection)> {
        let rows = self.rows.lock();
        rows.1
            .iter()
            .filter_map(|(id, row)| match &row.state {
                RowState::Parked(rejection) => Some((*id, rejection.clone())),
                _ => None,
            })
            .collect()
    }

    /// Makes sent rows wait again, as a receipt that misses them does.
    pub fn make_wait(&self, ids: &[RowId]) {
        let mut rows = self.rows.lock();
        for id in ids {
            if let Some(row) = rows.1.get_mut(id) {
                row.state = RowState::Waiting;
            }
        }
    }

    fn count(&self, predicate: impl Fn(&RowState) -> bool) -> usize {
        self.rows.lock().1.values().filter(|r| predicate(&r.state)).count()
    }

    fn insert(&self, address: LogicalAddress, envelope: Envelope, writer: Option<u16>) -> RowId {
        let mut rows = self.rows.lock();
        rows.0 += 1;
        let id = RowId(rows.0);
        let row = SpoolRow { id, address, envelope, attempts: 0 };
        rows.1.insert(id, Row { row, writer, state: RowState::Waiting, created_at: clock::now() });
        id
    }
}

#[async_trait]
impl SpoolStore for MemorySpool {
    fn sign(&self, _: &mut Envelope) {}

    async fn fetch(&self, fetch: Fetch) -> Result<Vec<SpoolRow>, SpoolError> {
        let rows = self.rows.lock();
        let from = RowId(fetch.after.0 + 1);
        let in_range = rows.1.range(from..).map(|(_, row)| row).filter(|r| {
            r.state == RowState::Waiting
                && fetch.through.is_none_or(|through| r.row.id <= through)
                && r.writer.is_none() == (fetch.lane == Lane::Control)
        });
        if fetch.lane != Lane::Newest {
            return Ok(in_range.take(fetch.limit).map(|r| r.row.clone()).collect());
        }
        let all_waiting = rows.1.values().filter(|r| {
            r.state == RowState::Waiting && fetch.through.is_none_or(|through| r.row.id <= through)
        });
        let newest: BTreeMap<_, _> =
            all_waiting.filter_map(|r| Some((r.writer?, r.row.id))).collect();
        let sent = rows.1.values().filter(|r| r.state != RowState::Waiting);
        let newest_sent: BTreeMap<_, _> =
            sent.filter_map(|r| Some((r.writer?, r.row.id))).collect();
        Ok(in_range
            .filter(|r| r.writer.is_some_and(|w| newest.get(&w) == Some(&r.row.id)))
            .filter(|r| r.writer.is_some_and(|w| newest_sent.get(&w) < Some(&r.row.id)))
            .take(fetch.limit)
            .map(|r| r.row.clone())
            .collect())
    }

    async fn record(&self, outcomes: Vec<RowOutcome>) -> Result<(), SpoolError> {
        let mut rows = self.rows.lock();
        for outcome in outcomes {
            let Some(row) = rows.1.get_mut(&outcome.id) else { continue };
            match outcome.outcome {
                SendOutcome::Accepted
                    if row.writer.is_some()
                        && self.accepted_reports == AcceptedReports::WaitForReceipt =>
                {
                    row.state = RowState::Sent;
                }
                SendOutcome::Accepted | SendOutcome::Expired => {
                    rows.1.remove(&outcome.id);
                }
                SendOutcome::Rejected(_) => row.row.attempts += 1,
                SendOutcome::Parked(rejection) => row.state = RowState::Parked(rejection),
            }
        }
        Ok(())
    }

    async fn last_row(&self) -> Result<RowId, SpoolError> {
        Ok(RowId(self.rows.lock().0))
    }

    async fn backlog(&self) -> Result<Backlog, SpoolError> {
        let rows = self.rows.lock();
        let stored = rows.1.values().filter(|r| !matches!(r.state, RowState::Parked(_)));
        let mut backlog = Backlog::default();
        for row in stored {
            match row.state {
                RowState::Waiting => backlog.waiting += 1,
                _ => backlog.sent += 1,
            }
            backlog.bytes += row.row.envelope.body.len() as u64;
            backlog.oldest_at =
                Some(backlog.oldest_at.map_or(row.created_at, |at| at.min(row.created_at)));
        }
        Ok(backlog)
    }
}
