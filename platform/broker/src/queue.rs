//! A queue in memory: the order of its ready messages, its leases, and its competing consumers.
//! Holds ids, never bodies.

mod subscription;

use std::{
    collections::{BTreeMap, HashSet, VecDeque},
    sync::Arc,
};

use parking_lot::Mutex;
use tokio::sync::Notify;

use crate::{address::QueueName, config::QueueOptions, status::QueueStatus};
pub(crate) use subscription::{Next, Subscription};

/// One message of a queue, without its body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct QueueEntry {
    /// Number given by the broker; the order of delivery.
    pub id: i64,
    pub bytes: u64,
    /// Expiry in Unix milliseconds.
    pub expires_at_ms: Option<i64>,
    /// Deliveries that failed; at the queue's maximum the message becomes a dead letter.
    pub delivery_count: u32,
    /// True when a consumer may have received it before.
    pub is_redelivered: bool,
}

/// Reason for which a queue accepts no message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum QueueRefusal {
    /// Its bound on messages or bytes is reached.
    Full,
    Deleted,
}

/// A queue shared by its publishers and consumers. All methods take one short lock.
#[derive(Debug)]
pub(crate) struct Queue {
    pub id: i64,
    pub name: QueueName,
    state: Mutex<QueueState>,
}

#[derive(Debug)]
struct QueueState {
    options: QueueOptions,
    ready: BTreeMap<i64, QueueEntry>,
    /// Messages delivered and not settled.
    leased: u64,
    /// Leased messages that are no longer stored, and do not become ready again.
    forgotten: HashSet<i64>,
    /// Reserved, ready and leased messages: what counts against the bounds.
    messages: u64,
    bytes: u64,
    /// Consumers in the order of their attach; the first is the active one.
    consumers: VecDeque<Consumer>,
    /// Ids of consumers that found nothing ready, the longest waiting first.
    waiting: VecDeque<u64>,
    /// Consumers that have leased a message and lack the credit to send it.
    holding: VecDeque<Consumer>,
    next_consumer: u64,
    is_deleted: bool,
}

#[derive(Debug, Clone)]
struct Consumer {
    id: u64,
    /// Notified when a message may be ready.
    wake: Arc<Notify>,
    /// Notified when another consumer could send the message that this one holds.
    give_way: Arc<Notify>,
}

impl Queue {
    pub(crate) fn new(id: i64, name: QueueName, options: QueueOptions) -> Self {
        let state = QueueState {
            options,
            ready: BTreeMap::new(),
            leased: 0,
            forgotten: HashSet::new(),
            messages: 0,
            bytes: 0,
            consumers: VecDeque::new(),
            waiting: VecDeque::new(),
            holding: VecDeque::new(),
            next_consumer: 0,
            is_deleted: false,
        };
        Self { id, name, state: Mutex::new(state) }
    }

    pub(crate) fn options(&self) -> QueueOptions {
        self.state.lock().options
    }

    pub(crate) fn set_options(&self, options: QueueOptions) {
        let mut state = self.state.lock();
        state.options = options;
        state.wake_next();
    }

    /// Returns the bytes of its messages.
    pub(crate) fn bytes(&self) -> u64 {
        self.state.lock().bytes
    }

    /// Reserves space for a message that a publisher has sent, before it is stored.
    pub(crate) fn reserve(&self, bytes: u64) -> Result<(), QueueRefusal> {
        let mut state = self.state.lock();
        if state.is_deleted {
            return Err(QueueRefusal::Deleted);
        }
        if state.messages + 1 > state.options.messages_max
            || state.bytes + bytes > state.options.bytes_max
        {
            return Err(QueueRefusal::Full);
        }
        // Counted before the write: several publishers must not exceed the bound together.
        state.messages += 1;
        state.bytes += bytes;
        Ok(())
    }

    /// Releases the reserved space of a message that was not stored.
    pub(crate) fn release_reservation(&self, bytes: u64) {
        let mut state = self.state.lock();
        state.messages = state.messages.saturating_sub(1);
        state.bytes = state.bytes.saturating_sub(bytes);
    }

    /// Adds stored messages whose space was reserved.
    pub(crate) fn add(&self, entries: impl IntoIterator<Item = QueueEntry>) {
        let mut state = self.state.lock();
        for entry in entries {
            state.ready.insert(entry.id, entry);
            state.wake_next();
        }
    }

    /// Adds a stored message without a reservation: loaded at the start, or moved from another queue.
    pub(crate) fn adopt(&self, entry: QueueEntry) {
        let mut state = self.state.lock();
        state.messages += 1;
        state.bytes += entry.bytes;
        state.ready.insert(entry.id, entry);
        state.wake_next();
    }

