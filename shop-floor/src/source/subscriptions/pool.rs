//! Subscriptions of a session, each filled up to the server's limits.

use std::{sync::Arc, time::Duration};

use opcua_stack::limits;

use super::grant::SubscriptionGrant;
use crate::{
    ShopFloorError, SourceConfig,
    source::{
        connection::Connection,
        notification_sink::{NotificationSink, SubscriptionListener},
        record::SourceRecord,
    },
};

pub(super) struct SubscriptionPool {
    connection: Connection,
    sink: Arc<NotificationSink>,
    record: Arc<SourceRecord>,
    config: SourceConfig,
    /// Publishing interval that the server granted before, so that others are requested at it.
    granted_interval: Option<Duration>,
    subscriptions: Vec<Subscription>,
    /// The server takes no more items.
    is_server_full: bool,
}

struct Subscription {
    id: u32,
    /// Index of its listener in the notification sink.
    listener: usize,
    grant: SubscriptionGrant,
    items: usize,
    capacity: usize,
    /// Most items that may still fit, after the server refused a request with more.
    room_guess: usize,
}

impl SubscriptionPool {
    pub(super) fn new(
        connection: Connection,
        sink: Arc<NotificationSink>,
        record: Arc<SourceRecord>,
        config: SourceConfig,
    ) -> Self {
        Self {
            connection,
            sink,
            record,
            config,
            granted_interval: None,
            subscriptions: Vec::new(),
            is_server_full: false,
        }
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

    /// Returns what the server granted a subscription.
    pub(super) fn grant(&self, index: usize) -> SubscriptionGrant {
        self.subscriptions[index].grant
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
        let listener = self.sink.add_listener();
        match self.create(listener).await {
            Ok((id, grant)) => {
                let silence_limit = grant.silence_limit(self.config.silence_max());
                self.sink.set_silence_limit(listener, silence_limit);
                self.granted_interval = Some(grant.interval);
                self.record.set_granted(grant.interval, grant.keep_alive(), silence_limit);
                let limit = self.connection.limits().items_per_subscription_max;
                let limit =
                    limit.and_then(|limit| usize::try_from(limit).ok()).unwrap_or(usize::MAX);
                let capacity = limits::ITEMS_PER_SUBSCRIPTION.min(limit).max(1);
                self.subscriptions.push(Subscription {
                    id,
                    listener,
                    grant,
                    items: 0,
                    capacity,
                    room_guess: usize::MAX,
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

    /// Creates a subscription. One whose signs of life would come much more rarely than is wanted, because
    /// the server publishes more slowly than was requested, is created once more at the interval that the
    /// server granted: not all servers can modify one.
    async fn create(&self, listener: usize) -> Result<(u32, SubscriptionGrant), ShopFloorError> {
        let silence_max = self.config.silence_max();
        let interval = self.granted_interval.unwrap_or_else(|| self.config.publishing_interval());
        let (id, grant) = self.request(listener, interval).await?;
        if grant.interval == interval || !grant.is_quieter_than_wanted(silence_max) {
            return Ok((id, grant));
        }
        let deleted = self.connection.session().delete_subscription(id);
        match self.connection.request(deleted).await {
            Ok(_) | Err(ShopFloorError::Refused { .. }) => {}
            Err(error) => return Err(error),
        }
        self.request(listener, grant.interval).await
    }

    async fn request(
        &self,
        listener: usize,
        interval: Duration,
    ) -> Result<(u32, SubscriptionGrant), ShopFloorError> {
        let request = SubscriptionGrant::request(interval, self.config.silence_max());
        let session = self.connection.session();
        let created = session.create_subscription(
            request.interval,
            request.lifetime_count(),
            request.keep_alive_count,
            0,
            0,
            true,
            SubscriptionListener::new(Arc::clone(&self.sink), listener),
        );
        let id = self.connection.request(created).await?;
        let state = session.subscription_state().lock();
        let grant = state.get(id).map_or(request, |known| SubscriptionGrant {
            // Zero would be "as fast as possible", which no server means.
            interval: known.publishing_interval().max(Duration::from_millis(1)),
            keep_alive_count: known.max_keep_alive_count().max(1),
        });
        Ok((id, grant))
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
