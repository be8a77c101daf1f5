//! Cache of message bodies that will probably be delivered soon, bounded by memory. A body that does
//! not fit is read from the file when needed.

use std::{collections::HashMap, sync::Arc};

use parking_lot::Mutex;

use crate::{elements, message::AnyMessage};

/// Estimated memory of a message beyond its bytes and elements: sections and the cache's own entry.
const OVERHEAD: u64 = size_of::<AnyMessage>() as u64 + 512;

/// Bodies by message id.
pub(crate) struct BodyCache {
    bytes_max: u64,
    state: Mutex<CacheState>,
}

#[derive(Default)]
struct CacheState {
    bytes: u64,
    /// Estimated size and message by id.
    messages: HashMap<i64, (u64, Arc<AnyMessage>)>,
}

impl BodyCache {
    pub(crate) fn new(bytes_max: u64) -> Self {
        Self { bytes_max, state: Mutex::default() }
    }

    /// Caches a message of so many encoded bytes if it fits; older ones are never evicted, they leave when
    /// settled.
    pub(crate) fn insert(&self, id: i64, bytes: u64, message: Arc<AnyMessage>) {
        let bytes = elements::memory(bytes, &message) + OVERHEAD;
        let mut state = self.state.lock();
        if state.bytes + bytes <= self.bytes_max
            && state.messages.insert(id, (bytes, message)).is_none()
        {
            state.bytes += bytes;
        }
    }

    pub(crate) fn get(&self, id: i64) -> Option<Arc<AnyMessage>> {
        self.state.lock().messages.get(&id).map(|(_, message)| Arc::clone(message))
    }

    pub(crate) fn contains(&self, id: i64) -> bool {
        self.state.lock().messages.contains_key(&id)
    }

    pub(crate) fn remove(&self, id: i64) {
        let mut state = self.state.lock();
        if let Some((bytes, _)) = state.messages.remove(&id) {
            state.bytes = state.bytes.saturating_sub(bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use fe2o3_amqp_types::messaging::{Body, Message};

    use super::*;

    #[test]
    fn the_cache_stops_at_its_bound() {
        let cache = BodyCache::new(25 + 2 * OVERHEAD);
        let message = Arc::new(Message::from(Body::Empty));
        for id in 1..=3 {
            cache.insert(id, 10, Arc::clone(&message));
        }
        assert!(cache.contains(1) && cache.contains(2) && !cache.contains(3));
        cache.remove(1);
        cache.remove(1);
        cache.insert(3, 10, message);
        assert!(cache.get(3).is_some());
    }
}
