//! Creation of monitored items: in requests that the server takes, in subscriptions with room, and
//! at the browse path where a node id is unknown.

use std::{collections::VecDeque, sync::Arc};

use opcua_stack::{
    opcua::{
        client::{UARequest as _, services::CreateMonitoredItems},
        types::{
            EventFilter, EventFilterResult, ExtensionObject, NodeId, StatusCode, TimestampsToReturn,
        },
    },
    values::{node_id_to_stack, status_from_stack},
};

use super::{
    gaps::ItemGap,
    item_request,
    items::{Attempt, Items},
    pool::SubscriptionPool,
};
use crate::{
    MonitorRequest, ShopFloorError,
    source::{
        connection::Connection,
        events::event_filter,
        memory::SourceMemory,
        notification_sink::NotificationSink,
        record::{GrantedItem, SourceRecord},
        services::translate,
    },
};

/// One run that creates items, with all that it reads and changes.
pub(super) struct ItemCreation<'a> {
    pub(super) record: &'a SourceRecord,
    pub(super) connection: &'a Connection,
    pub(super) sink: &'a NotificationSink,
    pub(super) sampling_ms: f64,
    pub(super) items: &'a mut Items,
    pub(super) pool: &'a mut SubscriptionPool,
    pub(super) items_per_request: &'a mut usize,
    pub(super) memory: &'a mut SourceMemory,
    /// Gaps in the values of the items that were created.
    pub(super) gaps: &'a mut Vec<ItemGap>,
}

/// Item that is to be created at a node.
struct PendingItem {
    attempt: Attempt,
    node_id: NodeId,
    /// Filter of an item that takes events.
    filter: Option<EventFilter>,
    /// The node was found at the browse path: there is nothing more to try.
    is_found_by_path: bool,
}

/// Request whose node the server does not know.
struct MissingNode {
    attempt: Attempt,
    filter: Option<EventFilter>,
    status: StatusCode,
    reason: String,
}

/// Outcome of one item in a request.
enum ItemOutcome {
    Created {
        item_id: u32,
        handle: u32,
        intervals: GrantedItem,
        /// Status of a field of the events that the server does not know.
        unknown_field: Option<StatusCode>,
    },
    Refused(StatusCode),
}

