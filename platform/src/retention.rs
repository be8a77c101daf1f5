//! Deletion of raw messages, of accesses and of entries of the audit after their retention periods, in small portions.

use std::time::Duration;

use asi_model::DateTime;
use tokio_util::sync::CancellationToken;

use crate::{
    clock::Clock,
    config::RetentionConfig,
    store::{AccessesKept, Store, StoreError},
};

/// The service; [`run`](Self::run) it.
#[derive(Debug)]
pub struct Retention {
    store: Store,
    clock: Clock,
    inbox_retention: Duration,
    access_retention: Duration,
    audit_retention: Duration,
}

/// Pause between portions, in which others get the writer.
const PAUSE: Duration = Duration::from_millis(20);
/// Time between two rounds.
const INTERVAL: Duration = Duration::from_secs(60);
/// Entries of a factory's access log that are kept at most; some hundred bytes each.
const ACCESSES_RETAINED_MAX: u64 = 2_000_000;
/// Entries of who changed what that are kept of one organisation's people and programs at most; some hundred bytes
/// each.
const AUDIT_ENTRIES_RETAINED_MAX: u64 = 1_000_000;
const DAY: Duration = Duration::from_secs(86_400);
/// Rows forgotten in one transaction, so that nobody waits long for the writer.
const ROWS_PER_WORK_MAX: u32 = 2_000;

/// Numbers of rows that were forgotten at once.
struct Portion {
    messages: u64,
    accesses: u64,
    entries: u64,
}

impl Portion {
    /// Returns true where there may be more.
    fn is_full(&self) -> bool {
        let Self { messages, accesses, entries } = *self;
        [messages, accesses, entries].into_iter().any(|rows| rows >= u64::from(ROWS_PER_WORK_MAX))
    }
}

impl Retention {
    /// Keeps messages and accesses as long as configured.
    #[must_use]
    pub fn new(store: Store, clock: Clock, config: &RetentionConfig) -> Self {
        let days = |count: u32| Duration::from_secs(u64::from(count) * 86_400);
        let (inbox_retention, access_retention) =
            (days(config.inbox_days), days(config.access_days));
        let audit_retention = days(config.audit_days);
        Self { store, clock, inbox_retention, access_retention, audit_retention }
    }

    /// Runs until shutdown.
    ///
    /// # Errors
    /// Never; a failing store is logged and asked again in the next round.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), StoreError> {
        let mut rounds = tokio::time::interval(INTERVAL);
        while shutdown.run_until_cancelled(rounds.tick()).await.is_some() {
            if let Some(Err(error)) = shutdown.run_until_cancelled(self.round()).await {
                tracing::warn!(%error, "Old messages, accesses and entries of the audit could not be forgotten.");
            }
        }
        Ok(())
    }

    /// Forgets all that is too old or too much, portion by portion; how many messages.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn round(&self) -> Result<u64, StoreError> {
        let mut count = 0;
        loop {
            let portion = self.portion().await?;
            count += portion.messages;
            if !portion.is_full() {
                return Ok(count);
            }
            tokio::time::sleep(PAUSE).await;
        }
    }

    /// Forgets one portion of each.
    async fn portion(&self) -> Result<Portion, StoreError> {
        let mut work = self.store.begin().await?;
        let before = self.before(self.inbox_retention);
        let messages = work.inbox().forget(before, ROWS_PER_WORK_MAX).await?;
        work.commit().await?;
        let mut work = self.store.begin().await?;
        // Whole days: each removal is stated in the log, and one a day is enough.
        let since = self.before(self.access_retention).floor_to(DAY);
        let kept = AccessesKept { since, count: ACCESSES_RETAINED_MAX };
        let accesses = work.accesses().forget(kept, ROWS_PER_WORK_MAX, self.clock.now()).await?;
        work.commit().await?;
        let mut work = self.store.begin().await?;
        let before = self.before(self.audit_retention);
        let entries =
            work.audit().forget(before, AUDIT_ENTRIES_RETAINED_MAX, ROWS_PER_WORK_MAX).await?;
        work.commit().await?;
        Ok(Portion { messages, accesses, entries })
    }

    /// Returns the time before which nothing is kept.
    fn before(&self, period: Duration) -> DateTime {
        let ticks = i64::try_from(period.as_nanos() / 100).unwrap_or(i64::MAX);
        DateTime::from_ticks(self.clock.now().ticks().saturating_sub(ticks))
    }
}
