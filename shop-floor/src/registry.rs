//! Registry of the sources, and of which source monitors each input.

use std::{collections::HashMap, sync::Arc};

use asi_model::values::{DataValue, StatusCode};
use indexmap::IndexMap;
use parking_lot::RwLock;
use tokio::sync::Notify;

use crate::{
    InputChange, InputKey, MonitorRequest, ShopFloorError, SourceConfig, SourceId, SourceStatus,
    clock,
    context::SourceContext,
    source::{Connection, SourceRecord},
};

/// Owner of all source records. Callers change it through the handle; the service starts and
/// stops tasks to match it.
pub(crate) struct SourceRegistry {
    context: Arc<SourceContext>,
    entries: RwLock<Entries>,
    /// Woken when a source was added, changed or removed.
    sources_changed: Notify,
}

#[derive(Default)]
struct Entries {
    /// Every source that is configured or has monitored inputs.
    sources: IndexMap<SourceId, Arc<SourceRecord>>,
    inputs: HashMap<InputKey, SourceId>,
    is_stopped: bool,
}

impl SourceRegistry {
    pub(crate) fn new(context: Arc<SourceContext>) -> Self {
        Self { context, entries: RwLock::default(), sources_changed: Notify::new() }
    }

    /// Adds a source or replaces its configuration.
    pub(crate) fn put(&self, config: SourceConfig) -> Result<(), ShopFloorError> {
        let limit = self.context.config.sources_max;
        self.change(|entries| {
            entries.get_or_add(&config.source_id, limit)?.set_config(Some(config));
            Ok(())
        })?;
        self.sources_changed.notify_one();
        Ok(())
    }

    /// Checks that a source of this id can be added or changed.
    pub(crate) fn check(&self, id: &SourceId) -> Result<(), ShopFloorError> {
        self.entries.read().check(id, self.context.config.sources_max)
    }

    /// Removes a source's configuration. Its record stays while inputs are monitored on it.
    pub(crate) fn remove(&self, id: &SourceId) {
        let mut entries = self.entries.write();
        if let Some(source) = entries.sources.get(id) {
            source.set_config(None);
            entries.remove_if_unused(id);
        }
        drop(entries);
        self.sources_changed.notify_one();
        self.context.notify_status_changed();
    }

    /// Monitors all inputs or none. Those of a source without session get `BadNotConnected`.
    pub(crate) fn monitor(&self, requests: Vec<Arc<MonitorRequest>>) -> Result<(), ShopFloorError> {
        let (inputs_max, sources_max) =
            (self.context.config.inputs_max, self.context.config.sources_max);
        let unconnected =
            self.change(|entries| entries.monitor(requests, inputs_max, sources_max))?;
        let value = DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, Some(clock::now()));
        let changes = unconnected
            .into_iter()
            .map(|input| InputChange { input, value: value.clone() })
            .collect();
        self.context.changes.push(changes);
        Ok(())
    }

    /// Stops monitoring inputs; changes of theirs that still wait for the consumer are dropped.
    pub(crate) fn unmonitor(&self, inputs: &[InputKey]) {
        let mut entries = self.entries.write();
        let mut by_source: HashMap<SourceId, Vec<InputKey>> = HashMap::new();
        for input in inputs {
            if let Some(source) = entries.inputs.remove(input) {
                by_source.entry(source).or_default().push(*input);
            }
        }
        for (source, inputs) in by_source {
            entries.remove_requests(&source, &inputs);
        }
        drop(entries);
        self.context.changes.discard(inputs);
    }

    /// Returns the statuses of all configured sources, in the order they were added.
    pub(crate) fn statuses(&self) -> Vec<SourceStatus> {
        let sources: Vec<_> = self.entries.read().sources.values().cloned().collect();
        sources
            .iter()
            .filter(|source| source.config().is_some())
            .map(|source| source.status())
            .collect()
    }

    /// Returns the connection of a configured source with an established session.
    pub(crate) fn connection(&self, id: &SourceId) -> Result<Connection, ShopFloorError> {
        let entries = self.entries.read();
        let source = entries.sources.get(id).filter(|source| source.config().is_some());
        let source = source.ok_or_else(|| ShopFloorError::UnknownSource(id.clone()))?;
        source.connection().ok_or_else(|| ShopFloorError::NotConnected(id.clone()))
    }

    /// Ends the backoff of all sources that wait for their next attempt.
    pub(crate) fn retry_all(&self) {
        for source in self.entries.read().sources.values() {
            source.request_retry();
        }
    }

    /// Returns the sources that should have a running task, with their configuration.
    pub(crate) fn configured(&self) -> HashMap<SourceId, (SourceConfig, Arc<SourceRecord>)> {
        self.entries
            .read()
            .sources
            .iter()
            .filter_map(|(id, source)| Some((id.clone(), (source.config()?, Arc::clone(source)))))
            .collect()
    }

    /// Waits until a source was added, changed or removed.
    pub(crate) async fn sources_changed(&self) {
        self.sources_changed.notified().await;
    }

    /// Refuses all further changes.
    pub(crate) fn stop(&self) {
        self.entries.write().is_stopped = true;
    }

    fn change<T>(
        &self,
        change: impl FnOnce(&mut Entries) -> Result<T, ShopFloorError>,
    ) -> Result<T, ShopFloorError> {
        let mut entries = self.entries.write();
        if entries.is_stopped {
            return Err(ShopFloorError::Stopped);
        }
        let result = change(&mut entries);
        drop(entries);
        self.context.notify_status_changed();
        result
    }
}

