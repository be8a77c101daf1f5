//! The desk: the one task that owns books and store, and so the one place where anything changes.
//!
//! Whatever comes - messages of the platform, candidates of the mapping engine, writes of OPC UA
//! clients, decisions of the engineer, outcomes of the link - is entered in the books; then one
//! transaction holds everything that belongs together; then the other rooms hear of it.
//! Transactions are grouped: what arrives while one is being written goes into the next. If one
//! fails, nothing of it happened: the books are read from the store again.

mod aftermath;
mod handle;
mod housekeeping;
mod messages;
mod standing;
#[cfg(test)]
mod ways_tests;

use std::{collections::VecDeque, sync::Arc, time::Duration};

use asi_model::{DateTime, messages::ValueSource};
use daemon::web::events::EventLog;
use mapping_engine::{Candidate, TargetKey};
use messaging::{LinkHandle, spool::OverduePolicy};
use rand::RngCore as _;
use tokio::{sync::mpsc, time::Instant};
use tokio_util::sync::CancellationToken;

use handle::{Command, Reply};
pub use handle::{DeskError, DeskHandle, Taken};
use housekeeping::Housekeeping;

use crate::{
    books::{Books, BooksConfig, ConnectorEvent, MappingWork},
    outbox::{Departures, Ephemerals},
    store::{Store, StoreError},
};
use ledger::{LedgerKey, SALT_BYTES, SignedHead};

/// Most commands taken into one transaction.
const GROUP_MAX: usize = 1024;
/// Most batches of candidates taken into one transaction.
const CANDIDATE_BATCHES_MAX: usize = 64;
/// How long gate and transform states without a report may stay unwritten.
const UNREPORTED_STATE_MAX: Duration = Duration::from_secs(1);
/// How often open pages hear that the ledger grows.
const LEDGER_NEWS_INTERVAL: Duration = Duration::from_secs(2);
/// How long to wait after a failed transaction.
const PAUSE_AFTER_FAILURE: Duration = Duration::from_secs(1);

/// How the desk works.
#[derive(Debug, Clone)]
pub struct DeskConfig {
    /// How the books are kept.
    pub books: BooksConfig,
    /// The shortest time between two reports of one data set.
    pub publishing_interval: Duration,
    /// Bounds of the spool.
    pub spool: SpoolLimits,
    /// How long what left is kept.
    pub retention: RetentionLimits,
}

/// How long what left is kept. The ledger stays provable in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RetentionLimits {
    /// Days after which values are emptied; their hashes stay. For ever where 0.
    pub value_days: u32,
    /// Days after which entries are removed; a signed anchor stays. For ever where 0.
    pub entry_days: u32,
}

/// Bounds of the spool.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SpoolLimits {
    /// Bytes of reports at which older ones are given up for newer ones.
    pub bytes_max: u64,
    /// Age at which reports are given up, in hours.
    pub age_hours_max: u32,
    /// Seconds without a receipt after which a report is sent again; doubles with each time, up to
    /// an hour.
    pub resend_after_s: u32,
}

impl Default for SpoolLimits {
    fn default() -> Self {
        Self { bytes_max: 2 << 30, age_hours_max: 30 * 24, resend_after_s: 60 }
    }
}

impl SpoolLimits {
    const fn overdue(&self) -> OverduePolicy {
        OverduePolicy {
            receipt_timeout: Duration::from_secs(self.resend_after_s as u64),
            receipt_timeout_max: Duration::from_secs(3600),
        }
    }
}

/// The other rooms.
pub struct Rooms {
    /// Shows what is in the books.
    pub twin: twin::TwinHandle,
    /// Takes mappings, in the order of the decisions.
    pub mappings: mpsc::Sender<Vec<MappingWork>>,
    /// Sends what is in the spool; none before enrolment.
    pub link: Option<LinkHandle>,
    /// Messages that are not kept.
    pub ephemerals: Arc<Ephemerals>,
    /// What is on its way out.
    pub departures: Arc<Departures>,
    /// Open pages.
    pub events: EventLog<ConnectorEvent>,
}

