//! Creating items: in chunks that the server takes, in subscriptions with room, and by browse path
//! where an id is gone.

use std::{
    collections::VecDeque,
    sync::Arc,
    time::{Duration, Instant},
};

use asi_model::values::DataValue;
use opcua_stack::{
    limits,
    opcua::{
        client::{UARequest as _, services::CreateMonitoredItems},
        types::{NodeId, StatusCode, TimestampsToReturn},
    },
    values::{node_id_to_stack, status_from_stack},
};

use super::{
    super::{feed::Listener, life::Memory, now, paths, services::is_gone},
    Item, Subscription, Subscriptions, request,
};
use crate::{InputChange, MonitorRequest, ShopFloorError};

/// First and longest pause before an input that the server refused is tried again.
const RETRY_MIN: Duration = Duration::from_secs(2);
const RETRY_MAX: Duration = Duration::from_secs(60);
/// After how many publishing intervals without requests a server deletes a subscription, at least
/// this long.
const SUBSCRIPTION_LIFE: Duration = Duration::from_secs(30);

/// An item that is to be created.
struct Candidate {
    request: Arc<MonitorRequest>,
    node_id: NodeId,
    /// The node id was found by the browse path, there is nothing more to try.
    is_found_by_path: bool,
    attempts: u32,
}

/// A request whose node the server does not know.
struct Lost {
    request: Arc<MonitorRequest>,
    attempts: u32,
    status: StatusCode,
    reason: String,
}

/// What became of an item of a request.
enum Outcome {
    Created { item_id: u32, handle: u32 },
    Refused(StatusCode),
}

impl Subscriptions {
    pub(super) async fn create(
        &mut self,
        requests: Vec<(Arc<MonitorRequest>, u32)>,
        memory: &mut Memory,
    ) -> Result<(), ShopFloorError> {
        let mut queue = VecDeque::new();
        let mut lost = Vec::new();
        let namespaces = self.connection.namespaces();
        for (request, attempts) in requests {
            let found = memory.moved.get(&request.node_id).cloned();
            let is_found_by_path = found.is_some();
            match found.map_or_else(|| node_id_to_stack(&request.node_id, &namespaces), Ok) {
                Ok(node_id) => {
                    queue.push_back(Candidate { request, node_id, is_found_by_path, attempts })
                }
                Err(error) => {
                    let status = StatusCode::BadNodeIdUnknown;
                    lost.push(Lost { request, attempts, status, reason: error.to_string() });
                }
            }
        }
        self.create_queued(&mut queue, &mut lost).await?;
        let mut found = self.find_by_path(lost, memory).await?;
        let mut still_lost = Vec::new();
        self.create_queued(&mut found, &mut still_lost).await?;
        for Lost { request, attempts, status, reason } in still_lost {
            self.refuse(request, attempts, status, reason);
        }
        Ok(())
    }

    /// Creates what is queued. What the server does not know (any more) and was not found by its
    /// path ends in `lost`.
    async fn create_queued(
        &mut self,
        queue: &mut VecDeque<Candidate>,
        lost: &mut Vec<Lost>,
    ) -> Result<(), ShopFloorError> {
        while !queue.is_empty() {
            if self.is_server_full {
                let reason = "the server's limit of monitored items is reached; raise it there or monitor less";
                for candidate in queue.drain(..) {
                    let status = StatusCode::BadTooManyMonitoredItems;
                    self.refuse(candidate.request, candidate.attempts, status, reason.into());
                }
                return Ok(());
            }
            let Some(index) = self.subscription_with_room().await? else { continue };
            let subscription = &self.subscriptions[index];
            let room = subscription.capacity - subscription.items;
            let count = self.chunk.min(queue.len()).min(room).min(subscription.room_guess);
            let chunk: Vec<_> = queue.drain(..count).collect();
            let outcomes = match self.request_items(index, &chunk).await {
                Ok(outcomes) => outcomes,
                // Some servers refuse all items of a request that has more than there is room for.
                Err(ShopFloorError::Refused { status })
                    if StatusCode::from(status.0) == StatusCode::BadTooManyMonitoredItems
                        && count > 1 =>
                {
                    self.subscriptions[index].room_guess = count / 2;
                    for candidate in chunk.into_iter().rev() {
                        queue.push_front(candidate);
                    }
                    continue;
                }
                Err(error) if request::is_choking(&error) && self.chunk > 1 => {
                    self.chunk = (count / 2).max(1);
                    tracing::info!(source.id = %self.entry.id, chunk = self.chunk, %error,
                        "A server cannot take so many items at once; fewer are sent.");
                    for candidate in chunk.into_iter().rev() {
                        queue.push_front(candidate);
                    }
                    continue;
                }
                Err(ShopFloorError::Refused { status }) => {
                    let status = StatusCode::from(status.0);
                    chunk.iter().map(|_| Outcome::Refused(status)).collect()
                }
                Err(error) => return Err(error),
            };
            self.settle(index, chunk, outcomes, queue, lost);
        }
        Ok(())
    }

