//! Pings and their answers, which come in the order of the pings.

use std::sync::atomic::{AtomicU64, Ordering};

use tokio::sync::watch;

/// Numbers of the pings of one connection.
#[derive(Debug, Default)]
pub(super) struct Pings {
    written: AtomicU64,
    answered: watch::Sender<u64>,
}

impl Pings {
    /// Returns the number that the next ping has.
    pub(super) fn next(&self) -> u64 {
        self.written.load(Ordering::SeqCst) + 1
    }

    /// Notes that one is about to be written.
    pub(super) fn writes(&self) {
        self.written.fetch_add(1, Ordering::SeqCst);
    }

    /// Notes the answer to the oldest one without an answer.
    pub(super) fn answered(&self) {
        self.answered.send_modify(|count| *count += 1);
    }

    /// Waits until the ping with a number is answered.
    pub(super) async fn is_answered(&self, number: u64) {
        // Its sender is this one's own, so that it never ends before.
        let _ = self.answered.subscribe().wait_for(|count| *count >= number).await;
    }
}
