//! A task that owns the broker endpoint of one address: sends in order, reports outcomes.

use std::{collections::HashSet, sync::Arc, time::Duration};

use futures::{FutureExt, StreamExt, future::BoxFuture, stream::FuturesUnordered};
use tokio::{sync::mpsc, task::JoinSet};

use crate::{
    address::LogicalAddress,
    profile::Terminus,
    spool::{RowId, SpoolRow, SpoolStore},
    transport::{BrokerOutcome, Connection, EndpointFault, MessageSender},
};

/// A task that had nothing to send for so long ends. Addresses of factories and tools come and go.
const IDLE_MAX: Duration = Duration::from_secs(300);

/// A report of a sender task.
pub(super) enum SenderEvent {
    /// The broker settled a message.
    Outcome { id: RowId, outcome: BrokerOutcome },
    /// The store does not let the message leave any more.
    Recalled { id: RowId },
    /// The task has ended; the `unsent` rows have no outcome and count as not sent.
    Ended { address: LogicalAddress, fault: Option<EndpointFault>, unsent: Vec<RowId> },
}

/// Dependencies of the sender tasks of one connection.
pub(super) struct SenderContext {
    pub connection: Arc<dyn Connection>,
    pub store: Arc<dyn SpoolStore>,
    pub events: mpsc::Sender<SenderEvent>,
    /// Most rows that wait in one task.
    pub queue_max: usize,
}

/// Handle of the task that sends to one address.
pub(super) struct AddressSender {
    rows: mpsc::Sender<SpoolRow>,
}

impl AddressSender {
    pub(super) fn start(
        tasks: &mut JoinSet<()>,
        context: &SenderContext,
        address: LogicalAddress,
        terminus: Terminus,
    ) -> Self {
        let (rows, waiting) = mpsc::channel(context.queue_max);
        let worker = Worker {
            waiting,
            store: Arc::clone(&context.store),
            events: context.events.clone(),
            unsettled: HashSet::new(),
            outcomes: FuturesUnordered::new(),
        };
        tasks.spawn(worker.run(Arc::clone(&context.connection), address, terminus));
        Self { rows }
    }

    /// Hands a row over. Returns false when the task is ending, so that the row was not sent.
    pub(super) fn send(&self, row: SpoolRow) -> bool {
        self.rows.try_send(row).is_ok()
    }
}

struct Worker {
    waiting: mpsc::Receiver<SpoolRow>,
    store: Arc<dyn SpoolStore>,
    events: mpsc::Sender<SenderEvent>,
    unsettled: HashSet<RowId>,
    outcomes: FuturesUnordered<BoxFuture<'static, (RowId, Result<BrokerOutcome, EndpointFault>)>>,
}

impl Worker {
    async fn run(
        mut self,
        connection: Arc<dyn Connection>,
        address: LogicalAddress,
        terminus: Terminus,
    ) {
        let fault = match connection.sender(&terminus).await {
            Ok(mut sender) => self.serve(sender.as_mut()).await.err(),
            Err(fault) => Some(fault),
        };
        // The endpoint is dropped by now, so no outcome can arrive any more.
        self.waiting.close();
        let mut unsent: Vec<_> = self.unsettled.drain().collect();
        while let Some(row) = self.waiting.recv().await {
            unsent.push(row.id);
        }
        let _ = self.events.send(SenderEvent::Ended { address, fault, unsent }).await;
    }

    /// Sends until the handle is dropped or the endpoint fails.
    async fn serve(&mut self, sender: &mut dyn MessageSender) -> Result<(), EndpointFault> {
        loop {
            let is_idle = self.outcomes.is_empty();
            tokio::select! {
                // Outcomes first: they make room for the rows that wait.
                biased;
                Some((id, outcome)) = self.outcomes.next() => self.on_outcome(id, outcome?).await,
                row = self.waiting.recv() => {
                    let Some(row) = row else { return Ok(()) };
                    self.send(sender, row).await?;
                }
                () = tokio::time::sleep(IDLE_MAX), if is_idle => return Ok(()),
            }
        }
    }

    async fn send(
        &mut self,
        sender: &mut dyn MessageSender,
        mut row: SpoolRow,
    ) -> Result<(), EndpointFault> {
        // At the last moment: a report can be recalled while its row waits in the queue.
        if !self.store.may_leave(&row) {
            let _ = self.events.send(SenderEvent::Recalled { id: row.id }).await;
            return Ok(());
        }
        self.store.sign(&mut row.envelope);
        // Before it is sent: where the endpoint fails half-way, the row counts as not sent.
        self.unsettled.insert(row.id);
        let mut sending = sender.send(&row.envelope);
        // Outcomes make room, so they are received while the broker grants no credit.
        let outcome = loop {
            tokio::select! {
                biased;
                sent = &mut sending => break sent?,
                Some((id, outcome)) = self.outcomes.next() => {
                    let outcome = outcome?;
                    self.unsettled.remove(&id);
                    let _ = self.events.send(SenderEvent::Outcome { id, outcome }).await;
                }
            }
        };
        drop(sending);
        let id = row.id;
        self.outcomes.push(outcome.map(move |outcome| (id, outcome)).boxed());
        Ok(())
    }

    async fn on_outcome(&mut self, id: RowId, outcome: BrokerOutcome) {
        self.unsettled.remove(&id);
        // No one receives it when the connection is given up; the row then stays waiting.
        let _ = self.events.send(SenderEvent::Outcome { id, outcome }).await;
    }
}
