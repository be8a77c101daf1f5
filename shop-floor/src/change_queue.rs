//! Queue of changes from all sessions to the consumer. Sessions never wait for it.
//!
//! While the consumer keeps up, batches pass in order and unmerged. When its channel is full,
//! changes wait in a backlog with the newest one per input; superseded changes are counted.

use std::{collections::HashSet, sync::Arc};

use asi_model::values::DataValue;
use indexmap::IndexMap;
use parking_lot::Mutex;
use tokio::sync::{Notify, mpsc};
use tokio_util::sync::CancellationToken;

use crate::{InputChange, InputKey};

/// Sending side, shared by all sessions.
#[derive(Clone)]
pub(crate) struct ChangeQueue {
    shared: Arc<Shared>,
}

struct Shared {
    sender: mpsc::Sender<Vec<InputChange>>,
    backlog: Mutex<IndexMap<InputKey, DataValue>>,
    backlog_filled: Notify,
}

impl ChangeQueue {
    pub(crate) fn new(waiting_batches_max: usize) -> (Self, mpsc::Receiver<Vec<InputChange>>) {
        let (sender, receiver) = mpsc::channel(waiting_batches_max.max(1));
        let shared = Shared { sender, backlog: Mutex::default(), backlog_filled: Notify::new() };
        (Self { shared: Arc::new(shared) }, receiver)
    }

    /// Sends changes to the consumer, or merges them into the backlog. Never waits.
    pub(crate) fn push(&self, changes: Vec<InputChange>) {
        if changes.is_empty() {
            return;
        }
        // Locked while sending: a later change of another session must not overtake.
        let mut backlog = self.shared.backlog.lock();
        let changes = if backlog.is_empty() {
            match self.shared.sender.try_send(changes) {
                // A closed channel means that the consumer has ended: changes are dropped.
                Ok(()) | Err(mpsc::error::TrySendError::Closed(_)) => return,
                Err(mpsc::error::TrySendError::Full(changes)) => changes,
            }
        } else {
            changes
        };
        let coalesced = merge(&mut backlog, changes);
        drop(backlog);
        if coalesced > 0 {
            metrics::counter!("shop_floor_changes_coalesced_total").increment(coalesced);
        }
        self.shared.backlog_filled.notify_one();
    }

    /// Drains the backlog as the consumer makes room, until `shutdown` or the consumer's end.
    pub(crate) async fn run(&self, shutdown: CancellationToken) {
        loop {
            tokio::select! {
                () = shutdown.cancelled() => return,
                () = self.shared.backlog_filled.notified() => {}
            }
            let permit = tokio::select! {
                () = shutdown.cancelled() => return,
                permit = self.shared.sender.reserve() => permit,
            };
            let Ok(permit) = permit else { return };
            // Sent under the lock: a later push must not overtake the backlog.
            let mut backlog = self.shared.backlog.lock();
            let changes = std::mem::take(&mut *backlog);
            permit.send(
                changes.into_iter().map(|(input, value)| InputChange { input, value }).collect(),
            );
        }
    }

    /// Drops changes of inputs that are no longer monitored.
    pub(crate) fn discard(&self, inputs: &[InputKey]) {
        let mut backlog = self.shared.backlog.lock();
        if !backlog.is_empty() {
            let inputs: HashSet<_> = inputs.iter().collect();
            backlog.retain(|input, _| !inputs.contains(input));
        }
    }
}

/// Merges changes so that the newest per input remains; returns the number of superseded ones.
fn merge(backlog: &mut IndexMap<InputKey, DataValue>, changes: Vec<InputChange>) -> u64 {
    let mut superseded = 0;
    for change in changes {
        if backlog.insert(change.input, change.value).is_some() {
            superseded += 1;
        }
    }
    superseded
}

#[cfg(test)]
mod tests {
    use asi_model::values::DateTime;

    use super::*;

    fn changes(values: &[(u64, i32)]) -> Vec<InputChange> {
        values
            .iter()
            .map(|&(input, value)| InputChange {
                input: InputKey(input),
                value: DataValue::good(value, DateTime::MIN),
            })
            .collect()
    }

    #[tokio::test]
    async fn a_slow_consumer_gets_the_newest_in_order() {
        let (queue, mut receiver) = ChangeQueue::new(1);
        let shutdown = CancellationToken::new();
        let runner = tokio::spawn({
            let (queue, shutdown) = (queue.clone(), shutdown.clone());
            async move { queue.run(shutdown).await }
        });
        queue.push(changes(&[(1, 1), (1, 2)]));
        queue.push(changes(&[(1, 3), (2, 1)]));
        queue.push(changes(&[(1, 4)]));

        assert_eq!(
            receiver.recv().await,
            Some(changes(&[(1, 1), (1, 2)])),
            "changes that fit pass unmerged"
        );
        assert_eq!(
            receiver.recv().await,
            Some(changes(&[(1, 4), (2, 1)])),
            "of the others the newest per input passes"
        );
        queue.push(changes(&[(3, 1)]));
        assert_eq!(receiver.recv().await, Some(changes(&[(3, 1)])));
        shutdown.cancel();
        runner.await.expect("ends");
    }

    #[test]
    fn discarded_inputs_leave_the_backlog() {
        let (queue, _receiver) = ChangeQueue::new(1);
        queue.push(changes(&[(1, 1)]));
        queue.push(changes(&[(1, 2), (2, 2)]));
        queue.discard(&[InputKey(1)]);
        assert_eq!(queue.shared.backlog.lock().keys().copied().collect::<Vec<_>>(), [InputKey(2)]);
    }
}
