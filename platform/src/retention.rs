//! Deletion of raw messages after their retention period, in small portions.

use std::time::Duration;

use asi_model::DateTime;
use tokio_util::sync::CancellationToken;

use crate::{
    clock::Clock,
    store::{Store, StoreError},
};

/// The service; [`run`](Self::run) it.
#[derive(Debug)]
pub struct Retention {
    store: Store,
    clock: Clock,
    kept: Duration,
}

/// Pause between portions, which bounds how much of the writer retention takes.
const INTERVAL: Duration = Duration::from_secs(60);
/// Rows forgotten in one transaction, so that nobody waits long for the writer.
const ROWS_PER_WORK_MAX: u32 = 2_000;

impl Retention {
    /// Keeps messages as they came for this long.
    #[must_use]
    pub const fn new(store: Store, clock: Clock, kept: Duration) -> Self {
        Self { store, clock, kept }
    }

    /// Runs until shutdown.
    ///
    /// # Errors
    /// Never; a failing store is logged and asked again in the next round.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), StoreError> {
        let mut rounds = tokio::time::interval(INTERVAL);
        while shutdown.run_until_cancelled(rounds.tick()).await.is_some() {
            if let Err(error) = self.round().await {
                tracing::warn!(%error, "Old messages could not be forgotten.");
            }
        }
        Ok(())
    }

    /// Forgets one portion; how many messages.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn round(&self) -> Result<u64, StoreError> {
        let ticks = i64::try_from(self.kept.as_nanos() / 100).unwrap_or(i64::MAX);
        let before = DateTime::from_ticks(self.clock.now().ticks().saturating_sub(ticks));
        let mut work = self.store.begin().await?;
        let count = work.inbox().forget(before, ROWS_PER_WORK_MAX).await?;
        work.commit().await?;
        Ok(count)
    }
}
