//! Sending from the spool: a bounded number of messages in flight, one sender task per address,
//! outcomes recorded in batches.

mod address_sender;
mod addresses;
mod pauses;
mod recorder;
mod unsaved;

use std::{collections::HashSet, sync::Arc, time::Duration};

use tokio::{
    sync::mpsc,
    time::{Instant, MissedTickBehavior, interval, sleep_until},
};
use tokio_util::sync::CancellationToken;
use tracing::{debug, error, warn};

use super::{
    context::LinkContext,
    cursor::Cursor,
    volatile::{VOLATILE_FROM, is_volatile},
};
use crate::{
    address::LogicalAddress,
    clock,
    config::LinkLimits,
    profile::BrokerProfile,
    spool::{
        Rejection, RejectionAction, RowId, RowOutcome, SendOutcome, SpoolError, SpoolRow,
        SpoolStore, after_rejection,
    },
    transport::{BrokerOutcome, Connection, EndpointFault},
};
use address_sender::SenderEvent;
use addresses::{Addresses, Settled};
use pauses::Pauses;
use recorder::Recording;
use unsaved::Unsaved;

/// Events of sender tasks handled at once. Between two groups the window is filled again.
const EVENTS_MAX: usize = 256;
/// Windows of messages that a broker has accepted and may not have stored, beside those that are in flight.
const UNSAVED_WINDOWS_MAX: usize = 20;
/// Interval at which the backlog is counted while it changes.
const TICK: Duration = Duration::from_secs(1);
/// Interval at which the spool is read though nothing woke the link: a missed wake must not lose a
/// message.
const RECHECK: Duration = Duration::from_secs(15);
/// Pause after the store failed. Most often the disk is full, which does not end at once.
const STORE_RETRY: Duration = Duration::from_secs(1);
/// Time in which outcomes may still arrive after the link was stopped.
const STOP_GRACE: Duration = Duration::from_secs(2);

/// The sending side of one connection.
pub(super) struct Sender {
    store: Arc<dyn SpoolStore>,
    context: Arc<LinkContext>,
    limits: LinkLimits,
    /// Reports that the broker does not answer any more; the supervisor drops the connection.
    stalls: mpsc::Sender<String>,
    cursor: Cursor,
    addresses: Addresses,
    events: mpsc::Receiver<SenderEvent>,
    recording: Recording,
    unsaved: Unsaved,
    is_backlog_stale: bool,
    pauses: Pauses,
    last_volatile: RowId,
}

impl Sender {
    pub(super) fn new(
        connection: Arc<dyn Connection>,
        store: Arc<dyn SpoolStore>,
        context: Arc<LinkContext>,
        profile: BrokerProfile,
        limits: LinkLimits,
        stalls: mpsc::Sender<String>,
    ) -> Self {
        let unsaved = Unsaved::new(Arc::clone(&connection));
        let (addresses, events) = Addresses::new(connection, Arc::clone(&store), profile, &limits);
        let recording = Recording::start(Arc::clone(&store), Arc::clone(&context));
        Self {
            store,
            context,
            limits,
            stalls,
            cursor: Cursor::new(RowId(0), limits.replay_share),
            addresses,
            events,
            recording,
            unsaved,
            is_backlog_stale: true,
            pauses: Pauses::default(),
            last_volatile: VOLATILE_FROM,
        }
    }

    pub(super) async fn run(mut self, stop: CancellationToken) {
        let mut tick = interval(TICK);
        tick.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut recheck_at = Instant::now() + RECHECK;
        if !self.begin(&stop).await {
            return;
        }
        let mut batch = Vec::new();
        while !stop.is_cancelled() {
            self.fill().await;
            let next_retry = self.pauses.next();
            tokio::select! {
                () = stop.cancelled() => break,
                _ = self.events.recv_many(&mut batch, EVENTS_MAX) => {
                    for event in batch.drain(..) {
                        self.on_event(event);
                    }
                }
                Some(ids) = self.recording.recorded() => {
                    self.is_backlog_stale = true;
                    ids.into_iter().for_each(|id| self.cursor.close(id));
                }
                stored = self.unsaved.stored() => {
                    stored.into_iter().for_each(|outcome| self.recording.put(outcome));
                }
                () = self.context.wake.notified() => {
                    self.is_backlog_stale = true;
                    self.cursor.on_wake();
                }
                () = self.context.rewind.notified() => self.cursor.on_rewind(),
                () = self.context.has_volatile.notified() => self.send_volatile(),
                () = self.context.restart.notified() => {
                    self.is_backlog_stale = true;
                    if !self.begin(&stop).await {
                        break;
                    }
                }
                () = sleep_until(next_retry.unwrap_or(recheck_at)), if next_retry.is_some() => {
                    self.retry();
                    self.send_volatile();
                }
                () = sleep_until(recheck_at) => {
                    recheck_at = Instant::now() + RECHECK;
                    if self.cursor.is_idle() {
                        self.cursor.on_wake();
                        self.cursor.on_rewind();
                    }
                }
                _ = tick.tick() => {
                    if self.addresses.has_task_panicked() {
                        let _ = self.stalls.try_send("a sender task failed unexpectedly".to_owned());
                    }
                    self.count_backlog().await;
                }
            }
        }
        self.finish().await;
    }