    /// Removes a ready message; none when it is leased or gone.
    pub(crate) fn withdraw(&self, id: i64) -> Option<QueueEntry> {
        let mut state = self.state.lock();
        let entry = state.ready.remove(&id)?;
        state.uncount(&entry);
        Some(entry)
    }

    /// Removes a message that is no longer stored; one that is leased once its consumer gives it back.
    pub(crate) fn forget(&self, id: i64) {
        let mut state = self.state.lock();
        if let Some(entry) = state.ready.remove(&id) {
            state.uncount(&entry);
        } else if state.leased > 0 {
            state.forgotten.insert(id);
        }
    }

    /// Removes and returns the ready messages that have expired.
    pub(crate) fn withdraw_expired(&self, now_ms: i64) -> Vec<QueueEntry> {
        let mut state = self.state.lock();
        let expired: Vec<_> = state
            .ready
            .values()
            .filter(|e| e.expires_at_ms.is_some_and(|at| at <= now_ms))
            .copied()
            .collect();
        for entry in &expired {
            state.ready.remove(&entry.id);
            state.uncount(entry);
        }
        expired
    }

    /// Removes and returns the oldest ready messages beyond either bound.
    pub(crate) fn withdraw_beyond(&self, messages_max: u64, bytes_max: u64) -> Vec<QueueEntry> {
        let mut state = self.state.lock();
        let mut gone = Vec::new();
        while state.ready.len() as u64 > messages_max || state.bytes > bytes_max {
            let Some((_, entry)) = state.ready.pop_first() else { break };
            state.uncount(&entry);
            gone.push(entry);
        }
        gone
    }

    /// Returns ids of ready messages from `first` on: those that will probably be delivered next, as far as
    /// they have no more than `bytes_max` together.
    pub(crate) fn upcoming(&self, first: i64, limit: usize, bytes_max: u64) -> Vec<i64> {
        let state = self.state.lock();
        let mut bytes = 0;
        let fits = |entry: &&QueueEntry| {
            bytes += entry.bytes;
            bytes <= bytes_max
        };
        let upcoming = state.ready.range(first..).take(limit).map(|(_, entry)| entry);
        upcoming.take_while(fits).map(|entry| entry.id).collect()
    }

    /// Removes a leased message for good.
    pub(crate) fn settle(&self, entry: &QueueEntry) {
        let mut state = self.state.lock();
        state.give_back(entry.id);
        state.uncount(entry);
    }

    /// Makes a leased message ready again, in its old position; removes it where it was forgotten.
    pub(crate) fn requeue(&self, entry: QueueEntry) {
        let mut state = self.state.lock();
        if state.give_back(entry.id) {
            return state.uncount(&entry);
        }
        state.ready.insert(entry.id, entry);
        state.wake_next();
    }

    /// Ends the queue and wakes its consumers. Returns the number of its messages.
    pub(crate) fn delete(&self) -> u64 {
        let mut state = self.state.lock();
        state.is_deleted = true;
        state.ready.clear();
        for consumer in &state.consumers {
            consumer.wake.notify_one();
        }
        state.messages
    }

    pub(crate) fn status(&self) -> QueueStatus {
        let state = self.state.lock();
        QueueStatus {
            queue: self.name.clone(),
            ready: state.ready.len() as u64,
            unsettled: state.leased,
            bytes: state.bytes,
            consumers: state.consumers.len() as u64,
        }
    }
}

impl QueueState {
    /// Ends the lease of a message; returns true where it was forgotten meanwhile.
    fn give_back(&mut self, id: i64) -> bool {
        self.leased = self.leased.saturating_sub(1);
        let is_forgotten = self.forgotten.remove(&id);
        if self.leased == 0 {
            // One that was settled before it was forgotten does not come back.
            self.forgotten.clear();
        }
        is_forgotten
    }

    /// Takes a removed message off the bounds.
    fn uncount(&mut self, entry: &QueueEntry) {
        self.messages = self.messages.saturating_sub(1);
        self.bytes = self.bytes.saturating_sub(entry.bytes);
    }

    fn may_receive(&self, consumer: u64) -> bool {
        !self.options.is_single_active_consumer
            || self.consumers.front().is_some_and(|c| c.id == consumer)
    }

    /// Wakes the consumer that has waited longest, if a message is ready for it.
    fn wake_next(&mut self) {
        if self.ready.is_empty() {
            return;
        }
        // One consumer for one message: all others would wake to find nothing.
        let Some(at) = self.waiting.iter().position(|id| self.may_receive(*id)) else { return };
        let Some(id) = self.waiting.remove(at) else { return };
        if let Some(consumer) = self.consumers.iter().find(|c| c.id == id) {
            consumer.wake.notify_one();
        }
    }
}

#[cfg(test)]
mod tests;
