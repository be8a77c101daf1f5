//! Keep-alives that wait to be sent. They are never stored.

use std::{collections::BTreeMap, ops::Bound};

use asi_model::MessageId;
use connector_state::{KeepAliveBody, use_cases::keep_alive::KeepAlive};
use messaging::spool::Fetch;
use parking_lot::Mutex;

/// Most keep-alives that wait; beyond, the oldest are dropped. Newer ones say the same of a writer.
const WAITING_MAX: usize = 65_536;

/// Queue between the coordinator, which makes keep-alives, and the link, which sends them.
#[derive(Default)]
pub struct KeepAliveQueue(Mutex<BTreeMap<i64, (MessageId, KeepAliveBody)>>);

impl KeepAliveQueue {
    /// Queues a keep-alive.
    pub fn put(&self, message: KeepAlive) {
        let mut waiting = self.0.lock();
        waiting.insert(message.row, (message.message_id, message.body));
        while waiting.len() > WAITING_MAX {
            waiting.pop_first();
        }
    }

    /// Removes a keep-alive that was sent, or never will be.
    pub fn remove(&self, row: i64) {
        self.0.lock().remove(&row);
    }

    /// Returns the keep-alives in the range that the link asks for, in order.
    #[must_use]
    pub fn fetch(&self, fetch: Fetch) -> Vec<KeepAlive> {
        let through = fetch.through.map_or(i64::MAX, |id| id.0);
        let waiting = self.0.lock();
        let range = waiting.range((Bound::Excluded(fetch.after.0), Bound::Included(through)));
        range
            .take(fetch.limit)
            .map(|(row, (message_id, body))| KeepAlive {
                row: *row,
                message_id: message_id.clone(),
                body: body.clone(),
            })
            .collect()
    }
}