    /// Sends volatile messages ahead of the spool. Those to an address that backs off wait for the
    /// end of the back-off.
    fn send_volatile(&mut self) {
        for (address, envelope) in self.context.take_volatile() {
            if self.addresses.is_backing_off(&address) {
                self.context.put_back_volatile(address, envelope);
                continue;
            }
            self.last_volatile.0 -= 1;
            self.send(SpoolRow { id: self.last_volatile, address, envelope, attempts: 0 });
        }
    }

    /// Finds the end of the backlog and starts to read there. Returns false when stopped before.
    async fn begin(&mut self, stop: &CancellationToken) -> bool {
        loop {
            match self.store.last_row().await {
                Ok(last) => {
                    self.cursor.begin(last);
                    return true;
                }
                Err(problem) => self.on_store_failed(&problem),
            }
            tokio::select! {
                () = stop.cancelled() => return false,
                () = tokio::time::sleep(STORE_RETRY) => {}
            }
        }
    }

    fn on_store_failed(&mut self, problem: &SpoolError) {
        error!(error = %problem, "The spool cannot be read.");
        self.context.report_obstacle("the spool", problem.to_string());
        self.pauses.pause_until(Instant::now() + STORE_RETRY);
    }

    /// Sends as much as the window allows.
    async fn fill(&mut self) {
        if self.pauses.is_paused(Instant::now()) {
            return;
        }
        let window = self.addresses.window();
        // Twice the window: outcomes that are being recorded must not keep the next rows from
        // leaving. Nor must messages that are being stored.
        let unsaved = self.unsaved.count().min(window * UNSAVED_WINDOWS_MAX);
        while self.addresses.in_flight() < window && self.cursor.open() < window * 2 + unsaved {
            if let Some((fetch, target)) = self.cursor.next_fetch() {
                match self.store.fetch(fetch).await {
                    Ok(rows) => {
                        if self.pauses.end() {
                            self.context.clear_obstacle("the spool");
                        }
                        self.cursor.on_fetched(target, rows);
                    }
                    Err(problem) => return self.on_store_failed(&problem),
                }
                continue;
            }
            let Some(row) = self.cursor.next() else { break };
            self.send(row);
        }
    }

    fn send(&mut self, row: SpoolRow) {
        let now = clock::now();
        let id = row.id;
        let is_volatile = is_volatile(id);
        if !is_volatile && row.envelope.is_expired(now) {
            count_sent("expired");
            self.recording.put(RowOutcome { id, outcome: SendOutcome::Expired, at: now });
        } else if !self.addresses.send(row, is_volatile) {
            self.cursor.close(id);
        }
    }

    fn on_event(&mut self, event: SenderEvent) {
        match event {
            SenderEvent::Outcome { id, outcome } => self.on_outcome(id, outcome),
            SenderEvent::Recalled { id, is_first } => {
                if let Some(Settled { address, .. }) = self.settle(id)
                    && is_first
                {
                    self.addresses.send_on(&address);
                }
                self.cursor.close(id);
                // The other reports of the message wait in another row by now.
                self.cursor.on_rewind();
            }
            SenderEvent::Ended { address, fault, unsent } => {
                for id in unsent {
                    self.settle(id);
                    self.cursor.close(id);
                }
                self.on_sender_ended(&address, fault);
            }
        }
    }

    fn on_outcome(&mut self, id: RowId, outcome: BrokerOutcome) {
        let Some(settled) = self.settle(id) else { return };
        let Settled { address, attempts, is_receipted, .. } = settled;
        match outcome {
            BrokerOutcome::Accepted => {
                count_sent("accepted");
                let at = clock::now();
                // A receipt says better than any broker what is stored.
                if is_receipted || is_volatile(id) || !self.unsaved.is_needed {
                    self.record(id, SendOutcome::Accepted);
                } else {
                    self.unsaved.put(RowOutcome { id, outcome: SendOutcome::Accepted, at });
                }
                self.context.accepted(at);
                self.on_address_works(&address);
            }
            BrokerOutcome::Released => {
                count_sent("released");
                // Closed, so that the row is read again after the back-off.
                self.cursor.close(id);
                self.back_off(&address, "the broker released a message".to_owned());
            }
            BrokerOutcome::Rejected(rejection) => {
                count_sent("rejected");
                self.on_rejected(id, &address, rejection, attempts);
            }
        }
    }