impl ItemCreation<'_> {
    /// Creates the items, or records why the server refuses them.
    pub(super) async fn run(mut self, attempts: Vec<Attempt>) -> Result<(), ShopFloorError> {
        let mut queue = VecDeque::new();
        let mut missing = Vec::new();
        let namespaces = self.connection.namespaces();
        for attempt in attempts {
            let filter = match self.filter_of(&attempt.request) {
                Ok(filter) => filter,
                Err(reason) => {
                    self.items.add_refused(attempt, StatusCode::BadNodeIdUnknown, reason);
                    continue;
                }
            };
            let node = &attempt.request.node_id;
            let relocated = self.memory.relocated(node).cloned();
            let is_found_by_path = relocated.is_some();
            match relocated.map_or_else(|| node_id_to_stack(node, &namespaces), Ok) {
                Ok(node_id) => {
                    queue.push_back(PendingItem { attempt, node_id, filter, is_found_by_path });
                }
                Err(error) => {
                    let (status, reason) = (StatusCode::BadNodeIdUnknown, error.to_string());
                    missing.push(MissingNode { attempt, filter, status, reason });
                }
            }
        }
        self.create_queued(&mut queue, &mut missing).await?;
        let mut found = self.find_by_path(missing).await?;
        let mut still_missing = Vec::new();
        self.create_queued(&mut found, &mut still_missing).await?;
        for MissingNode { attempt, status, reason, .. } in still_missing {
            self.items.add_refused(attempt, status, reason);
        }
        Ok(())
    }

    /// Returns the filter of a request for events, or the reason why the server cannot have such events.
    fn filter_of(&self, request: &MonitorRequest) -> Result<Option<EventFilter>, String> {
        let events = request.options.events.as_ref();
        let filter = events.map(|events| event_filter(events, &self.connection.namespaces()));
        filter.transpose().map_err(|error| format!("the events cannot be selected: {error}"))
    }

    /// Creates the queued items. Those whose node the server does not know end in `missing`, unless
    /// the node was found at its path.
    async fn create_queued(
        &mut self,
        queue: &mut VecDeque<PendingItem>,
        missing: &mut Vec<MissingNode>,
    ) -> Result<(), ShopFloorError> {
        while !queue.is_empty() {
            if self.pool.is_server_full() {
                self.refuse_all(queue);
                return Ok(());
            }
            let Some(index) = self.pool.with_room().await? else { continue };
            let count = (*self.items_per_request).min(queue.len()).min(self.pool.room(index));
            let chunk: Vec<_> = queue.drain(..count).collect();
            let outcomes = match self.request_items(index, &chunk).await {
                Ok(outcomes) => outcomes,
                // Some servers refuse all items of a request that has more than there is room for.
                Err(ShopFloorError::Refused { status })
                    if StatusCode::from(status.0) == StatusCode::BadTooManyMonitoredItems
                        && count > 1 =>
                {
                    self.pool.set_room_below(index, count);
                    requeue(queue, chunk);
                    continue;
                }
                Err(error) if item_request::is_too_large(&error) && *self.items_per_request > 1 => {
                    *self.items_per_request = (count / 2).max(1);
                    tracing::info!(source.id = %self.record.id, chunk = *self.items_per_request,
                        %error, "A server cannot take so many items at once; fewer are sent.");
                    requeue(queue, chunk);
                    continue;
                }
                Err(ShopFloorError::Refused { status }) => {
                    let status = StatusCode::from(status.0);
                    chunk.iter().map(|_| ItemOutcome::Refused(status)).collect()
                }
                Err(error) => return Err(error),
            };
            self.record_outcomes(index, chunk, outcomes, queue, missing);
        }
        Ok(())
    }

    fn refuse_all(&mut self, queue: &mut VecDeque<PendingItem>) {
        let reason = "the server's limit of monitored items is reached; raise it there or monitor \
                      less";
        for PendingItem { attempt, .. } in queue.drain(..) {
            let status = StatusCode::BadTooManyMonitoredItems;
            self.items.add_refused(attempt, status, reason.into());
        }
    }

    /// Sends one request for items. Releases the client handles of those that were not created.
    async fn request_items(
        &self,
        index: usize,
        chunk: &[PendingItem],
    ) -> Result<Vec<ItemOutcome>, ShopFloorError> {
        let handles: Vec<_> =
            chunk.iter().map(|item| self.reserve(&item.attempt.request)).collect();
        let grant = self.pool.grant(index);
        let requests = chunk.iter().zip(&handles).map(|(item, handle)| {
            let (node_id, options) = (item.node_id.clone(), &item.attempt.request.options);
            match &item.filter {
                Some(filter) => item_request::of_events(node_id, filter.clone(), options, *handle),
                None => item_request::new(node_id, options, *handle, self.sampling_ms, grant),
            }
        });
        let session = self.connection.session();
        // Past the session's own list of items, which would store all of them a second time.
        let request = CreateMonitoredItems::new(self.pool.id(index), session)
            .timestamps_to_return(TimestampsToReturn::Both)
            .items_to_create(requests.collect());
        let created = match self.connection.request(request.send(session.channel())).await {
            Ok(created) => created.results,
            Err(error) => {
                handles.into_iter().for_each(|handle| self.sink.release(handle));
                return Err(error);
            }
        };
        let outcomes = created.into_iter().zip(handles).map(|(item, handle)| {
            let status = item.result.status_code;
            if status.is_good() {
                let intervals = GrantedItem {
                    sampling_ms: item.result.revised_sampling_interval,
                    queue_size: item.result.revised_queue_size,
                };
                ItemOutcome::Created {
                    item_id: item.result.monitored_item_id,
                    handle,
                    intervals,
                    unknown_field: unknown_field(&item.result.filter_result),
                }
            } else {
                self.sink.release(handle);
                ItemOutcome::Refused(status)
            }
        });
        Ok(outcomes.collect())
    }

    /// Returns a client handle for an item. Its values wait where those before them can be read.
    fn reserve(&self, request: &Arc<MonitorRequest>) -> u32 {
        let handle = self.sink.reserve(request);
        if let Some(since) = self.memory.gap_since(request) {
            self.sink.hold(handle, since);
        }
        handle
    }

    fn record_outcomes(
        &mut self,
        index: usize,
        chunk: Vec<PendingItem>,
        outcomes: Vec<ItemOutcome>,
        queue: &mut VecDeque<PendingItem>,
        missing: &mut Vec<MissingNode>,
    ) {
        let mut is_full = false;
        for (item, outcome) in chunk.into_iter().zip(outcomes) {
            match outcome {
                ItemOutcome::Created { item_id, handle, intervals, unknown_field } => {
                    self.pool.add_item(index);
                    if let Some(since) = self.memory.gap_since(&item.attempt.request) {
                        self.gaps.push(ItemGap { handle, node_id: item.node_id.clone(), since });
                    }
                    if item.filter.is_some() {
                        match self.memory.last_event(&item.attempt.request) {
                            Some(last) => self.sink.resume_with(handle, last),
                            None => self.sink.await_first_event(handle),
                        }
                    } else {
                        self.note_granted(index, &item.attempt.request, intervals);
                    }
                    let input = item.attempt.request.input;
                    self.items.add_monitored(item.attempt.request, index, item_id, handle);
                    if let Some(status) = unknown_field {
                        let reason = "the server does not know a field of the events".to_owned();
                        self.record.set_input_problem(input, status_from_stack(status), reason);
                    }
                }
                ItemOutcome::Refused(StatusCode::BadTooManyMonitoredItems) => {
                    is_full = true;
                    queue.push_back(item);
                }
                ItemOutcome::Refused(
                    status @ (StatusCode::BadNodeIdUnknown | StatusCode::BadNodeIdInvalid),
                ) if !item.is_found_by_path => {
                    let reason = format!("the server does not know this node: {status}");
                    let PendingItem { attempt, filter, .. } = item;
                    missing.push(MissingNode { attempt, filter, status, reason });
                }
                ItemOutcome::Refused(status) => {
                    let what =
                        if item.filter.is_some() { "events of this node" } else { "this node" };
                    let reason = format!("the server refuses to monitor {what}: {status}");
                    self.items.add_refused(item.attempt, status, reason);
                }
            }
        }
        if is_full {
            self.pool.set_full(index);
        }
    }

    fn note_granted(&self, index: usize, request: &MonitorRequest, granted: GrantedItem) {
        let GrantedItem { sampling_ms, queue_size } = granted;
        let overruns = self.pool.grant(index).overruns(sampling_ms, queue_size);
        self.record.set_granted_item(request.input, granted, overruns);
    }

    /// Finds missing nodes at their browse paths; the others are refused.
    async fn find_by_path(
        &mut self,
        missing: Vec<MissingNode>,
    ) -> Result<VecDeque<PendingItem>, ShopFloorError> {
        let mut with_path = Vec::new();
        for node in missing {
            match self.memory.path_of(&node.attempt.request) {
                Some(path) => with_path.push((node, path)),
                None => self.items.add_refused(node.attempt, node.status, node.reason),
            }
        }
        let paths: Vec<_> = with_path.iter().map(|(_, path)| path.clone()).collect();
        let found = translate(self.connection, &paths).await?;
        let mut queue = VecDeque::new();
        for ((MissingNode { attempt, filter, status, reason }, path), targets) in
            with_path.into_iter().zip(found)
        {
            if let Some(node_id) = targets.into_iter().next() {
                let requested = attempt.request.node_id.clone();
                tracing::info!(source.id = %self.record.id, node.id = %requested, path = %path,
                    "A node was found again at its browse path under another id.");
                self.memory.add_relocated(requested, node_id.clone());
                queue.push_back(PendingItem { attempt, node_id, filter, is_found_by_path: true });
            } else {
                let reason = format!("{reason}; nothing is at its browse path {path} either");
                self.items.add_refused(attempt, status, reason);
            }
        }
        Ok(queue)
    }
}

/// Returns the status of the first field of an event that the server does not know.
fn unknown_field(result: &ExtensionObject) -> Option<StatusCode> {
    let result = result.inner_as::<EventFilterResult>()?;
    result.select_clause_results.iter().flatten().find(|status| status.is_bad()).copied()
}

/// Puts a refused chunk back to the front of the queue, in its order.
fn requeue(queue: &mut VecDeque<PendingItem>, chunk: Vec<PendingItem>) {
    for item in chunk.into_iter().rev() {
        queue.push_front(item);
    }
}
