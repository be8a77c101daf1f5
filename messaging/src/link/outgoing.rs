//! Sends from the spool: a bounded number of messages under way, one lane per address, outcomes
//! recorded in batches.

mod addresses;
mod lane;
mod recorder;

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
    time::Duration,
};

use time::OffsetDateTime;
use tokio::{
    sync::mpsc,
    task::JoinSet,
    time::{Instant, MissedTickBehavior, interval, sleep_until},
};
use tokio_util::sync::CancellationToken;
use tracing::{debug, error, warn};

use super::{
    cursor::Cursor,
    shared::{POSTED_MAX, Shared},
};
use crate::{
    address::LogicalAddress,
    config::LinkLimits,
    profile::BrokerProfile,
    spool::{
        RejectionAction, RowId, RowOutcome, SendOutcome, SpoolRow, SpoolStore, StoreError,
        after_rejection,
    },
    transport::{Connection, Outcome},
};
use addresses::AddressState;
use lane::{Lane, LaneEvent};
use recorder::Recorder;

/// Rows that were posted have numbers below those of the spool; nothing is recorded of them.
const POSTED_FROM: i64 = -1;
/// How often the backlog is looked at while something changes, and rests are checked.
const TICK: Duration = Duration::from_secs(1);
/// How often the spool is looked through when nothing woke the link: a wake that was missed must
/// not lose a message.
const RECHECK: Duration = Duration::from_secs(15);
/// Pause after the store failed.
const STORE_RETRY: Duration = Duration::from_secs(1);
/// How long outcomes may come in after the link was told to stop.
const STOP_GRACE: Duration = Duration::from_secs(2);
/// Addresses share so many windows at most.
const WINDOWS_MAX: usize = 4;

/// All sending of one connection.
pub(super) struct Pump {
    connection: Arc<dyn Connection>,
    store: Arc<dyn SpoolStore>,
    shared: Arc<Shared>,
    profile: BrokerProfile,
    limits: LinkLimits,
    stalls: mpsc::Sender<String>,
    cursor: Cursor,
    addresses: HashMap<LogicalAddress, AddressState>,
    /// Sent, without an outcome yet: how often they were rejected before.
    under_way: HashMap<RowId, (LogicalAddress, u32)>,
    events: mpsc::Sender<LaneEvent>,
    lanes: JoinSet<()>,
    is_backlog_stale: bool,
    paused_until: Option<Instant>,
    retries: Vec<Instant>,
    last_posted: i64,
}

impl Pump {
    pub(super) fn new(
        connection: Arc<dyn Connection>,
        store: Arc<dyn SpoolStore>,
        shared: Arc<Shared>,
        profile: BrokerProfile,
        limits: LinkLimits,
        stalls: mpsc::Sender<String>,
    ) -> Self {
        let (events, _) = mpsc::channel(1);
        Self {
            connection,
            store,
            shared,
            profile,
            limits,
            stalls,
            cursor: Cursor::new(RowId(0), limits.replay_share),
            addresses: HashMap::new(),
            under_way: HashMap::new(),
            events,
            lanes: JoinSet::new(),
            is_backlog_stale: true,
            paused_until: None,
            retries: Vec::new(),
            last_posted: POSTED_FROM,
        }
    }

    pub(super) async fn run(mut self, stop: CancellationToken) {
        let (events, mut arrived) = mpsc::channel(self.limits.window.max(1) * WINDOWS_MAX);
        self.events = events;
        let (recorder, outcomes, mut recorded) =
            Recorder::new(Arc::clone(&self.store), Arc::clone(&self.shared));
        let recording = tokio::spawn(recorder.run());
        let mut tick = interval(TICK);
        tick.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut recheck_at = Instant::now() + RECHECK;
        if !self.begin(&stop).await {
            return;
        }
        let mut batch = Vec::new();
        while !stop.is_cancelled() {
            self.fill(&outcomes).await;
            let next_retry = self.retries.iter().min().copied();
            tokio::select! {
                () = stop.cancelled() => break,
                _ = arrived.recv_many(&mut batch, 256) => {
                    for event in batch.drain(..) {
                        self.on_event(event, &outcomes);
                    }
                }
                Some(ids) = recorded.recv() => {
                    self.is_backlog_stale = true;
                    ids.into_iter().for_each(|id| self.cursor.close(id));
                }
                () = self.shared.wake.notified() => {
                    self.is_backlog_stale = true;
                    self.cursor.on_wake();
                }
                () = self.shared.rewind.notified() => self.cursor.on_rewind(),
                () = self.shared.post.notified() => self.send_posted(&outcomes),
                () = self.shared.anew.notified() => {
                    self.is_backlog_stale = true;
                    if !self.begin(&stop).await {
                        break;
                    }
                }
                () = sleep_until(next_retry.unwrap_or(recheck_at)), if next_retry.is_some() => {
                    self.retry();
                    self.send_posted(&outcomes);
                }
                () = sleep_until(recheck_at) => {
                    recheck_at = Instant::now() + RECHECK;
                    if self.cursor.is_idle() {
                        self.cursor.on_wake();
                        self.cursor.on_rewind();
                    }
                }
                _ = tick.tick() => {
                    self.reap();
                    self.look_at_backlog().await;
                }
            }
        }
        self.finish(arrived, outcomes).await;
        let _ = recording.await;
    }

