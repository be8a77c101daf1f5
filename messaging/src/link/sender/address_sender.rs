//! A task that owns the broker endpoint of one address: sends in order, reports outcomes.

use std::{collections::HashSet, sync::Arc, time::Duration};

use futures::{FutureExt, StreamExt, future::BoxFuture, stream::FuturesUnordered};
use tokio::{sync::mpsc, task::JoinSet};

use crate::{
    address::LogicalAddress,
    link::volatile::is_volatile,
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
    /// The store does not let the message leave any more, or the message waited behind such a one:
    /// what is left of that one waits in the spool, and nothing may pass it.
    Recalled {
        id: RowId,
        /// True for the first one; the task sends on once it is called on by [`AddressSender::send_on`].
        is_first: bool,
    },
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
    orders: mpsc::Sender<SendOrder>,
}

/// Order to a sender task.
enum SendOrder {
    Send(Box<SpoolRow>),
    /// End of the turning away: rows from here on were read after the recall.
    SendOn,
}

impl AddressSender {
    pub(super) fn start(
        tasks: &mut JoinSet<()>,
        context: &SenderContext,
        address: LogicalAddress,
        terminus: Terminus,
    ) -> Self {
        // One more for a call to send on.
        let (orders, waiting) = mpsc::channel(context.queue_max + 1);
        let worker = Worker {
            waiting,
            store: Arc::clone(&context.store),
            events: context.events.clone(),
            unsettled: HashSet::new(),
            outcomes: FuturesUnordered::new(),
            turns_away: false,
        };
        tasks.spawn(worker.run(Arc::clone(&context.connection), address, terminus));
        Self { orders }
    }

    /// Hands a row over. Returns false when the task is ending, so that the row was not sent.
    pub(super) fn send(&self, row: SpoolRow) -> bool {
        self.orders.try_send(SendOrder::Send(Box::new(row))).is_ok()
    }

    /// Ends the turning away of rows: those that are sent from here on were read after the recall.
    pub(super) fn send_on(&self) {
        // Fails while the task is ending; another one turns nothing away.
        let _ = self.orders.try_send(SendOrder::SendOn);
    }
}

struct Worker {
    waiting: mpsc::Receiver<SendOrder>,
    store: Arc<dyn SpoolStore>,
    events: mpsc::Sender<SenderEvent>,
    unsettled: HashSet<RowId>,
    outcomes: FuturesUnordered<BoxFuture<'static, (RowId, Result<BrokerOutcome, EndpointFault>)>>,
    /// True behind a message that was recalled.
    turns_away: bool,
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
        while let Some(order) = self.waiting.recv().await {
            if let SendOrder::Send(row) = order {
                unsent.push(row.id);
            }
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
                order = self.waiting.recv() => match order {
                    Some(SendOrder::Send(row)) => self.send(sender, *row).await?,
                    Some(SendOrder::SendOn) => self.turns_away = false,
                    None => return Ok(()),
                },
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
        let is_behind = self.turns_away && !is_volatile(row.id);
        if is_behind || !self.store.may_leave(&row) {
            let is_first = !std::mem::replace(&mut self.turns_away, true);
            let _ = self.events.send(SenderEvent::Recalled { id: row.id, is_first }).await;
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

#[cfg(test)]
mod tests {
    use parking_lot::Mutex;

    use super::*;
    use crate::{
        envelope::Envelope,
        link::volatile::VOLATILE_FROM,
        spool::{
            Backlog, Fetch, RowOutcome, SpoolError,
            memory::{AcceptedReports, MemorySpool},
        },
        transport::OutcomeFuture,
    };

    /// Store that recalls one row.
    struct Recalling {
        spool: MemorySpool,
        recalled: Mutex<Option<RowId>>,
    }

    #[async_trait::async_trait]
    impl SpoolStore for Recalling {
        async fn fetch(&self, fetch: Fetch) -> Result<Vec<SpoolRow>, SpoolError> {
            self.spool.fetch(fetch).await
        }

        fn may_leave(&self, row: &SpoolRow) -> bool {
            self.recalled.lock().take_if(|recalled| *recalled == row.id).is_none()
        }

        fn sign(&self, envelope: &mut Envelope) {
            self.spool.sign(envelope);
        }

        async fn record(&self, outcomes: Vec<RowOutcome>) -> Result<(), SpoolError> {
            self.spool.record(outcomes).await
        }

        async fn last_row(&self) -> Result<RowId, SpoolError> {
            self.spool.last_row().await
        }

        async fn backlog(&self) -> Result<Backlog, SpoolError> {
            self.spool.backlog().await
        }
    }

    /// Broker that accepts all, and notes it.
    struct Accepting(Arc<Mutex<Vec<String>>>);

    #[async_trait::async_trait]
    impl MessageSender for Accepting {
        async fn send(&mut self, envelope: &Envelope) -> Result<OutcomeFuture, EndpointFault> {
            self.0.lock().push(envelope.subject.clone());
            Ok(async { Ok(BrokerOutcome::Accepted) }.boxed())
        }
    }

    fn row(id: i64) -> SpoolRow {
        let message_id = format!("m{id}").parse().expect("an id");
        SpoolRow {
            id: RowId(id),
            address: "factory.F.ingress".parse().expect("an address"),
            envelope: Envelope::new(message_id, id.to_string(), "{}"),
            attempts: 0,
        }
    }

    #[tokio::test]
    async fn nothing_passes_a_message_that_was_recalled() {
        let (orders, waiting) = mpsc::channel(16);
        let (events, mut reported) = mpsc::channel(16);
        let spool = MemorySpool::new(AcceptedReports::Leave);
        let store = Arc::new(Recalling { spool, recalled: Mutex::new(Some(RowId(2))) });
        let mut worker = Worker {
            waiting,
            store,
            events,
            unsettled: HashSet::new(),
            outcomes: FuturesUnordered::new(),
            turns_away: false,
        };
        let sent = Arc::<Mutex<Vec<String>>>::default();
        let mut broker = Accepting(Arc::clone(&sent));
        let task = AddressSender { orders };
        for id in [1, 2, 3, 4] {
            assert!(task.send(row(id)));
        }
        // A keep-alive has no place among the rows.
        assert!(task.send(row(VOLATILE_FROM.0)));
        task.send_on();
        for id in [2, 3, 4] {
            assert!(task.send(row(id)));
        }
        drop(task);
        worker.serve(&mut broker).await.expect("served");
        let volatile = VOLATILE_FROM.0.to_string();
        assert_eq!(*sent.lock(), ["1", &volatile, "2", "3", "4"]);
        let mut recalled = Vec::new();
        while let Ok(event) = reported.try_recv() {
            if let SenderEvent::Recalled { id, is_first } = event {
                recalled.push((id.0, is_first));
            }
        }
        assert_eq!(recalled, [(2, true), (3, false), (4, false)]);
    }
}
