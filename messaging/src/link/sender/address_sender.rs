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
        /// True for the first one; rows that are handed over after [`AddressSender::send_on`] are sent again.
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
    rows: mpsc::Sender<(SpoolRow, u64)>,
    /// Number of recalls so far. Each row is handed over with it, so that the task knows what was read before one.
    recalls: u64,
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
            turned_away: None,
        };
        tasks.spawn(worker.run(Arc::clone(&context.connection), address, terminus));
        Self { rows, recalls: 0 }
    }

    /// Hands a row over. Returns false when the task is ending, so that the row was not sent.
    pub(super) fn send(&self, row: SpoolRow) -> bool {
        self.rows.try_send((row, self.recalls)).is_ok()
    }

    /// Ends the turning away of rows: those that are handed over from here on were read after the recall.
    pub(super) const fn send_on(&mut self) {
        self.recalls += 1;
    }
}

struct Worker {
    waiting: mpsc::Receiver<(SpoolRow, u64)>,
    store: Arc<dyn SpoolStore>,
    events: mpsc::Sender<SenderEvent>,
    unsettled: HashSet<RowId>,
    outcomes: FuturesUnordered<BoxFuture<'static, (RowId, Result<BrokerOutcome, EndpointFault>)>>,
    /// Recalls with which the row was handed over that was recalled last: all rows with as many were read before.
    turned_away: Option<u64>,
}

impl Worker {
    async fn run(
        mut self,
        connection: Arc<dyn Connection>,
        address: LogicalAddress,
        terminus: Terminus,
    ) {
        let fault = match connection.sender(&terminus).await {
            Ok(mut sender) => {
                let fault = self.serve(sender.as_mut()).await.err();
                // What the broker settled before it ended the endpoint need not be sent again.
                while let Some(Some((id, outcome))) = self.outcomes.next().now_or_never() {
                    if let Ok(outcome) = outcome {
                        self.on_outcome(id, outcome).await;
                    }
                }
                fault
            }
            Err(fault) => Some(fault),
        };
        // The endpoint is dropped by now, so no outcome can arrive any more.
        self.waiting.close();
        let mut unsent: Vec<_> = self.unsettled.drain().collect();
        while let Some((row, _)) = self.waiting.recv().await {
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
                    let Some((row, recalls)) = row else { return Ok(()) };
                    self.send(sender, row, recalls).await?;
                }
                fault = sender.ended() => {
                    // Without a row in flight another endpoint is opened for the next one.
                    return if self.unsettled.is_empty() { Ok(()) } else { Err(fault) };
                }
                () = tokio::time::sleep(IDLE_MAX), if is_idle => return Ok(()),
            }
        }
    }

    async fn send(
        &mut self,
        sender: &mut dyn MessageSender,
        mut row: SpoolRow,
        recalls: u64,
    ) -> Result<(), EndpointFault> {
        // At the last moment: a report can be recalled while its row waits in the queue.
        let is_behind = self.turned_away == Some(recalls);
        if (is_behind && !is_volatile(row.id)) || !self.store.may_leave(&row) {
            self.turned_away = Some(recalls);
            let is_first = !is_behind;
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

        async fn ended(&mut self) -> EndpointFault {
            std::future::pending().await
        }
    }

    /// Broker that accepts the first message and then ends the endpoint.
    #[derive(Default)]
    struct Ending {
        sent: usize,
    }

    #[async_trait::async_trait]
    impl MessageSender for Ending {
        async fn send(&mut self, _: &Envelope) -> Result<OutcomeFuture, EndpointFault> {
            self.sent += 1;
            if self.sent == 1 {
                return Ok(async { Ok(BrokerOutcome::Accepted) }.boxed());
            }
            Ok(std::future::pending().boxed())
        }

        async fn ended(&mut self) -> EndpointFault {
            if self.sent < 2 {
                std::future::pending::<()>().await;
            }
            EndpointFault::Broken("closed".to_owned())
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

    fn worker(recalled: Option<i64>) -> (Worker, AddressSender, mpsc::Receiver<SenderEvent>) {
        let (rows, waiting) = mpsc::channel(16);
        let (events, reported) = mpsc::channel(16);
        let spool = MemorySpool::new(AcceptedReports::Leave);
        let store = Arc::new(Recalling { spool, recalled: Mutex::new(recalled.map(RowId)) });
        let worker = Worker {
            waiting,
            store,
            events,
            unsettled: HashSet::new(),
            outcomes: FuturesUnordered::new(),
            turned_away: None,
        };
        (worker, AddressSender { rows, recalls: 0 }, reported)
    }

    /// The outcomes of what a broker had not taken never come: rows without one are sent again by another endpoint, and
    /// not after a timeout of the whole connection.
    #[tokio::test]
    async fn an_endpoint_that_the_broker_ends_is_noticed_while_outcomes_are_awaited() {
        let (mut worker, task, mut reported) = worker(None);
        for id in [1, 2] {
            assert!(task.send(row(id)));
        }
        let mut broker = Ending::default();
        let served = tokio::time::timeout(Duration::from_secs(10), worker.serve(&mut broker));
        let fault = served.await.expect("at once").expect_err("it ended");
        assert_eq!(fault, EndpointFault::Broken("closed".to_owned()));
        assert!(matches!(reported.try_recv(), Ok(SenderEvent::Outcome { id: RowId(1), .. })));
        assert_eq!(worker.unsettled, HashSet::from([RowId(2)]));
        // Without a row in flight nothing is wrong: the next row opens another endpoint.
        worker.unsettled.clear();
        worker.outcomes.clear();
        worker.serve(&mut broker).await.expect("in order");
    }

    #[tokio::test]
    async fn nothing_passes_a_message_that_was_recalled() {
        let (mut worker, mut task, mut reported) = worker(Some(2));
        let sent = Arc::<Mutex<Vec<String>>>::default();
        let mut broker = Accepting(Arc::clone(&sent));
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
