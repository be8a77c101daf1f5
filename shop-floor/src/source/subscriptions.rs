//! Monitored items of one session, kept as callers request them within the server's limits.

mod create;
mod gaps;
mod grant;
mod item_request;
mod items;
mod pool;
mod refresh;

use std::{collections::HashMap, sync::Arc, time::Duration};

use asi_model::values::{DataValue, NodeId};
use opcua_stack::values::node_id_from_stack;

use super::{
    connection::Connection, memory::SourceMemory, notification_sink::NotificationSink,
    record::SourceRecord, request_size::per_request, services::read_values,
};
use crate::{
    InputKey, MonitorRequest, ShopFloorError, SourceConfig, change_queue::ChangeQueue,
    monitor_options::sampling_interval_ms,
};

use create::ItemCreation;
use gaps::HistoryLookup;
use items::{Attempt, Item, Items};
use pool::SubscriptionPool;
use refresh::{ConditionRefresh, ConditionSource};

/// Owner of all subscriptions and monitored items of a session.
pub(super) struct Subscriptions {
    record: Arc<SourceRecord>,
    connection: Connection,
    sink: Arc<NotificationSink>,
    /// Sampling interval of the inputs that ask for none.
    sampling_interval: Duration,
    items: Items,
    pool: SubscriptionPool,
    /// Items per request; halved when the server cannot take so many.
    items_per_request: usize,
    refresh: ConditionRefresh,
    history: HistoryLookup,
}

impl Subscriptions {
    pub(super) fn new(
        record: Arc<SourceRecord>,
        connection: Connection,
        sink: Arc<NotificationSink>,
        changes: ChangeQueue,
        config: SourceConfig,
    ) -> Self {
        Self {
            items: Items::new(Arc::clone(&record), changes),
            sampling_interval: config.sampling_interval(),
            pool: SubscriptionPool::new(
                connection.clone(),
                Arc::clone(&sink),
                Arc::clone(&record),
                config,
            ),
            items_per_request: per_request(connection.limits().items_per_call_max),
            refresh: ConditionRefresh::default(),
            history: HistoryLookup::default(),
            record,
            connection,
            sink,
        }
    }

    /// Returns the requests of all monitored items.
    pub(super) fn monitored(&self) -> impl Iterator<Item = &Arc<MonitorRequest>> {
        self.items.all_monitored()
    }

    /// Returns the node of a monitored input; `None` for a part of an array and for events, which reading
    /// the node would not yield.
    pub(super) fn node_of(&self, input: InputKey) -> Option<NodeId> {
        let MonitorRequest { node_id, options, .. } = &**self.items.monitored(input)?;
        (options.index_range.is_none() && options.events.is_none()).then(|| node_id.clone())
    }

    /// Returns the sampling interval of a monitored input; zero for others.
    pub(super) fn sampling_of(&self, input: InputKey) -> Duration {
        let default_ms = self.sampling_interval.as_secs_f64() * 1000.0;
        self.items.monitored(input).map_or(Duration::ZERO, |request| {
            let sampling_ms = sampling_interval_ms(&request.options, default_ms);
            Duration::from_secs_f64(sampling_ms / 1000.0)
        })
    }

    /// Returns the last values of the monitored items that are to outlive the session, with their requests.
    pub(super) fn last_values(
        &self,
        memory: &SourceMemory,
    ) -> Vec<(Arc<MonitorRequest>, DataValue)> {
        let items = self.items.all_with_handles();
        let kept = items.filter(|(request, _)| memory.is_remembered(request));
        let last = kept.filter_map(|(request, handle)| {
            Some((Arc::clone(request), self.sink.last_value(handle)?))
        });
        last.collect()
    }

    /// Has the server asked for its conditions as soon as that is due.
    pub(super) fn need_refresh(&mut self) {
        self.refresh.need();
    }

    /// Asks the server of some nodes whether they have a history.
    pub(super) async fn look_up_history(
        &mut self,
        memory: &mut SourceMemory,
    ) -> Result<(), ShopFloorError> {
        self.history.round(&self.connection, self.items.all_monitored(), memory).await
    }

