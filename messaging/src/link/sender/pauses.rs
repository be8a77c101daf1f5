//! Times at which the spool is read again: ends of back-offs, and of a pause after the store failed.

use tokio::time::Instant;

/// Owner of these times.
#[derive(Debug, Default)]
pub(super) struct Pauses {
    /// End of the pause of the whole spool.
    until: Option<Instant>,
    /// Ends of all back-offs and pauses.
    retries: Vec<Instant>,
}

impl Pauses {
    /// Adds the end of a back-off.
    pub(super) fn retry_at(&mut self, at: Instant) {
        self.retries.push(at);
    }

    /// Pauses the whole spool.
    pub(super) fn pause_until(&mut self, at: Instant) {
        self.until = Some(at);
        self.retries.push(at);
    }

    /// Returns true while the whole spool is paused.
    pub(super) fn is_paused(&self, now: Instant) -> bool {
        self.until.is_some_and(|until| until > now)
    }

    /// Ends the pause of the whole spool. Returns true where there was one.
    pub(super) fn end(&mut self) -> bool {
        self.until.take().is_some()
    }

    /// Returns the next time at which the spool is read again.
    pub(super) fn next(&self) -> Option<Instant> {
        self.retries.iter().min().copied()
    }

    /// Drops the times that are over.
    pub(super) fn drop_past(&mut self, now: Instant) {
        self.retries.retain(|at| *at > now);
    }
}
