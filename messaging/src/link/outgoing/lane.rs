//! A task that owns the lane to one address: sends in order, reports outcomes.

use std::{collections::HashSet, sync::Arc, time::Duration};

use futures::{FutureExt, StreamExt, future::BoxFuture, stream::FuturesUnordered};
use tokio::{sync::mpsc, task::JoinSet};

use crate::{
    address::LogicalAddress,
    profile::Terminus,
    spool::{RowId, SpoolRow, SpoolStore},
    transport::{Connection, LaneFault, Outcome, Outgoing},
};

/// A lane that had nothing to send for so long is closed.
const IDLE_MAX: Duration = Duration::from_secs(300);

/// What a lane reports.
pub(super) enum LaneEvent {
    /// A message has its outcome.
    Outcome { id: RowId, outcome: Outcome },
    /// The store does not let the message leave any more.
    Recalled { id: RowId },
    /// The lane has ended; these rows have no outcome and must be taken as not sent.
    Ended { address: LogicalAddress, fault: Option<LaneFault>, unsent: Vec<RowId> },
}

/// The pump's end of a lane.
pub(super) struct Lane {
    rows: mpsc::Sender<SpoolRow>,
}

impl Lane {
    pub(super) fn open(
        tasks: &mut JoinSet<()>,
        connection: Arc<dyn Connection>,
        address: LogicalAddress,
        terminus: Terminus,
        window: usize,
        store: Arc<dyn SpoolStore>,
        events: mpsc::Sender<LaneEvent>,
    ) -> Self {
        let (rows, waiting) = mpsc::channel(window);
        let worker = Worker {
            waiting,
            store,
            events,
            unsettled: HashSet::new(),
            outcomes: FuturesUnordered::new(),
        };
        tasks.spawn(worker.run(connection, address, terminus));
        Self { rows }
    }

    /// Hands a row over. Fails when the lane is ending.
    pub(super) fn send(&self, row: SpoolRow) -> Result<(), ()> {
        self.rows.try_send(row).map_err(drop)
    }
}

struct Worker {
    waiting: mpsc::Receiver<SpoolRow>,
    store: Arc<dyn SpoolStore>,
    events: mpsc::Sender<LaneEvent>,
    unsettled: HashSet<RowId>,
    outcomes: FuturesUnordered<BoxFuture<'static, (RowId, Result<Outcome, LaneFault>)>>,
}

impl Worker {
    async fn run(
        mut self,
        connection: Arc<dyn Connection>,
        address: LogicalAddress,
        terminus: Terminus,
    ) {
        let fault = match connection.outgoing(&terminus).await {
            Ok(mut lane) => self.serve(lane.as_mut()).await.err(),
            Err(fault) => Some(fault),
        };
        // The lane is dropped by now, so no outcome can come that is not lost.
        self.waiting.close();
        let mut unsent: Vec<_> = self.unsettled.drain().collect();
        while let Some(row) = self.waiting.recv().await {
            unsent.push(row.id);
        }
        let _ = self.events.send(LaneEvent::Ended { address, fault, unsent }).await;
    }

    /// Sends until the pump or the lane ends.
    async fn serve(&mut self, lane: &mut dyn Outgoing) -> Result<(), LaneFault> {
        loop {
            let is_idle = self.outcomes.is_empty();
            tokio::select! {
                biased;
                Some((id, outcome)) = self.outcomes.next() => self.on_outcome(id, outcome?).await,
                row = self.waiting.recv() => {
                    let Some(row) = row else { return Ok(()) };
                    self.send(lane, row).await?;
                }
                () = tokio::time::sleep(IDLE_MAX), if is_idle => return Ok(()),
            }
        }
    }

    async fn send(&mut self, lane: &mut dyn Outgoing, row: SpoolRow) -> Result<(), LaneFault> {
        if !self.store.may_leave(&row) {
            let _ = self.events.send(LaneEvent::Recalled { id: row.id }).await;
            return Ok(());
        }
        self.unsettled.insert(row.id);
        let mut sending = lane.send(&row.envelope);
        // Outcomes make room, so they are taken in while the broker gives none.
        let outcome = loop {
            tokio::select! {
                biased;
                sent = &mut sending => break sent?,
                Some((id, outcome)) = self.outcomes.next() => {
                    let outcome = outcome?;
                    self.unsettled.remove(&id);
                    let _ = self.events.send(LaneEvent::Outcome { id, outcome }).await;
                }
            }
        };
        drop(sending);
        let id = row.id;
        self.outcomes.push(outcome.map(move |outcome| (id, outcome)).boxed());
        Ok(())
    }

    async fn on_outcome(&mut self, id: RowId, outcome: Outcome) {
        self.unsettled.remove(&id);
        // Nobody listens when the connection is being given up; the row then stays waiting.
        let _ = self.events.send(LaneEvent::Outcome { id, outcome }).await;
    }
}