/// The desk; [`run`](Self::run) it.
pub struct Desk {
    config: DeskConfig,
    store: Store,
    books: Books,
    rooms: Rooms,
    key: LedgerKey,
    commands: mpsc::Receiver<Command>,
    candidates: mpsc::Receiver<Vec<Candidate>>,
    /// Answers to give after the commit.
    replies: Vec<Reply>,
    housekeeping: Housekeeping,
    next_publish: Instant,
    /// The time of day when it was looked at last.
    clock: DateTime,
    oldest_unwritten: Option<Instant>,
    /// The ledger has entries that pages have not heard of, and when they heard last.
    has_ledger_news: bool,
    ledger_told_at: Instant,
    /// The store was restored, moved or copied, and that every writer has begun a new epoch is not
    /// committed yet.
    are_epochs_due: bool,
}

/// Opens the way to a desk that is yet to be made.
#[must_use]
pub fn channel() -> (DeskHandle, mpsc::Receiver<Command>) {
    let (commands, receiver) = mpsc::channel(GROUP_MAX);
    (DeskHandle::new(commands), receiver)
}

impl Desk {
    /// Reads everything back from the store.
    ///
    /// # Errors
    /// [`StoreError`] where the store cannot be read.
    pub async fn new(
        config: DeskConfig,
        mut store: Store,
        rooms: Rooms,
        key: LedgerKey,
        commands: mpsc::Receiver<Command>,
        candidates: mpsc::Receiver<Vec<Candidate>>,
    ) -> Result<Self, StoreError> {
        let is_restored = store.identity().is_restored;
        let books = Books::new(config.books.clone(), store.load().await?, is_restored, now())?;
        Ok(Self {
            config,
            store,
            books,
            rooms,
            key,
            commands,
            candidates,
            replies: Vec::new(),
            housekeeping: Housekeeping::default(),
            next_publish: Instant::now(),
            clock: now(),
            oldest_unwritten: None,
            has_ledger_news: false,
            ledger_told_at: Instant::now(),
            are_epochs_due: is_restored,
        })
    }

    /// Runs until shutdown; what was taken by then is committed.
    ///
    /// # Errors
    /// [`StoreError`] where the store cannot be read back after a failed transaction.
    pub async fn run(mut self, shutdown: CancellationToken) -> Result<(), StoreError> {
        self.sign_all_ends();
        self.commit().await?;
        while !shutdown.is_cancelled() {
            let (mut commands, mut batches) = (VecDeque::new(), Vec::new());
            let wake_at = self.wake_at();
            tokio::select! {
                () = shutdown.cancelled() => {}
                command = self.commands.recv() => commands.extend(command),
                batch = self.candidates.recv() => batches.extend(batch),
                () = tokio::time::sleep_until(wake_at) => {}
            }
            while commands.len() < GROUP_MAX
                && let Ok(command) = self.commands.try_recv()
            {
                commands.push_back(command);
            }
            while batches.len() < CANDIDATE_BATCHES_MAX
                && let Ok(batch) = self.candidates.try_recv()
            {
                batches.push(batch);
            }
            self.watch_clock();
            self.take_candidates(batches);
            for command in commands {
                self.take(command).await?;
            }
            let now = now();
            self.books.begin(now);
            self.books.expire(now);
            self.books.release_due(now);
            self.keep_house().await?;
            if self.must_commit() {
                self.commit().await?;
            }
            self.tell_of_ledger();
        }
        self.commit().await?;
        self.store.close().await;
        Ok(())
    }

    /// Waiting is told in times of day: they have to be told again when the clock is set back.
    fn watch_clock(&mut self) {
        let now = now();
        if now < self.clock {
            let by_ms = u64::try_from(self.clock.since(now).as_millis()).unwrap_or(u64::MAX);
            tracing::warn!(by_ms, "The machine's clock was set back.");
            self.books.set_clock_back(now);
        }
        self.clock = now;
    }

    fn take_candidates(&mut self, batches: Vec<Vec<Candidate>>) {
        let now = now();
        let mut count = 0_u64;
        for candidate in batches.into_iter().flatten() {
            count += 1;
            let Candidate { target: TargetKey(number), value, state } = candidate;
            self.books.candidate_for(number, ValueSource::Mapping, value, state, now);
        }
        if count > 0 {
            metrics::counter!("verbund_candidates_total").increment(count);
            self.oldest_unwritten.get_or_insert_with(Instant::now);
        }
    }

