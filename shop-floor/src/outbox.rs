//! From the sessions to the consumer, without ever making a session wait.
//!
//! While the consumer keeps up, batches pass in order and nothing is merged. When its channel is
//! full, changes wait in a backlog that holds the newest per input; what is superseded there is
//! counted.

use std::{collections::HashMap, sync::Arc};

use asi_model::values::DataValue;
use indexmap::IndexMap;
use parking_lot::Mutex;
use tokio::sync::{Notify, mpsc};
use tokio_util::sync::CancellationToken;

use crate::{InputChange, InputKey};

/// The sending side, shared by all sessions.
#[derive(Clone)]
pub(crate) struct Outbox {
    shared: Arc<Shared>,
}

struct Shared {
    sender: mpsc::Sender<Vec<InputChange>>,
    backlog: Mutex<IndexMap<InputKey, DataValue>>,
    backlog_filled: Notify,
}

impl Outbox {
    pub(crate) fn new(waiting_batches_max: usize) -> (Self, mpsc::Receiver<Vec<InputChange>>) {
        let (sender, receiver) = mpsc::channel(waiting_batches_max.max(1));
        let shared = Shared { sender, backlog: Mutex::default(), backlog_filled: Notify::new() };
        (Self { shared: Arc::new(shared) }, receiver)
    }

    /// Hands changes over; never waits.
    pub(crate) fn push(&self, changes: Vec<InputChange>) {
        if changes.is_empty() {
            return;
        }
        let mut backlog = self.shared.backlog.lock();
        let changes = if backlog.is_empty() {
            match self.shared.sender.try_send(changes) {
                // A closed channel means that the consumer has ended: there is nobody to tell.
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

    /// Drains the backlog as the consumer makes room, until told to stop or the consumer ends.
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

    /// Forgets what waits for inputs that nobody wants any more.
    pub(crate) fn forget(&self, inputs: &[InputKey]) {
        let mut backlog = self.shared.backlog.lock();
        if !backlog.is_empty() {
            let inputs: HashMap<_, _> = inputs.iter().map(|input| (*input, ())).collect();
            backlog.retain(|input, _| !inputs.contains_key(input));
        }
    }
}

/// Newest per input wins; returns how many were superseded. An input's place is that of its newest
/// change.
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
        let (outbox, mut receiver) = Outbox::new(1);
        let shutdown = CancellationToken::new();
        let runner = tokio::spawn({
            let (outbox, shutdown) = (outbox.clone(), shutdown.clone());
            async move { outbox.run(shutdown).await }
        });
        outbox.push(changes(&[(1, 1), (1, 2)]));
        outbox.push(changes(&[(1, 3), (2, 1)]));
        outbox.push(changes(&[(1, 4)]));

        assert_eq!(
            receiver.recv().await,
            Some(changes(&[(1, 1), (1, 2)])),
            "what fits passes unmerged"
        );
        assert_eq!(
            receiver.recv().await,
            Some(changes(&[(1, 4), (2, 1)])),
            "what does not is the newest of each"
        );
        outbox.push(changes(&[(3, 1)]));
        assert_eq!(receiver.recv().await, Some(changes(&[(3, 1)])));
        shutdown.cancel();
        runner.await.expect("ends");
    }

    #[test]
    fn forgotten_inputs_leave_the_backlog() {
        let (outbox, _receiver) = Outbox::new(1);
        outbox.push(changes(&[(1, 1)]));
        outbox.push(changes(&[(1, 2), (2, 2)]));
        outbox.forget(&[InputKey(1)]);
        assert_eq!(outbox.shared.backlog.lock().keys().copied().collect::<Vec<_>>(), [InputKey(2)]);
    }
}
