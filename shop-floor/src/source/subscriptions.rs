//! The monitored items of one session: wanted against actual, within the server's limits.

mod create;
mod request;

use std::{
    collections::HashMap,
    sync::Arc,
    time::{Duration, Instant},
};

use super::{
    Connection, connection::per_request, entry::Entry, feed::Feed, life::Memory,
    services::parse_range,
};
use crate::{InputKey, MonitorRequest, ShopFloorError, SourceConfig, outbox::Outbox};

/// All subscriptions of a session; the only owner of them.
pub(super) struct Subscriptions {
    entry: Arc<Entry>,
    connection: Connection,
    feed: Arc<Feed>,
    outbox: Outbox,
    config: SourceConfig,
    subscriptions: Vec<Subscription>,
    items: HashMap<InputKey, Item>,
    /// Items per request; halved when the server chokes.
    chunk: usize,
    /// When something that the server refused is to be tried again.
    next_retry: Option<Instant>,
    /// Set when the server has no room for any more items.
    is_server_full: bool,
}

struct Subscription {
    id: u32,
    /// Its place in the feed.
    place: usize,
    items: usize,
    capacity: usize,
    /// How many more may fit at most, after more were refused together.
    room_guess: usize,
}

enum Item {
    Monitored { request: Arc<MonitorRequest>, subscription: usize, item_id: u32, handle: u32 },
    Refused { request: Arc<MonitorRequest>, retry_at: Instant, attempts: u32 },
}

impl Subscriptions {
    pub(super) fn new(
        entry: Arc<Entry>,
        connection: Connection,
        feed: Arc<Feed>,
        outbox: Outbox,
        config: SourceConfig,
    ) -> Self {
        let chunk = per_request(connection.limits().items_per_call_max);
        Self {
            entry,
            connection,
            feed,
            outbox,
            config,
            subscriptions: Vec::new(),
            items: HashMap::new(),
            chunk,
            next_retry: None,
            is_server_full: false,
        }
    }

    /// The requests that are live and might need their browse path learned.
    pub(super) fn monitored(&self) -> impl Iterator<Item = &Arc<MonitorRequest>> {
        self.items.values().filter_map(|item| match item {
            Item::Monitored { request, .. } => Some(request),
            Item::Refused { .. } => None,
        })
    }

    /// The node that an input asks for, while it is monitored.
    pub(super) fn node_of(&self, input: InputKey) -> Option<asi_model::NodeId> {
        match self.items.get(&input) {
            Some(Item::Monitored { request, .. }) if request.options.index_range.is_none() => {
                Some(request.node_id.clone())
            }
            _ => None,
        }
    }

    /// How fast an input is sampled at most; older values than this may be looked at by the audit.
    pub(super) fn sampling_of(&self, input: InputKey) -> Duration {
        match self.items.get(&input) {
            Some(Item::Monitored { request, .. }) => Duration::from_secs_f64(
                request::sampling_ms(&request.options, self.publishing_ms()) / 1000.0,
            ),
            _ => Duration::ZERO,
        }
    }

    /// Brings the items to what is wanted: `changed` inputs with their requests, `None` where not
    /// wanted any more.
    pub(super) async fn apply(
        &mut self,
        changed: Vec<(InputKey, Option<Arc<MonitorRequest>>)>,
        memory: &mut Memory,
    ) -> Result<(), ShopFloorError> {
        let mut to_delete = Vec::new();
        let mut to_create = Vec::new();
        for (input, wanted) in changed {
            if let (Some(Item::Monitored { request, .. }), Some(wanted)) =
                (self.items.get(&input), &wanted)
                && request == wanted
            {
                continue;
            }
            to_delete.extend(self.items.remove(&input));
            if wanted.is_none() {
                self.entry.note([(input, None)]);
            }
            to_create.extend(wanted.map(|request| (request, 0)));
        }
        self.delete(to_delete).await?;
        self.create(to_create, memory).await
    }

    /// True when it is time to try something again that the server refused.
    pub(super) fn is_retry_due(&self) -> bool {
        self.next_retry.is_some_and(|at| at <= Instant::now())
    }

    /// Tries again what the server refused, where it is time.
    pub(super) async fn retry(&mut self, memory: &mut Memory) -> Result<(), ShopFloorError> {
        let now = Instant::now();
        let mut due = Vec::new();
        self.next_retry = None;
        for item in self.items.values() {
            let Item::Refused { request, retry_at, attempts } = item else { continue };
            if *retry_at <= now {
                due.push((Arc::clone(request), *attempts));
            } else {
                self.next_retry =
                    Some(self.next_retry.map_or(*retry_at, |next| next.min(*retry_at)));
            }
        }
        self.is_server_full = false;
        self.create(due, memory).await
    }

    /// Deletes all items before the session is closed: servers exist that leak what is deleted with
    /// its subscription.
    pub(super) async fn delete_all(&mut self) -> Result<(), ShopFloorError> {
        let items = self.items.drain().map(|(_, item)| item).collect();
        self.delete(items).await
    }

    async fn delete(&mut self, items: Vec<Item>) -> Result<(), ShopFloorError> {
        let mut by_subscription: HashMap<usize, Vec<(u32, u32)>> = HashMap::new();
        for item in items {
            if let Item::Monitored { subscription, item_id, handle, .. } = item {
                by_subscription.entry(subscription).or_default().push((item_id, handle));
            }
        }
        for (index, items) in by_subscription {
            let subscription = &mut self.subscriptions[index];
            subscription.items -= items.len();
            subscription.room_guess = usize::MAX;
            let id = subscription.id;
            for chunk in items.chunks(self.chunk) {
                let ids: Vec<_> = chunk.iter().map(|(item_id, _)| *item_id).collect();
                let deleted = self
                    .connection
                    .ask(self.connection.session().delete_monitored_items(id, &ids))
                    .await;
                for (_, handle) in chunk {
                    self.feed.release(*handle);
                }
                // Single refusals mean that the item was gone already.
                deleted?;
            }
        }
        Ok(())
    }

    fn publishing_ms(&self) -> f64 {
        self.config.publishing_interval().as_secs_f64() * 1000.0
    }
}