impl Entries {
    fn check(&self, id: &SourceId, limit: usize) -> Result<(), ShopFloorError> {
        if !self.sources.contains_key(id) && self.sources.len() >= limit {
            return Err(ShopFloorError::LimitReached { what: "sources", limit });
        }
        Ok(())
    }

    fn get_or_add(
        &mut self,
        id: &SourceId,
        limit: usize,
    ) -> Result<Arc<SourceRecord>, ShopFloorError> {
        self.check(id, limit)?;
        let source = self.sources.entry(id.clone());
        Ok(Arc::clone(source.or_insert_with(|| Arc::new(SourceRecord::new(id.clone())))))
    }

    /// Returns the inputs whose sources are not connected.
    fn monitor(
        &mut self,
        requests: Vec<Arc<MonitorRequest>>,
        inputs_max: usize,
        sources_max: usize,
    ) -> Result<Vec<InputKey>, ShopFloorError> {
        let is_new = |request: &&Arc<MonitorRequest>| !self.inputs.contains_key(&request.input);
        if self.inputs.len() + requests.iter().filter(is_new).count() > inputs_max {
            return Err(ShopFloorError::LimitReached { what: "inputs", limit: inputs_max });
        }
        // All sources are found before the first input is registered: all inputs or none.
        let mut by_source: IndexMap<SourceId, Vec<Arc<MonitorRequest>>> = IndexMap::new();
        for request in requests {
            self.get_or_add(&request.source, sources_max)?;
            by_source.entry(request.source.clone()).or_default().push(request);
        }
        let mut unconnected = Vec::new();
        for (id, requests) in by_source {
            let source = self.get_or_add(&id, sources_max)?;
            for request in &requests {
                let previous = self.inputs.insert(request.input, id.clone());
                if let Some(previous) = previous.filter(|previous| *previous != id) {
                    self.remove_requests(&previous, &[request.input]);
                }
            }
            if !source.is_connected() {
                unconnected.extend(requests.iter().map(|request| request.input));
            }
            source.add_requests(requests);
        }
        Ok(unconnected)
    }

    fn remove_requests(&mut self, id: &SourceId, inputs: &[InputKey]) {
        if let Some(source) = self.sources.get(id) {
            source.remove_requests(inputs);
            self.remove_if_unused(id);
        }
    }

    /// Drops the record of a source that is neither configured nor has monitored inputs.
    fn remove_if_unused(&mut self, id: &SourceId) {
        let is_unused =
            |source: &Arc<SourceRecord>| source.config().is_none() && source.has_no_requests();
        if self.sources.get(id).is_some_and(is_unused) {
            self.sources.shift_remove(id);
        }
    }
}