    /// What is not kept goes first. At an address that rests it waits for the end of the rest.
    fn send_posted(&mut self, outcomes: &mpsc::UnboundedSender<RowOutcome>) {
        for (address, envelope) in self.shared.take_posted() {
            if self.addresses.get(&address).is_some_and(|state| state.resting_until.is_some()) {
                self.shared.put_back(address, envelope);
                continue;
            }
            self.last_posted -= 1;
            self.send(
                SpoolRow { id: RowId(self.last_posted), address, envelope, attempts: 0 },
                outcomes,
            );
        }
    }

    /// Finds where the backlog ends. Returns whether it was found before the end.
    async fn begin(&mut self, stop: &CancellationToken) -> bool {
        loop {
            match self.store.last_row().await {
                Ok(last) => {
                    self.cursor.begin(last);
                    return true;
                }
                Err(problem) => self.store_failed(&problem),
            }
            tokio::select! {
                () = stop.cancelled() => return false,
                () = tokio::time::sleep(STORE_RETRY) => {}
            }
        }
    }

    fn store_failed(&mut self, problem: &StoreError) {
        error!(error = %problem, "the spool cannot be read");
        self.shared.hinder("the spool", Some(problem.to_string()));
        let retry = Instant::now() + STORE_RETRY;
        self.paused_until = Some(retry);
        self.retries.push(retry);
    }

    /// Sends as much as the window allows.
    async fn fill(&mut self, outcomes: &mpsc::UnboundedSender<RowOutcome>) {
        if self.paused_until.is_some_and(|until| until > Instant::now()) {
            return;
        }
        let windows = self.addresses.len().clamp(1, WINDOWS_MAX);
        let window = self.limits.window.max(1) * windows;
        while self.under_way.len() < window && self.cursor.open() < window * 2 {
            if let Some((fetch, target)) = self.cursor.wanted() {
                match self.store.fetch(fetch).await {
                    Ok(rows) => {
                        if self.paused_until.take().is_some() {
                            self.shared.hinder("the spool", None);
                        }
                        self.cursor.on_fetched(target, rows);
                    }
                    Err(problem) => return self.store_failed(&problem),
                }
                continue;
            }
            let Some(row) = self.cursor.next() else { break };
            self.send(row, outcomes);
        }
    }

    fn send(&mut self, row: SpoolRow, outcomes: &mpsc::UnboundedSender<RowOutcome>) {
        let now = OffsetDateTime::now_utc();
        let is_posted = row.id.0 <= POSTED_FROM;
        if !is_posted && row.envelope.is_expired(now) {
            metrics::counter!("link_messages_sent_total", "outcome" => "expired").increment(1);
            let _ =
                outcomes.send(RowOutcome { id: row.id, outcome: SendOutcome::Expired, at: now });
            return;
        }
        let window = self.limits.window.max(1);
        let address = self.addresses.entry(row.address.clone()).or_default();
        let room = if address.failures > 0 { 1 } else { window };
        // What was passed over goes first, so nothing behind it may overtake. What is posted has no
        // place among the rows.
        let is_full = address.has_skipped || address.under_way >= room;
        if address.resting_until.is_some() || (is_full && !is_posted) {
            address.has_skipped |= !is_posted;
            self.cursor.close(row.id);
            return;
        }
        let lane = address.lane.get_or_insert_with(|| {
            let terminus = self.profile.produce(&row.address);
            let connection = Arc::clone(&self.connection);
            let store = Arc::clone(&self.store);
            let room = window + POSTED_MAX;
            Lane::open(
                &mut self.lanes,
                connection,
                row.address.clone(),
                terminus,
                room,
                store,
                self.events.clone(),
            )
        });
        let (id, attempts, of) = (row.id, row.attempts, row.address.clone());
        match lane.send(row) {
            Ok(()) => {
                address.under_way += 1;
                self.under_way.insert(id, (of, attempts));
            }
            Err(_) => {
                // The lane is ending; it is opened anew when its end is known.
                address.has_skipped |= !is_posted;
                self.cursor.close(id);
            }
        }
    }

