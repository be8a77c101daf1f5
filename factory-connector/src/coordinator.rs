//! Coordinator: the one task that owns state and store, and so the one place where anything changes.
//!
//! Everything that arrives - messages of the platform, candidates of the mapping engine, writes of
//! OPC UA clients, decisions of the engineer, outcomes of the link - runs as a use case on the
//! state. One transaction commits what belongs together; then its effects are published.
//! Transactions are grouped: what arrives while one is being written is part of the next. If one
//! fails, nothing of it happened: the state is read from the store again.

mod candidates;
mod commands;
mod config;
mod delivery_progress;
mod handle;
mod incoming;
mod log;
mod maintenance;
mod outcomes;
mod outputs;
mod publish_effects;
mod receipt_requests;
mod unit_of_work;
mod witnessing;

use std::{collections::VecDeque, time::Duration};

use asi_model::DateTime;
pub use config::CoordinatorConfig;
use connector_state::{
    ChangeSet, ConnectorEvent, ConnectorState, Snapshot,
    transaction::{self, DeliveryState},
    use_cases::{
        seal, validity,
        values::{self, TakenCandidate},
        witness,
    },
};
use handle::Reply;
pub use handle::{CoordinatorCommand, CoordinatorError, CoordinatorHandle, WriteOutcome};
use ledger::LedgerKey;
use maintenance::MaintenanceSchedule;
use mapping_engine::Candidate;
pub use outputs::Outputs;
use tokio::{sync::mpsc, time::Instant};
use tokio_util::sync::CancellationToken;
use unit_of_work::UnitOfWork;
use witnessing::StartWait;

use crate::{
    clock::{self, now},
    store::{Store, StoreError},
};

/// Most commands in one transaction. Bounds the time until the first caller is answered.
const GROUP_MAX: usize = 1024;
/// Most batches of candidates in one transaction.
const CANDIDATE_BATCHES_MAX: usize = 64;
/// Most candidates that are not committed. With more, a transaction is due; where it fails, candidates wait at the
/// mapping engine, and changes at the shop floor, which coalesces them.
const UNCOMMITTED_MAX: usize = 65_536;
/// Time for which gate and transform states without a report may stay unwritten.
const UNREPORTED_STATE_MAX: Duration = Duration::from_secs(1);
/// Shortest time between two events about the ledger for open pages. Entries come with every
/// report, and each event makes every open page ask.
const LEDGER_EVENT_INTERVAL: Duration = Duration::from_secs(2);
/// Pause after a failed transaction.
const PAUSE_AFTER_FAILURE: Duration = Duration::from_secs(1);

/// The coordinator; [`run`](Self::run) it.
pub struct Coordinator {
    work: UnitOfWork,
    commands: mpsc::Receiver<CoordinatorCommand>,
    candidates: mpsc::Receiver<Vec<Candidate>>,
    /// Candidates that were taken since the last commit. Nobody has them but this transaction: where it fails, they are
    /// taken again, each of them once, so that a sum or a mean over them stays right.
    uncommitted: Vec<TakenCandidate>,
    /// Answers to give when the transaction has ended.
    replies: Vec<Reply>,
    schedule: MaintenanceSchedule,
    timing: Timing,
    /// The store was restored, moved or copied, and the new epochs of its writers are not
    /// committed yet.
    are_epochs_due: bool,
    /// Wait of the reports for the word of the ledger's witness.
    wait: StartWait,
}

/// Times that decide when the coordinator wakes up and commits.
struct Timing {
    /// Earliest time of the next report.
    next_publish: Instant,
    /// Time of day when it was read last.
    clock: DateTime,
    /// Start of the oldest change that is not committed.
    oldest_unwritten: Option<Instant>,
    /// The ledger has entries that open pages have not heard of.
    has_ledger_entries: bool,
    ledger_event_at: Instant,
}

/// Opens the way to a coordinator that is yet to be made.
#[must_use]
pub fn channel() -> (CoordinatorHandle, mpsc::Receiver<CoordinatorCommand>) {
    let (commands, receiver) = mpsc::channel(GROUP_MAX);
    (CoordinatorHandle::new(commands), receiver)
}

impl Coordinator {
    /// Reads the state from the store.
    ///
    /// # Errors
    /// [`StoreError`] where the store cannot be read.
    pub async fn new(
        config: CoordinatorConfig,
        mut store: Store,
        outputs: Outputs,
        key: LedgerKey,
        commands: mpsc::Receiver<CoordinatorCommand>,
        candidates: mpsc::Receiver<Vec<Candidate>>,
    ) -> Result<Self, StoreError> {
        let is_restored = store.identity().is_restored;
        let snapshot = store.load().await?;
        let (state, pending) = load(&config, snapshot, &key, is_restored)?;
        let mut wait = StartWait::new(config.witness_wait);
        witnessing::hold(&outputs, &state, &mut wait);
        let instant = Instant::now();
        Ok(Self {
            work: UnitOfWork { config, store, state, pending, outputs, key },
            commands,
            candidates,
            uncommitted: Vec::new(),
            replies: Vec::new(),
            schedule: MaintenanceSchedule::default(),
            timing: Timing {
                next_publish: instant,
                clock: now(),
                oldest_unwritten: None,
                has_ledger_entries: false,
                ledger_event_at: instant,
            },
            are_epochs_due: is_restored,
            wait,
        })
    }