    /// When there is something to do though nobody asks.
    fn wake_at(&self) -> Instant {
        let mut at = self.housekeeping.next();
        if self.books.has_news() {
            at = at.min(self.next_publish);
        }
        if let Some(oldest) = self.oldest_unwritten {
            at = at.min(oldest + UNREPORTED_STATE_MAX);
        }
        if let Some(due) = self.books.next_due().into_iter().chain(self.books.next_turn()).min() {
            at = at.min(Instant::now() + due.since(now()));
        }
        at
    }

    fn must_commit(&self) -> bool {
        let has_asked = !self.replies.is_empty();
        // Values wait for the publishing interval, and so do answers to those who wrote them.
        let is_time = Instant::now() >= self.next_publish;
        let is_stale =
            self.oldest_unwritten.is_some_and(|oldest| oldest.elapsed() >= UNREPORTED_STATE_MAX);
        (self.books.has_news() && is_time)
            || self.books.has_urgent_changes()
            || is_stale
            || (has_asked && is_time)
    }

    /// One transaction with everything in it, and then what follows from it.
    async fn commit(&mut self) -> Result<(), StoreError> {
        let now = now();
        self.books.refresh_writers();
        self.take_back_purged(now).await?;
        self.books.report(now, salt);
        self.sign_ends();
        self.next_publish = Instant::now() + self.config.publishing_interval;
        self.oldest_unwritten = None;
        let (changes, aftermath) = self.books.take();
        let (reports, are_epochs_begun) = (changes.reports.len(), changes.are_epochs_begun);
        let has_entries = !changes.ledger.is_empty();
        if !changes.is_empty()
            && let Err(error) = self.store.commit(changes).await
        {
            return self.recover(&error).await;
        }
        self.are_epochs_due &= !are_epochs_begun;
        metrics::counter!("verbund_reports_total").increment(reports as u64);
        for reply in self.replies.drain(..) {
            reply.give(true);
        }
        self.follow(aftermath).await;
        self.has_ledger_news |= has_entries;
        Ok(())
    }

    /// Values leave many times a second; pages that show the ledger read it again now and then.
    fn tell_of_ledger(&mut self) {
        if self.has_ledger_news && self.ledger_told_at.elapsed() >= LEDGER_NEWS_INTERVAL {
            (self.has_ledger_news, self.ledger_told_at) = (false, Instant::now());
            self.rooms.events.publish([ConnectorEvent::Ledger]);
        }
    }

    /// After a failed transaction: nothing of it happened.
    async fn recover(&mut self, error: &StoreError) -> Result<(), StoreError> {
        metrics::counter!("verbund_store_failures_total").increment(1);
        tracing::error!(
            error = error as &dyn std::error::Error,
            "A transaction failed; nothing of it happened. Check the disk of the data directory."
        );
        for reply in self.replies.drain(..) {
            reply.give(false);
        }
        self.rooms.departures.forget_recalls();
        tokio::time::sleep(PAUSE_AFTER_FAILURE).await;
        let mut snapshot = self.store.load().await?;
        // Keep-alives and what was deleted may be under way: their numbers must not be given again.
        snapshot.last_row = snapshot.last_row.max(self.books.last_row);
        self.books =
            Books::new(self.config.books.clone(), snapshot, self.are_epochs_due, self::now())?;
        Ok(())
    }

    /// At the start: signs the ends of all chains, as they were loaded.
    fn sign_all_ends(&mut self) {
        let factory = &self.config.books.factory_id;
        let ends = self.books.heads.iter();
        let signed = ends.map(|(recipient, head)| {
            SignedHead::new(factory, recipient.clone(), head.number, head.hash, &self.key)
        });
        let signed: Vec<_> = signed.collect();
        self.books.changes.heads.extend(signed);
    }

    /// Signs the ends of the chains that grew.
    fn sign_ends(&mut self) {
        let changes = &mut self.books.changes;
        let entries = changes.ledger.iter().map(|(entry, _)| entry);
        changes.heads.extend(SignedHead::of(&self.config.books.factory_id, entries, &self.key));
    }
}

/// The machine's clock.
#[must_use]
pub fn now() -> DateTime {
    std::time::SystemTime::now().into()
}

fn salt() -> [u8; SALT_BYTES] {
    let mut salt = [0; SALT_BYTES];
    rand::rng().fill_bytes(&mut salt);
    salt
}

#[cfg(test)]
mod tests;