    fn on_event(&mut self, event: LaneEvent, outcomes: &mpsc::UnboundedSender<RowOutcome>) {
        match event {
            LaneEvent::Outcome { id, outcome } => self.on_outcome(id, outcome, outcomes),
            LaneEvent::Recalled { id } => {
                self.settled(id);
                self.cursor.close(id);
                // What else was in the message waits in another form.
                self.cursor.on_rewind();
            }
            LaneEvent::Ended { address, fault, unsent } => {
                for id in unsent {
                    self.settled(id);
                    self.cursor.close(id);
                }
                self.on_lane_ended(&address, fault);
            }
        }
    }

    fn on_outcome(
        &mut self,
        id: RowId,
        outcome: Outcome,
        outcomes: &mpsc::UnboundedSender<RowOutcome>,
    ) {
        let Some((address, attempts)) = self.settled(id) else { return };
        let at = OffsetDateTime::now_utc();
        let record = |outcome| {
            if id.0 <= POSTED_FROM {
                return;
            }
            let _ = outcomes.send(RowOutcome { id, outcome, at });
        };
        let count = |outcome: &'static str| {
            metrics::counter!("link_messages_sent_total", "outcome" => outcome).increment(1)
        };
        match outcome {
            Outcome::Accepted => {
                count("accepted");
                record(SendOutcome::Accepted);
                self.shared.accepted(at);
                self.address_works(&address);
            }
            Outcome::Released => {
                count("released");
                self.cursor.close(id);
                self.rest(&address, "the broker released a message".to_owned());
            }
            Outcome::Rejected(rejection) => {
                count("rejected");
                match after_rejection(&rejection, attempts) {
                    RejectionAction::Park => {
                        error!(%address, row = %id, code = rejection.code, reason = rejection.reason, "a message is set aside, for the broker will not take it");
                        record(SendOutcome::Parked(rejection));
                    }
                    RejectionAction::Retry => {
                        warn!(%address, row = %id, code = rejection.code, reason = rejection.reason, "the broker rejected a message; it is tried again");
                        record(SendOutcome::Rejected(rejection));
                        self.retries.push(Instant::now() + self.limits.address_backoff);
                    }
                    RejectionAction::BackOffAddress => {
                        self.cursor.close(id);
                        self.rest(&address, rejection.to_string());
                    }
                }
            }
        }
    }

    /// Takes note of lanes that have ended; one that panicked has taken its rows with it.
    fn reap(&mut self) {
        while let Some(ended) = self.lanes.try_join_next() {
            if ended.is_err() {
                let _ = self.stalls.try_send("a lane failed unexpectedly".to_owned());
            }
        }
    }

    async fn look_at_backlog(&mut self) {
        if !std::mem::take(&mut self.is_backlog_stale) {
            return;
        }
        match self.store.backlog().await {
            Ok(backlog) => self.shared.set_backlog(backlog),
            Err(problem) => debug!(error = %problem, "the backlog cannot be counted"),
        }
    }

    /// Takes in the outcomes that still come, then drops the lanes.
    async fn finish(
        mut self,
        mut arrived: mpsc::Receiver<LaneEvent>,
        outcomes: mpsc::UnboundedSender<RowOutcome>,
    ) {
        let deadline = Instant::now() + STOP_GRACE;
        while !self.under_way.is_empty() {
            match tokio::time::timeout_at(deadline, arrived.recv()).await {
                Ok(Some(LaneEvent::Outcome { id, outcome })) => {
                    self.on_outcome(id, outcome, &outcomes)
                }
                Ok(Some(LaneEvent::Ended { unsent, .. })) => {
                    let unsent: HashSet<_> = unsent.into_iter().collect();
                    self.under_way.retain(|id, _| !unsent.contains(id));
                }
                Ok(Some(LaneEvent::Recalled { id })) => drop(self.under_way.remove(&id)),
                Ok(None) | Err(_) => break,
            }
        }
        self.lanes.shutdown().await;
    }
}