    /// Runs until shutdown; everything accepted by then is committed.
    ///
    /// # Errors
    /// [`StoreError`] where the store cannot be read back after a failed transaction.
    pub async fn run(mut self, shutdown: CancellationToken) -> Result<(), StoreError> {
        // Loading may have changed something, which is stored before anything new.
        self.commit().await?;
        while !shutdown.is_cancelled() {
            let (commands, batches) = self.wait(&shutdown).await;
            // The clock first: a deadline that was computed before it was set back would hold
            // values for as long as that.
            self.follow_clock();
            self.receive_candidates(batches);
            for command in commands {
                let reply = commands::handle_command(&mut self.work, command).await?;
                self.queue_reply(reply);
            }
            let now = now();
            self.uncommitted.extend(validity::begin_requests(&mut self.work.state, now));
            self.work.pending.merge(validity::end_requests(&mut self.work.state, now));
            values::release_due(&mut self.work.state, now);
            maintenance::run_maintenance(&mut self.work, &mut self.schedule).await?;
            if self.must_commit() {
                self.commit().await?;
            }
            self.publish_ledger_event();
            if !self.wait.is_over() {
                self.hold();
            }
        }
        self.commit().await?;
        self.work.store.close().await;
        Ok(())
    }

    /// Queues an answer for the end of the transaction.
    fn queue_reply(&mut self, reply: Option<Reply>) {
        if let Some(reply) = reply {
            self.timing.oldest_unwritten.get_or_insert_with(Instant::now);
            self.replies.push(reply);
        }
    }

    /// Waits for work, and takes what there is of it.
    async fn wait(
        &mut self,
        shutdown: &CancellationToken,
    ) -> (VecDeque<CoordinatorCommand>, Vec<Vec<Candidate>>) {
        let (mut commands, mut batches) = (VecDeque::new(), Vec::new());
        let (wake_at, has_room) = (self.wake_at(), self.has_room(&[]));
        tokio::select! {
            () = shutdown.cancelled() => {}
            command = self.commands.recv() => commands.extend(command),
            batch = self.candidates.recv(), if has_room => batches.extend(batch),
            () = tokio::time::sleep_until(wake_at) => {}
        }
        // What came meanwhile joins the transaction, so that one flush to the disk serves all of
        // it.
        while commands.len() < GROUP_MAX
            && let Ok(command) = self.commands.try_recv()
        {
            commands.push_back(command);
        }
        while batches.len() < CANDIDATE_BATCHES_MAX
            && self.has_room(&batches)
            && let Ok(batch) = self.candidates.try_recv()
        {
            batches.push(batch);
        }
        (commands, batches)
    }

    /// Returns true while candidates may be taken beside those that are not committed and these.
    fn has_room(&self, batches: &[Vec<Candidate>]) -> bool {
        let taken: usize = batches.iter().map(Vec::len).sum();
        self.uncommitted.len() + taken < UNCOMMITTED_MAX
    }

    /// Follows the machine's clock: deadlines are times of day, so they change when it is set back.
    fn follow_clock(&mut self) {
        let now = now();
        if now < self.timing.clock {
            let by = self.timing.clock.since(now);
            let by_ms = u64::try_from(by.as_millis()).unwrap_or(u64::MAX);
            tracing::warn!(by_ms, "The machine's clock was set back.");
            values::set_clock_back(&mut self.work.state, now);
        }
        self.timing.clock = now;
    }

    fn receive_candidates(&mut self, batches: Vec<Vec<Candidate>>) {
        if batches.iter().any(|batch| !batch.is_empty()) {
            let candidates = candidates::of_fields(batches.into_iter().flatten());
            let outcomes = candidates::receive(&mut self.work, candidates.clone(), now());
            self.uncommitted.extend(TakenCandidate::all_of(candidates, outcomes));
            self.timing.oldest_unwritten.get_or_insert_with(Instant::now);
        }
    }

    /// Returns the time at which there is work without a command or candidate.
    fn wake_at(&self) -> Instant {
        let mut at = self.schedule.next();
        if self.work.state.writers().has_unreported() || !self.replies.is_empty() {
            at = at.min(self.timing.next_publish);
        }
        if let Some(oldest) = self.timing.oldest_unwritten {
            at = at.min(oldest + UNREPORTED_STATE_MAX);
        }
        if let Some(deadline) = self.work.state.fields().next_deadline() {
            at = at.min(Instant::now() + deadline.since(now()));
        }
        at
    }

    fn must_commit(&self) -> bool {
        // Values wait for the publishing interval, and so do answers to those who wrote them.
        let has_work = self.work.state.writers().has_unreported() || !self.replies.is_empty();
        let oldest = self.timing.oldest_unwritten;
        (has_work && Instant::now() >= self.timing.next_publish)
            || self.work.pending.is_urgent()
            || !self.has_room(&[])
            || oldest.is_some_and(|oldest| oldest.elapsed() >= UNREPORTED_STATE_MAX)
    }

