//! Times at which the holders of leases were heard last.

use std::{
    collections::HashMap,
    time::{Duration, Instant},
};

use asi_model::FactoryId;
use parking_lot::Mutex;

/// Last sign of life per factory. In memory and by the monotonic clock, so that neither a jumping
/// clock nor a restart takes a lease from its holder.
#[derive(Debug)]
pub(super) struct Heartbeats {
    silence: Duration,
    started: Instant,
    heard: Mutex<HashMap<FactoryId, Instant>>,
}

impl Heartbeats {
    /// Starts with no sign of life; a holder counts as gone after `silence`.
    pub(super) fn new(silence: Duration) -> Self {
        Self { silence, started: Instant::now(), heard: Mutex::default() }
    }

    /// Time after which a silent holder counts as gone.
    pub(super) const fn silence(&self) -> Duration {
        self.silence
    }

    pub(super) fn record(&self, factory: &FactoryId) {
        self.heard.lock().insert(factory.clone(), Instant::now());
    }

    /// Returns true if the holder of the factory's lease counts as gone.
    pub(super) fn is_silent(&self, factory: &FactoryId) -> bool {
        let last = self.heard.lock().get(factory).copied().unwrap_or(self.started);
        last.elapsed() >= self.silence
    }
}
