//! Bucket of requests that fills by time.

use std::time::{Duration, Instant};

use super::config::Rate;

/// Requests that are left, kept as the time at which all are there again.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bucket {
    /// Absent before the first request.
    full_at: Option<Instant>,
}

impl Bucket {
    /// Returns the time until one more request fits; zero where it fits now.
    pub(super) fn wait(&self, rate: Rate, now: Instant) -> Duration {
        (self.until_full(now) + rate.interval()).saturating_sub(rate.refill())
    }

    /// Takes one request off, whether it fits or not.
    pub(super) fn take(&mut self, rate: Rate, now: Instant) {
        self.full_at = Some(now + self.until_full(now) + rate.interval());
    }

    /// Returns true where no request is missing.
    pub(super) fn is_full(&self, now: Instant) -> bool {
        self.until_full(now).is_zero()
    }

    fn until_full(&self, now: Instant) -> Duration {
        self.full_at.map_or(Duration::ZERO, |at| at.saturating_duration_since(now))
    }
}
