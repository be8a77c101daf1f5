//! Time that may be spent in waiting for a peer.

use std::{
    pin::Pin,
    task::{Context, Poll},
    time::Duration,
};

use tokio::time::{Instant, Sleep, sleep};

use super::limits::PATIENCE_PER_BYTE;

/// A stock of patience that waiting uses up and progress gives back, up to what it was at first. A
/// trickle of bytes does not keep it up.
#[derive(Debug)]
pub(super) struct Patience {
    left: Duration,
    max: Duration,
    waiting_since: Option<Instant>,
    alarm: Option<Pin<Box<Sleep>>>,
}

impl Patience {
    pub(super) const fn new(max: Duration) -> Self {
        Self { left: max, max, waiting_since: None, alarm: None }
    }

    /// Notes that the peer did something: some bytes came or went.
    pub(super) fn progressed(&mut self, bytes: usize) {
        if let Some(since) = self.waiting_since.take() {
            self.left = self.left.saturating_sub(since.elapsed());
            self.alarm = None;
        }
        let gained = PATIENCE_PER_BYTE.saturating_mul(u32::try_from(bytes).unwrap_or(u32::MAX));
        self.left = self.left.saturating_add(gained).min(self.max);
    }

    /// Notes that the peer is waited for. Ready once there is no patience left; the task is woken then.
    pub(super) fn poll_spent(&mut self, context: &mut Context<'_>) -> Poll<()> {
        self.waiting_since.get_or_insert_with(Instant::now);
        let left = self.left;
        let alarm = self.alarm.get_or_insert_with(|| Box::pin(sleep(left)));
        alarm.as_mut().poll(context)
    }
}

#[cfg(test)]
mod tests {
    use std::future::poll_fn;

    use super::*;

    /// Returns the rounds with this many bytes each before patience was lost; 30 where it was not.
    async fn rounds(patience: Duration, bytes: usize) -> usize {
        let mut patience = Patience::new(patience);
        for round in 0..30 {
            let spent = poll_fn(|context| patience.poll_spent(context));
            if tokio::time::timeout(Duration::from_millis(20), spent).await.is_ok() {
                return round;
            }
            patience.progressed(bytes);
        }
        30
    }

    #[tokio::test]
    async fn a_trickle_does_not_keep_patience_up() {
        assert_eq!(rounds(Duration::ZERO, 0).await, 0);
        let trickle = rounds(Duration::from_millis(200), 1).await;
        assert!(trickle <= 11, "lost after 200 ms of waiting, not after {trickle} times 20 ms");
        assert_eq!(rounds(Duration::from_secs(20), 8 * 1024).await, 30);
    }
}