    /// Commits one transaction with all pending changes, and publishes its effects.
    async fn commit(&mut self) -> Result<(), StoreError> {
        let now = now();
        let refreshed =
            transaction::refresh(&mut self.work.state, std::mem::take(&mut self.work.pending));
        let delivery = delivery_progress::delivery_state(&mut self.work.store, &refreshed).await?;
        // Before the commit: a report that the link sent while it is being written would be
        // accounted for as taken back.
        self.recall(&delivery);
        let (writes, effects) = refreshed
            .take_back(&mut self.work.state, delivery, &self.work.key, now)
            .report(&mut self.work.state, now, clock::salt)
            .sign(&mut self.work.state, &self.work.key);
        // From here and not from the end: the length of a commit does not slow the publishing down.
        self.timing.next_publish = Instant::now() + self.work.config.publishing_interval;
        self.timing.oldest_unwritten = None;
        let report_count = writes.reports.queued.len();
        let are_epochs_begun = writes.writers.are_epochs_begun;
        let has_ledger_entries = !writes.ledger.entries.is_empty();
        if !writes.is_empty()
            && let Err(error) = self.work.store.commit(writes).await
        {
            return self.recover(&error).await;
        }
        self.uncommitted.clear();
        self.work.outputs.in_flight.confirm_recalls();
        self.are_epochs_due &= !are_epochs_begun;
        metrics::counter!("verbund_reports_total").increment(report_count as u64);
        // Only after the commit: what a caller has heard survives a crash.
        for reply in self.replies.drain(..) {
            reply(true);
        }
        // Before the link is told that it may go on.
        self.hold();
        // After the commit: nobody sees what a failed transaction takes away again.
        publish_effects::publish_effects(&self.work.outputs, &self.work.state, effects).await;
        self.timing.has_ledger_entries |= has_ledger_entries;
        Ok(())
    }

    /// Holds reports back, or lets them leave.
    fn hold(&mut self) {
        witnessing::hold(&self.work.outputs, &self.work.state, &mut self.wait);
    }

    /// Recalls the waiting reports that this transaction takes back: from here on the link sends
    /// none of them, whether it has fetched them already or not.
    fn recall(&self, delivery: &DeliveryState) {
        let purged = delivery.purged.values().flatten();
        let waiting = purged.filter(|report| report.row.sent_at.is_none());
        self.work.outputs.in_flight.recall(waiting.map(|report| report.row.id.0));
    }

    /// Tells open pages now and then that the ledger grew: values leave many times a second.
    fn publish_ledger_event(&mut self) {
        let Timing { has_ledger_entries, ledger_event_at, .. } = &mut self.timing;
        if *has_ledger_entries && ledger_event_at.elapsed() >= LEDGER_EVENT_INTERVAL {
            (*has_ledger_entries, *ledger_event_at) = (false, Instant::now());
            self.work.outputs.events.publish(vec![ConnectorEvent::Ledger]);
        }
    }

    /// Loads the state again after a failed transaction, of which nothing happened.
    async fn recover(&mut self, error: &StoreError) -> Result<(), StoreError> {
        metrics::counter!("verbund_store_failures_total").increment(1);
        tracing::error!(
            error = error as &dyn std::error::Error,
            "A transaction failed; nothing of it happened. Check the disk of the data directory."
        );
        for reply in self.replies.drain(..) {
            reply(false);
        }
        // The reports were not taken back after all, so they may leave.
        self.work.outputs.in_flight.undo_recalls();
        self.schedule.begin_retention_again();
        // A full or failing disk does not recover at once; without a pause this would only repeat.
        tokio::time::sleep(PAUSE_AFTER_FAILURE).await;
        let mut snapshot = self.work.store.load().await?;
        // Keep-alives and deleted messages may be under way, and candidates of removed fields: their
        // numbers must not be given again.
        let UnitOfWork { config, state, pending, key, .. } = &mut self.work;
        snapshot.last_row = snapshot.last_row.max(state.last_row());
        snapshot.last_field = state.fields().last_id();
        let (mut read, changes) = load(config, snapshot, key, self.are_epochs_due)?;
        let now = now();
        values::know_again(&mut read, state, now);
        (*state, *pending) = (read, changes);
        if !self.uncommitted.is_empty() {
            let taken = std::mem::take(&mut self.uncommitted);
            self.uncommitted = values::take_again(state, taken, now);
            self.timing.oldest_unwritten = Some(Instant::now());
        }
        Ok(())
    }
}

/// Loads the state, with everything that is to be shown, run and signed again.
fn load(
    config: &CoordinatorConfig,
    snapshot: Snapshot,
    key: &LedgerKey,
    is_restored: bool,
) -> Result<(ConnectorState, ChangeSet), StoreError> {
    let config = config.state.clone();
    let (mut state, mut changes) =
        ConnectorState::load(config, snapshot, clock::id_source(), is_restored, now())?;
    changes.merge(seal::sign_all_heads(&mut state, key));
    changes.merge(witness::submit_all(&mut state, key, now()));
    Ok((state, changes))
}

#[cfg(test)]
mod tests;
