//! Subscription of one consumer to a queue.

use std::sync::Arc;

use tokio::sync::Notify;

use super::{Consumer, Queue, QueueEntry};

/// Next event for a consumer.
#[derive(Debug)]
pub(crate) enum Next {
    /// A message, leased to the consumer.
    Lease(QueueEntry),
    /// The queue was deleted.
    Deleted,
}

/// Subscription of one consumer; dropping it unsubscribes.
#[derive(Debug)]
pub(crate) struct Subscription {
    queue: Arc<Queue>,
    consumer: Consumer,
}

impl Subscription {
    pub(crate) fn new(queue: Arc<Queue>) -> Self {
        let consumer = {
            let mut state = queue.state.lock();
            state.next_consumer += 1;
            let consumer = Consumer {
                id: state.next_consumer,
                wake: Arc::new(Notify::new()),
                give_way: Arc::new(Notify::new()),
            };
            state.consumers.push_back(consumer.clone());
            consumer
        };
        Self { queue, consumer }
    }

    /// Waits for the next message. Cancel safe: no lease is lost.
    pub(crate) async fn next(&self) -> Next {
        loop {
            if let Some(next) = self.try_next() {
                return next;
            }
            self.consumer.wake.notified().await;
        }
    }

    /// Declares that this consumer takes nothing at the moment, and wakes another one instead.
    pub(crate) fn pause(&self) {
        let mut state = self.queue.state.lock();
        state.waiting.retain(|id| *id != self.consumer.id);
        state.wake_next();
    }

    /// Waits until another consumer could send the message that this one holds. To be called
    /// between [`hold`](Self::hold) and [`release_hold`](Self::release_hold).
    pub(crate) async fn give_way_requested(&self) {
        self.consumer.give_way.notified().await;
    }

    /// Declares that this consumer has leased a message and lacks the credit to send it.
    pub(crate) fn hold(&self) {
        let mut state = self.queue.state.lock();
        if state.ready.is_empty()
            && state.waiting.iter().any(|id| *id != self.consumer.id && state.may_receive(*id))
        {
            self.consumer.give_way.notify_one();
        }
        state.holding.push_back(self.consumer.clone());
    }

    /// Ends a hold: the message was sent or requeued.
    pub(crate) fn release_hold(&self) {
        self.queue.state.lock().holding.retain(|c| c.id != self.consumer.id);
    }

    /// Returns true if it was woken and has not tried to lease since.
    #[cfg(test)]
    pub(super) fn is_woken(&self) -> bool {
        futures::FutureExt::now_or_never(self.consumer.wake.notified()).is_some()
    }

    fn try_next(&self) -> Option<Next> {
        let mut state = self.queue.state.lock();
        let me = self.consumer.id;
        state.waiting.retain(|id| *id != me);
        if state.is_deleted {
            return Some(Next::Deleted);
        }
        if state.may_receive(me) {
            if let Some((_, entry)) = state.ready.pop_first() {
                state.leased += 1;
                state.wake_next();
                return Some(Next::Lease(entry));
            }
            if let Some(holder) = state.holding.iter().find(|c| c.id != me) {
                holder.give_way.notify_one();
            }
        }
        state.waiting.push_back(me);
        None
    }
}

impl Drop for Subscription {
    fn drop(&mut self) {
        let mut state = self.queue.state.lock();
        let me = self.consumer.id;
        state.consumers.retain(|c| c.id != me);
        state.waiting.retain(|id| *id != me);
        state.holding.retain(|c| c.id != me);
        state.wake_next();
    }
}