    /// Sends one request for items. Handles are released again for those that were not created.
    async fn request_items(
        &self,
        index: usize,
        chunk: &[Candidate],
    ) -> Result<Vec<Outcome>, ShopFloorError> {
        let handles: Vec<_> =
            chunk.iter().map(|candidate| self.feed.reserve(candidate.request.input)).collect();
        let publishing_ms = self.publishing_ms();
        let requests = chunk
            .iter()
            .zip(&handles)
            .map(|(candidate, handle)| {
                request::item(
                    candidate.node_id.clone(),
                    &candidate.request.options,
                    *handle,
                    publishing_ms,
                )
            })
            .collect();
        let session = self.connection.session();
        // Past the session's own list of items, which would keep all of it once more: the feed
        // knows the handles.
        let request = CreateMonitoredItems::new(self.subscriptions[index].id, session)
            .timestamps_to_return(TimestampsToReturn::Both)
            .items_to_create(requests);
        let created = match self.connection.ask(request.send(session.channel())).await {
            Ok(created) => created.results,
            Err(error) => {
                handles.into_iter().for_each(|handle| self.feed.release(handle));
                return Err(error);
            }
        };
        let outcome = |(result, handle): (StatusCode, u32), item_id| {
            if result.is_good() {
                Outcome::Created { item_id, handle }
            } else {
                self.feed.release(handle);
                Outcome::Refused(result)
            }
        };
        Ok(created
            .into_iter()
            .zip(handles)
            .map(|(item, handle)| {
                outcome((item.result.status_code, handle), item.result.monitored_item_id)
            })
            .collect())
    }

    /// Notes what became of each item of a request.
    fn settle(
        &mut self,
        index: usize,
        chunk: Vec<Candidate>,
        outcomes: Vec<Outcome>,
        queue: &mut VecDeque<Candidate>,
        lost: &mut Vec<Lost>,
    ) {
        let mut is_full = false;
        for (candidate, outcome) in chunk.into_iter().zip(outcomes) {
            match outcome {
                Outcome::Created { item_id, handle } => {
                    self.subscriptions[index].items += 1;
                    self.feed.expect(self.subscriptions[index].place);
                    let request = candidate.request;
                    self.entry.note([(request.input, None)]);
                    let item = Item::Monitored {
                        request: Arc::clone(&request),
                        subscription: index,
                        item_id,
                        handle,
                    };
                    self.items.insert(request.input, item);
                }
                Outcome::Refused(StatusCode::BadTooManyMonitoredItems) => {
                    is_full = true;
                    queue.push_back(candidate);
                }
                Outcome::Refused(status) if is_gone(status) && !candidate.is_found_by_path => {
                    let reason = format!("the server does not know this node: {status}");
                    lost.push(Lost {
                        request: candidate.request,
                        attempts: candidate.attempts,
                        status,
                        reason,
                    });
                }
                Outcome::Refused(status) => {
                    let reason = format!("the server refuses to monitor this node: {status}");
                    self.refuse(candidate.request, candidate.attempts, status, reason);
                }
            }
        }
        if is_full {
            let subscription = &mut self.subscriptions[index];
            // An empty subscription that takes nothing: the limit is the session's or the server's.
            self.is_server_full = subscription.items == 0;
            subscription.capacity = subscription.items;
        }
    }

