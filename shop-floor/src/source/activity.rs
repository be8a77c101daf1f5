//! Counters and times that change with every notification of a source.

use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};

use asi_model::values::DateTime;

use crate::clock;

/// Activity of a source since the connector started. Lock-free: callbacks of the session update it.
#[derive(Default)]
pub(super) struct ActivityCounters {
    changes: AtomicU64,
    /// Zero ticks mean never.
    last_change_ticks: AtomicI64,
    last_sign_ticks: AtomicI64,
}

impl ActivityCounters {
    /// Records a sign of life of the server that brought this many changes.
    pub(super) fn record(&self, changes: u64) {
        let ticks = clock::now().ticks();
        self.last_sign_ticks.store(ticks, Ordering::Relaxed);
        if changes > 0 {
            self.changes.fetch_add(changes, Ordering::Relaxed);
            self.last_change_ticks.store(ticks, Ordering::Relaxed);
        }
    }

    pub(super) fn changes(&self) -> u64 {
        self.changes.load(Ordering::Relaxed)
    }

    pub(super) fn last_change_at(&self) -> Option<DateTime> {
        time(&self.last_change_ticks)
    }

    pub(super) fn last_sign_of_life_at(&self) -> Option<DateTime> {
        time(&self.last_sign_ticks)
    }
}

fn time(ticks: &AtomicI64) -> Option<DateTime> {
    let ticks = ticks.load(Ordering::Relaxed);
    (ticks != 0).then(|| DateTime::from_ticks(ticks))
}