    /// Asks the server for its conditions when that is needed and due.
    pub(super) async fn refresh_conditions(&mut self) -> Result<(), ShopFloorError> {
        let pool = &self.pool;
        let items = self.items.with_conditions().map(|(index, item_id)| (pool.id(index), item_id));
        let source = ConditionSource {
            record: &self.record,
            connection: &self.connection,
            sink: &self.sink,
        };
        self.refresh.run(&source, items).await
    }

    /// Reads the values of monitored nodes, at the ids under which they were found.
    pub(super) async fn read_monitored(
        &self,
        nodes: &[NodeId],
        memory: &SourceMemory,
    ) -> Result<Vec<DataValue>, ShopFloorError> {
        let namespaces = self.connection.namespaces();
        let nodes: Vec<_> = nodes
            .iter()
            .map(|node| match memory.relocated(node) {
                Some(relocated) => node_id_from_stack(relocated, &namespaces),
                None => node.clone(),
            })
            .collect();
        read_values(&self.connection, &nodes).await
    }

    /// Creates, replaces and deletes items for the changed inputs; `None` deletes.
    pub(super) async fn apply(
        &mut self,
        changed: Vec<(InputKey, Option<Arc<MonitorRequest>>)>,
        memory: &mut SourceMemory,
    ) -> Result<(), ShopFloorError> {
        let mut to_delete = Vec::new();
        let mut to_create = Vec::new();
        for (input, request) in changed {
            if request.is_some() && self.items.monitored(input) == request.as_ref() {
                continue;
            }
            if let Some(item) = self.items.remove(input) {
                // What an earlier session delivered last is older than what this one did.
                memory.forget(input);
                to_delete.push(item);
            }
            match request {
                Some(request) => to_create.push(Attempt { request, attempts: 0 }),
                None => {
                    self.record.clear_input_problem(input);
                    memory.forget(input);
                }
            }
        }
        self.delete(to_delete).await?;
        self.create(to_create, memory).await
    }

    /// Returns true when it is time to try again items that the server refused.
    pub(super) fn is_retry_due(&self) -> bool {
        self.items.is_retry_due()
    }

    /// Tries again the refused items whose backoff has ended.
    pub(super) async fn retry(&mut self, memory: &mut SourceMemory) -> Result<(), ShopFloorError> {
        let due = self.items.take_due();
        self.pool.reset_server_full();
        self.create(due, memory).await
    }

    /// Deletes all items. Some servers leak items that are deleted with their subscription.
    pub(super) async fn delete_all(&mut self) -> Result<(), ShopFloorError> {
        let items = self.items.remove_all();
        self.delete(items).await
    }

    async fn create(
        &mut self,
        attempts: Vec<Attempt>,
        memory: &mut SourceMemory,
    ) -> Result<(), ShopFloorError> {
        self.history.reset();
        let mut gaps = Vec::new();
        let creation = ItemCreation {
            record: &self.record,
            connection: &self.connection,
            sink: &self.sink,
            sampling_ms: self.sampling_interval.as_secs_f64() * 1000.0,
            items: &mut self.items,
            pool: &mut self.pool,
            items_per_request: &mut self.items_per_request,
            memory,
            gaps: &mut gaps,
        };
        let created = creation.run(attempts).await;
        gaps::fill(&self.connection, &self.sink, gaps).await;
        created
    }

    async fn delete(&mut self, items: Vec<Item>) -> Result<(), ShopFloorError> {
        let mut by_subscription: HashMap<usize, Vec<(u32, u32)>> = HashMap::new();
        for item in items {
            if let Item::Monitored { subscription, item_id, handle, .. } = item {
                by_subscription.entry(subscription).or_default().push((item_id, handle));
            }
        }
        for (index, items) in by_subscription {
            self.pool.remove_items(index, items.len());
            let id = self.pool.id(index);
            for chunk in items.chunks(self.items_per_request) {
                let ids: Vec<_> = chunk.iter().map(|(item_id, _)| *item_id).collect();
                let delete = self.connection.session().delete_monitored_items(id, &ids);
                let deleted = self.connection.request(delete).await;
                for (_, handle) in chunk {
                    self.sink.release(*handle);
                }
                // The statuses of single items do not matter: a refused one was gone already.
                deleted?;
            }
        }
        Ok(())
    }
}