    /// A subscription that takes another item; made where there is none. `None` after it was found
    /// that there is no room at all.
    async fn subscription_with_room(&mut self) -> Result<Option<usize>, ShopFloorError> {
        if let Some(index) =
            self.subscriptions.iter().position(|known| known.items < known.capacity)
        {
            return Ok(Some(index));
        }
        let interval = self.config.publishing_interval();
        let keep_alive = self.config.silence_max() / 3;
        let count = |duration: Duration| {
            (duration.as_secs_f64() / interval.as_secs_f64()).ceil().max(1.0) as u32
        };
        let keep_alive_count = count(keep_alive);
        let life_count = count(SUBSCRIPTION_LIFE).max(keep_alive_count.saturating_mul(3));
        let place = self.feed.add_subscription();
        let listener = Listener::new(Arc::clone(&self.feed), place);
        let session = self.connection.session();
        let created = session.create_subscription(
            interval,
            life_count,
            keep_alive_count,
            0,
            0,
            true,
            listener,
        );
        match self.connection.ask(created).await {
            Ok(id) => {
                let limit = self.connection.limits().items_per_subscription_max;
                let limit =
                    limit.and_then(|limit| usize::try_from(limit).ok()).unwrap_or(usize::MAX);
                let capacity = limits::ITEMS_PER_SUBSCRIPTION.min(limit).max(1);
                self.subscriptions.push(Subscription {
                    id,
                    place,
                    items: 0,
                    capacity,
                    room_guess: usize::MAX,
                });
                Ok(Some(self.subscriptions.len() - 1))
            }
            Err(ShopFloorError::Refused { status }) => {
                tracing::warn!(source.id = %self.entry.id, %status, "A server refuses another subscription.");
                self.is_server_full = true;
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// Looks for lost nodes at their browse paths.
    async fn find_by_path(
        &mut self,
        lost: Vec<Lost>,
        memory: &mut Memory,
    ) -> Result<VecDeque<Candidate>, ShopFloorError> {
        let mut with_path = Vec::new();
        for lost in lost {
            match memory.path_of(&lost.request) {
                Some(path) => with_path.push((lost, path)),
                None => self.refuse(lost.request, lost.attempts, lost.status, lost.reason),
            }
        }
        let paths: Vec<_> = with_path.iter().map(|(_, path)| path.clone()).collect();
        let found = paths::translate(&self.connection, &paths).await?;
        let mut queue = VecDeque::new();
        for ((lost, path), targets) in with_path.into_iter().zip(found) {
            if let Some(node_id) = targets.into_iter().next() {
                tracing::info!(source.id = %self.entry.id, node.id = %lost.request.node_id, path = %path,
                    "A node was found again at its browse path under another id.");
                memory.moved.insert(lost.request.node_id.clone(), node_id.clone());
                let Lost { request, attempts, .. } = lost;
                queue.push_back(Candidate { request, node_id, is_found_by_path: true, attempts });
            } else {
                let reason =
                    format!("{}; nothing is at its browse path {path} either", lost.reason);
                self.refuse(lost.request, lost.attempts, lost.status, reason);
            }
        }
        Ok(queue)
    }

    /// The input stays without value; its status says why, and it is tried again later.
    fn refuse(
        &mut self,
        request: Arc<MonitorRequest>,
        attempts: u32,
        status: StatusCode,
        reason: String,
    ) {
        let status = status_from_stack(status);
        let input = request.input;
        self.entry.note([(input, Some((status, reason)))]);
        if attempts == 0 {
            self.outbox.push(vec![InputChange {
                input,
                value: DataValue::status_only(status, Some(now())),
            }]);
        }
        let pause = RETRY_MIN.saturating_mul(1 << attempts.min(10)).min(RETRY_MAX);
        let retry_at = Instant::now() + pause;
        self.next_retry = Some(self.next_retry.map_or(retry_at, |next| next.min(retry_at)));
        let item = Item::Refused { request, retry_at, attempts: attempts.saturating_add(1) };
        self.items.insert(input, item);
    }
}
