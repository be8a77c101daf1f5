//! Subscriptions of a session, each filled up to the server's limits.

use std::{sync::Arc, time::Duration};

use opcua_stack::limits;

use crate::{
    ShopFloorError, SourceConfig,
    source::{
        connection::Connection,
        notification_sink::{NotificationSink, SubscriptionListener},
    },
};

/// Least time without publish requests after which a server deletes a subscription.
const SUBSCRIPTION_LIFETIME: Duration = Duration::from_secs(30);

pub(super) struct SubscriptionPool {
    connection: Connection,
    sink: Arc<NotificationSink>,
    config: SourceConfig,
    subscriptions: Vec<Subscription>,
    /// The server takes no more items.
    is_server_full: bool,
}

struct Subscription {
    id: u32,
    /// Index of its listener in the notification sink.
    listener: usize,
    items: usize,
    capacity: usize,
    /// Most items that may still fit, after the server refused a request with more.
    room_guess: usize,
}

impl SubscriptionPool {
    pub(super) fn new(
        connection: Connection,
        sink: Arc<NotificationSink>,
        config: SourceConfig,
    ) -> Self {
        Self { connection, sink, config, subscriptions: Vec::new(), is_server_full: false }
    }

    pub(super) fn is_server_full(&self) -> bool {
        self.is_server_full
    }

    /// Assumes that the server has room again.
    pub(super) fn reset_server_full(&mut self) {
        self.is_server_full = false;
    }

    /// Returns the server's id of a subscription.
    pub(super) fn id(&self, index: usize) -> u32 {
        self.subscriptions[index].id
    }

    /// Returns the number of items that may fit into a subscription.
    pub(super) fn room(&self, index: usize) -> usize {
        let subscription = &self.subscriptions[index];
        (subscription.capacity - subscription.items).min(subscription.room_guess)
    }

    /// Returns the index of a subscription that takes another item; creates one if needed. Returns
    /// `None` when the server refuses another subscription.
    pub(super) async fn with_room(&mut self) -> Result<Option<usize>, ShopFloorError> {
        let has_room = |known: &Subscription| known.items < known.capacity;
        if let Some(index) = self.subscriptions.iter().position(has_room) {
            return Ok(Some(index));
        }
        let interval = self.config.publishing_interval();
        let count = |duration: Duration| {
            (duration.as_secs_f64() / interval.as_secs_f64()).ceil().max(1.0) as u32
        };
        let keep_alive_count = count(self.config.silence_max() / 3);
        // A lifetime shorter than three keep-alives is not allowed (OPC 10000-4 §5.14.2).
        let lifetime_count = count(SUBSCRIPTION_LIFETIME).max(keep_alive_count.saturating_mul(3));
        let listener = self.sink.add_listener();
        let created = self.connection.session().create_subscription(
            interval,
            lifetime_count,
            keep_alive_count,
            0,
            0,
            true,
            SubscriptionListener::new(Arc::clone(&self.sink), listener),
        );
        match self.connection.request(created).await {
            Ok(id) => {
                let limit = self.connection.limits().items_per_subscription_max;
                let limit =
                    limit.and_then(|limit| usize::try_from(limit).ok()).unwrap_or(usize::MAX);
                let capacity = limits::ITEMS_PER_SUBSCRIPTION.min(limit).max(1);
                let room_guess = usize::MAX;
                self.subscriptions.push(Subscription {
                    id,
                    listener,
                    items: 0,
                    capacity,
                    room_guess,
                });
                Ok(Some(self.subscriptions.len() - 1))
            }
            Err(ShopFloorError::Refused { status }) => {
                tracing::warn!(source.id = %self.config.source_id, %status,
                    "A server refuses another subscription.");
                self.is_server_full = true;
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    pub(super) fn add_item(&mut self, index: usize) {
        self.subscriptions[index].items += 1;
        self.sink.expect_messages(self.subscriptions[index].listener);
    }

    pub(super) fn remove_items(&mut self, index: usize, count: usize) {
        let subscription = &mut self.subscriptions[index];
        subscription.items -= count;
        subscription.room_guess = usize::MAX;
    }

    /// Records that a request of `count` items was refused because not all of them fit.
    pub(super) fn set_room_below(&mut self, index: usize, count: usize) {
        self.subscriptions[index].room_guess = count / 2;
    }

    /// Records that a subscription takes no more items.
    pub(super) fn set_full(&mut self, index: usize) {
        let subscription = &mut self.subscriptions[index];
        // When even an empty one takes nothing, the limit is the session's or the server's.
        self.is_server_full = subscription.items == 0;
        subscription.capacity = subscription.items;
    }
}
