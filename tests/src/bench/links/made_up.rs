//! A spool that makes its messages up when they are asked for, so that it takes no memory of its
//! own.

use std::{
    collections::BTreeSet,
    sync::{
        Arc, Mutex, OnceLock, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::Instant,
};

use async_trait::async_trait;
use bytes::Bytes;
use messaging::{
    Backlog, Delivery, Envelope, Fetch, Inbox, Lane, LogicalAddress, RowId, RowOutcome,
    SendOutcome, Settlement, SpoolError, SpoolRow, SpoolStore,
};

use super::broker_under_test::BODY_BYTES;

pub(super) struct MadeUpSpool {
    count: u64,
    address: LogicalAddress,
    body: Bytes,
    accepted: Mutex<Accepted>,
    finished: OnceLock<Instant>,
    pace: Option<(Arc<Counting>, u64)>,
}

/// Everything through a number, and what is beyond it.
#[derive(Default)]
struct Accepted {
    through: u64,
    beyond: BTreeSet<u64>,
}

impl MadeUpSpool {
    /// Returns a spool with this number of control messages to an address.
    pub(super) fn new(count: u64, address: LogicalAddress) -> Self {
        Self {
            count,
            address,
            body: Bytes::from(vec![b'x'; BODY_BYTES]),
            accepted: Mutex::default(),
            finished: OnceLock::new(),
            pace: None,
        }
    }

    /// Limits the sender to so many messages ahead of those received.
    pub(super) fn ahead_of(self, inbox: Arc<Counting>, messages: u64) -> Self {
        Self { pace: Some((inbox, messages)), ..self }
    }

    /// Returns when the broker accepted the last row.
    pub(super) fn finished(&self) -> Option<Instant> {
        self.finished.get().copied()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Accepted> {
        self.accepted.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[async_trait]
impl SpoolStore for MadeUpSpool {
    fn sign(&self, _: &mut Envelope) {}

    /// Its rows stand for reports.
    fn is_receipted(&self, _: &SpoolRow) -> bool {
        true
    }

    async fn fetch(&self, fetch: Fetch) -> Result<Vec<SpoolRow>, SpoolError> {
        if fetch.lane != Lane::Control {
            return Ok(Vec::new());
        }
        let accepted = self.lock();
        let first = u64::try_from(fetch.after.0)?.max(accepted.through) + 1;
        let last = fetch
            .through
            .map_or(Ok(self.count), |through| u64::try_from(through.0))?
            .min(self.count);
        let last =
            self.pace.as_ref().map_or(last, |(inbox, ahead)| last.min(inbox.received() + ahead));
        let waiting =
            (first..=last).filter(|number| !accepted.beyond.contains(number)).take(fetch.limit);
        waiting
            .map(|number| {
                let message_id = format!("m{number}").parse()?;
                let envelope = Envelope::new(message_id, "bench", self.body.clone());
                Ok(SpoolRow {
                    id: RowId(i64::try_from(number)?),
                    address: self.address.clone(),
                    envelope,
                    attempts: 0,
                })
            })
            .collect()
    }

    async fn record(&self, outcomes: Vec<RowOutcome>) -> Result<(), SpoolError> {
        let mut accepted = self.lock();
        for outcome in
            outcomes.into_iter().filter(|outcome| outcome.outcome == SendOutcome::Accepted)
        {
            accepted.beyond.insert(u64::try_from(outcome.id.0)?);
        }
        let mut next = accepted.through + 1;
        while accepted.beyond.remove(&next) {
            next += 1;
        }
        accepted.through = next - 1;
        if accepted.through == self.count {
            self.finished.get_or_init(Instant::now);
        }
        Ok(())
    }

    async fn last_row(&self) -> Result<RowId, SpoolError> {
        Ok(RowId(i64::try_from(self.count)?))
    }

    async fn backlog(&self) -> Result<Backlog, SpoolError> {
        let waiting = self.count - self.lock().through;
        Ok(Backlog { waiting, bytes: waiting * BODY_BYTES as u64, ..Backlog::default() })
    }
}

/// Accepts and counts everything.
#[derive(Default)]
pub(super) struct Counting {
    received: AtomicU64,
    /// Number of the message whose time is taken.
    expected: u64,
    finished: OnceLock<Instant>,
}

impl Counting {
    pub(super) fn expecting(expected: u64) -> Self {
        Self { expected, ..Self::default() }
    }

    pub(super) fn received(&self) -> u64 {
        self.received.load(Ordering::Relaxed)
    }

    /// Returns when the last expected message came.
    pub(super) fn finished(&self) -> Option<Instant> {
        self.finished.get().copied()
    }
}

#[async_trait]
impl Inbox for Counting {
    async fn receive(
        &self,
        _address: &LogicalAddress,
        deliveries: Vec<Delivery>,
    ) -> Vec<Settlement> {
        let count = deliveries.len() as u64;
        if self.received.fetch_add(count, Ordering::Relaxed) + count >= self.expected {
            self.finished.get_or_init(Instant::now);
        }
        vec![Settlement::Accept; deliveries.len()]
    }
}