    fn on_rejected(
        &mut self,
        id: RowId,
        address: &LogicalAddress,
        rejection: Rejection,
        attempts: u32,
    ) {
        let (code, reason) = (&rejection.code, &rejection.reason);
        match after_rejection(&rejection, attempts) {
            RejectionAction::Park => {
                error!(%address, row = %id, code, reason, "The broker never accepts this message. It is parked.");
                self.record(id, SendOutcome::Parked(rejection));
            }
            RejectionAction::Retry => {
                warn!(%address, row = %id, code, reason, "The broker rejected a message. It is sent again.");
                self.record(id, SendOutcome::Rejected(rejection));
                self.pauses.retry_at(Instant::now() + self.limits.address_backoff);
            }
            RejectionAction::BackOffAddress => {
                self.cursor.close(id);
                self.back_off(address, rejection.to_string());
            }
        }
    }

    fn record(&self, id: RowId, outcome: SendOutcome) {
        if !is_volatile(id) {
            self.recording.put(RowOutcome { id, outcome, at: clock::now() });
        }
    }

    /// Takes a row out of flight.
    fn settle(&mut self, id: RowId) -> Option<Settled> {
        let settled = self.addresses.settle(id)?;
        if settled.needs_rewind {
            self.cursor.on_rewind();
        }
        Some(settled)
    }

    fn on_address_works(&mut self, address: &LogicalAddress) {
        let Some(recovery) = self.addresses.on_accepted(address) else { return };
        self.context.clear_obstacle(&format!("sending to {address}"));
        if recovery.needs_rewind {
            self.cursor.on_rewind();
        }
    }

    fn on_sender_ended(&mut self, address: &LogicalAddress, fault: Option<EndpointFault>) {
        self.addresses.on_sender_ended(address, fault.is_none());
        match fault {
            // It was idle. Rows that came just as it ended are read again.
            None => self.cursor.on_rewind(),
            Some(EndpointFault::Stalled(reason)) => {
                let _ = self.stalls.try_send(reason);
            }
            // A broker may refuse the endpoint over one message that is too large, without saying
            // which. After a back-off messages are sent one at a time, so that it shows.
            Some(fault) => self.back_off(address, fault.to_string()),
        }
    }

    fn back_off(&mut self, address: &LogicalAddress, reason: String) {
        let now = Instant::now();
        let Some(pause) = self.addresses.back_off(address, now) else { return };
        self.pauses.retry_at(now + pause);
        let pause_ms = pause.as_millis();
        warn!(%address, reason, pause_ms, "Sending to an address fails and is paused.");
        self.context.report_obstacle(&format!("sending to {address}"), reason);
    }

    /// Ends back-offs and pauses that are over, and reads again what was skipped meanwhile.
    fn retry(&mut self) {
        let now = Instant::now();
        self.pauses.drop_past(now);
        self.addresses.end_backoffs(now);
        self.cursor.on_rewind();
    }

    async fn count_backlog(&mut self) {
        if !std::mem::take(&mut self.is_backlog_stale) {
            return;
        }
        match self.store.backlog().await {
            Ok(backlog) => self.context.set_backlog(backlog),
            Err(problem) => debug!(error = %problem, "The backlog cannot be counted."),
        }
    }

    /// Waits a short time for the outcomes of messages in flight, then drops the sender tasks and
    /// waits until all outcomes are recorded.
    async fn finish(mut self) {
        let deadline = Instant::now() + STOP_GRACE;
        while self.addresses.in_flight() > 0 {
            match tokio::time::timeout_at(deadline, self.events.recv()).await {
                Ok(Some(SenderEvent::Outcome { id, outcome })) => self.on_outcome(id, outcome),
                Ok(Some(SenderEvent::Ended { unsent, .. })) => {
                    let unsent: HashSet<_> = unsent.into_iter().collect();
                    self.addresses.forget(|id| unsent.contains(id));
                }
                Ok(Some(SenderEvent::Recalled { id: recalled, .. })) => {
                    self.addresses.forget(|id| *id == recalled);
                }
                Ok(None) | Err(_) => break,
            }
        }
        self.addresses.shutdown().await;
        self.recording.finish().await;
    }
}

fn count_sent(outcome: &'static str) {
    metrics::counter!("link_messages_sent_total", "outcome" => outcome).increment(1);
}
