//! What callers can ask.

use std::{collections::HashMap, sync::Arc};

use asi_model::values::{DataValue, NodeId, StatusCode, Variant};
use tokio::sync::watch;

use crate::{
    BrowsePath, BrowsedNode, CallOutcome, EndpointOffer, InputChange, InputKey, MonitorOptions,
    MonitorRequest, OwnCertificate, PeerCertificate, ShopFloorError, SourceConfig, SourceId,
    SourceStatus, TrustState, VariableList,
    certificates::CertificateShelf,
    service::{Floor, Registry},
    source::{self, Connection, Entry},
};

/// A cloneable handle to the [`ShopFloor`](crate::ShopFloor).
#[derive(Clone)]
pub struct ShopFloorHandle {
    floor: Arc<Floor>,
}

impl ShopFloorHandle {
    pub(crate) const fn new(floor: Arc<Floor>) -> Self {
        Self { floor }
    }

    /// Adds a source, or changes it: a changed one is connected anew.
    ///
    /// # Errors
    /// [`ShopFloorError::LimitReached`], [`ShopFloorError::Invalid`] when the address is no
    /// `opc.tcp://` one, [`ShopFloorError::Stopped`].
    pub fn put_source(&self, config: SourceConfig) -> Result<(), ShopFloorError> {
        if !config.endpoint_url.starts_with("opc.tcp://") || config.endpoint_url.len() > 4096 {
            return Err(ShopFloorError::Invalid(
                "the endpoint address must start with opc.tcp://".into(),
            ));
        }
        let limit = self.floor.config.sources_max;
        self.change_registry(|registry| {
            let entry = entry(registry, &config.source_id, limit)?;
            entry.set_config(Some(config));
            Ok(())
        })?;
        self.floor.sources_changed.notify_one();
        Ok(())
    }

    /// Removes a source. Its inputs stay wanted and yield `BadNotConnected` until it is added
    /// again.
    pub fn remove_source(&self, id: &SourceId) {
        let mut registry = self.floor.registry.write();
        if let Some(entry) = registry.sources.get(id) {
            entry.set_config(None);
            if entry.is_unwanted() {
                registry.sources.shift_remove(id);
            }
        }
        drop(registry);
        self.floor.sources_changed.notify_one();
        self.floor.status_has_changed();
    }

    /// How all sources are doing, in the order they were added.
    #[must_use]
    pub fn states(&self) -> Vec<SourceStatus> {
        let entries: Vec<_> = self.floor.registry.read().sources.values().cloned().collect();
        entries
            .iter()
            .filter(|entry| entry.config().is_some())
            .map(|entry| entry.status())
            .collect()
    }

    /// Changes whenever [`Self::states`] would say something new about states, problems or live
    /// inputs (not about counters and ages).
    #[must_use]
    pub fn watch(&self) -> watch::Receiver<u64> {
        self.floor.status_version.subscribe()
    }

    /// Monitors a variable under the caller's key; a key that is used already is moved. The first
    /// value, or a status that says why there is none, arrives as a change.
    ///
    /// # Errors
    /// [`ShopFloorError::LimitReached`], [`ShopFloorError::Invalid`] when an option is out of
    /// range, [`ShopFloorError::Stopped`].
    pub fn monitor(
        &self,
        input: InputKey,
        source: SourceId,
        node_id: NodeId,
        options: MonitorOptions,
    ) -> Result<(), ShopFloorError> {
        self.monitor_many(vec![MonitorRequest { input, source, node_id, options }])
    }

    /// Monitors many variables at once; all or none.
    ///
    /// # Errors
    /// As [`Self::monitor`].
    pub fn monitor_many<R: Into<Arc<MonitorRequest>>>(
        &self,
        requests: Vec<R>,
    ) -> Result<(), ShopFloorError> {
        let requests: Vec<Arc<MonitorRequest>> = requests.into_iter().map(Into::into).collect();
        for request in &requests {
            check_options(&request.options)?;
        }
        let (inputs_max, sources_max) =
            (self.floor.config.inputs_max, self.floor.config.sources_max);
        let mut unconnected = Vec::new();
        self.change_registry(|registry| {
            let new = requests
                .iter()
                .filter(|request| !registry.inputs.contains_key(&request.input))
                .count();
            if registry.inputs.len() + new > inputs_max {
                return Err(ShopFloorError::LimitReached { what: "inputs", limit: inputs_max });
            }
            let mut by_source: HashMap<SourceId, Vec<Arc<MonitorRequest>>> = HashMap::new();
            for request in requests {
                entry(registry, &request.source, sources_max)?;
                by_source.entry(request.source.clone()).or_default().push(request);
            }
            for (id, requests) in by_source {
                let entry = entry(registry, &id, sources_max)?;
                for request in &requests {
                    let previous = registry.inputs.insert(request.input, id.clone());
                    if let Some(previous) = previous.filter(|previous| *previous != id) {
                        release(registry, &previous, &[request.input]);
                    }
                }
                if !entry.is_connected() {
                    unconnected.extend(requests.iter().map(|request| request.input));
                }
                entry.want(requests);
            }
            Ok(())
        })?;
        let value = DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, Some(source::now()));
        self.floor.outbox.push(
            unconnected
                .into_iter()
                .map(|input| InputChange { input, value: value.clone() })
                .collect(),
        );
        Ok(())
    }

    /// Stops monitoring.
    pub fn unmonitor(&self, input: InputKey) {
        self.unmonitor_many(&[input]);
    }

    /// Stops monitoring many inputs at once.
    pub fn unmonitor_many(&self, inputs: &[InputKey]) {
        let mut registry = self.floor.registry.write();
        let mut by_source: HashMap<SourceId, Vec<InputKey>> = HashMap::new();
        for input in inputs {
            if let Some(source) = registry.inputs.remove(input) {
                by_source.entry(source).or_default().push(*input);
            }
        }
        for (source, inputs) in by_source {
            release(&mut registry, &source, &inputs);
        }
        drop(registry);
        self.floor.outbox.forget(inputs);
    }

    /// The children of a node, or of the Objects folder.
    ///
    /// # Errors
    /// [`ShopFloorError`] when the source is unknown or not connected, or the server refuses.
    pub async fn browse(
        &self,
        source: &SourceId,
        parent: Option<&NodeId>,
    ) -> Result<Vec<BrowsedNode>, ShopFloorError> {
        Ok(source::browse(&self.connection(source)?, parent, 0, usize::MAX).await?.0)
    }

    /// The children of a node from the one at `from` on, at most `limit` of them; with them where
    /// the next ones begin, none behind the last.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn browse_from(
        &self,
        source: &SourceId,
        parent: Option<&NodeId>,
        from: usize,
        limit: usize,
    ) -> Result<(Vec<BrowsedNode>, Option<usize>), ShopFloorError> {
        source::browse(&self.connection(source)?, parent, from, limit).await
    }

    /// One node, as browsing shows it.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn describe(
        &self,
        source: &SourceId,
        node: &NodeId,
    ) -> Result<BrowsedNode, ShopFloorError> {
        source::describe(&self.connection(source)?, node).await
    }

    /// Many nodes (at most 1000), as browsing shows them, in the order asked; those that are not
    /// there are left out.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn describe_many(
        &self,
        source: &SourceId,
        nodes: &[NodeId],
    ) -> Result<Vec<BrowsedNode>, ShopFloorError> {
        source::describe_many(&self.connection(source)?, nodes).await
    }

    /// All variables below the Objects folder, but for properties and the server's description of
    /// itself. Ends after `visited_max` nodes. On a large server this takes seconds: it asks one
    /// request after the other, so that the server keeps time for its other clients.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn variables(
        &self,
        source: &SourceId,
        visited_max: usize,
    ) -> Result<VariableList, ShopFloorError> {
        source::list(&self.connection(source)?, visited_max).await
    }

    /// Nodes below the Objects folder whose browse or display name contains a text, without regard
    /// to case. Ends after `found_max` finds (at most 1000) or 20 000 visited nodes.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn search(
        &self,
        source: &SourceId,
        text: &str,
        found_max: usize,
    ) -> Result<Vec<BrowsedNode>, ShopFloorError> {
        source::search(&self.connection(source)?, text, found_max).await
    }

    /// The way from the Objects folder to a node.
    ///
    /// # Errors
    /// As [`Self::browse`]; [`ShopFloorError::Invalid`] when the node does not hang below the
    /// Objects folder.
    pub async fn browse_path(
        &self,
        source: &SourceId,
        node: &NodeId,
    ) -> Result<BrowsePath, ShopFloorError> {
        source::browse_path(&self.connection(source)?, node).await
    }

    /// Reads values, in the order asked.
    ///
    /// # Errors
    /// As [`Self::browse`]; the failure of a single node is the status of its value.
    pub async fn read(
        &self,
        source: &SourceId,
        nodes: &[NodeId],
    ) -> Result<Vec<DataValue>, ShopFloorError> {
        source::read(&self.connection(source)?, nodes).await
    }

    /// Writes values, in the order given; a status for each.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn write(
        &self,
        source: &SourceId,
        values: &[(NodeId, DataValue)],
    ) -> Result<Vec<StatusCode>, ShopFloorError> {
        source::write(&self.connection(source)?, values).await
    }

    /// Calls a method of an object.
    ///
    /// # Errors
    /// As [`Self::browse`]; the failure of the method itself is the outcome's status.
    pub async fn call(
        &self,
        source: &SourceId,
        object: &NodeId,
        method: &NodeId,
        inputs: &[Variant],
    ) -> Result<CallOutcome, ShopFloorError> {
        source::call(&self.connection(source)?, object, method, inputs).await
    }

    /// The endpoints that a server offers.
    ///
    /// # Errors
    /// [`ShopFloorError::Unreachable`] when no server answers.
    pub async fn discover(&self, endpoint_url: &str) -> Result<Vec<EndpointOffer>, ShopFloorError> {
        self.own_certificate().await?;
        source::discover(&self.floor, endpoint_url).await
    }

    /// Our own certificate, created on first use.
    ///
    /// # Errors
    /// [`ShopFloorError::Certificates`].
    pub async fn own_certificate(&self) -> Result<OwnCertificate, ShopFloorError> {
        self.on_shelf(CertificateShelf::own).await
    }

    /// The servers' certificates that we have met; the rejected ones wait for a person.
    ///
    /// # Errors
    /// [`ShopFloorError::Stopped`].
    pub async fn certificates(&self) -> Result<Vec<PeerCertificate>, ShopFloorError> {
        self.on_shelf(|shelf| Ok(shelf.list())).await
    }

    /// Trusts a certificate, or no longer; sources that wait for it are tried at once.
    ///
    /// # Errors
    /// [`ShopFloorError::Invalid`] when it is not known.
    pub async fn set_trust(
        &self,
        thumbprint: &str,
        trust: TrustState,
    ) -> Result<PeerCertificate, ShopFloorError> {
        let thumbprint = thumbprint.to_owned();
        let certificate = self.on_shelf(move |shelf| shelf.set_trust(&thumbprint, trust)).await?;
        for entry in self.floor.registry.read().sources.values() {
            entry.try_now();
        }
        Ok(certificate)
    }

    /// Forgets a certificate.
    ///
    /// # Errors
    /// [`ShopFloorError::Certificates`].
    pub async fn forget_certificate(&self, thumbprint: &str) -> Result<(), ShopFloorError> {
        let thumbprint = thumbprint.to_owned();
        self.on_shelf(move |shelf| shelf.forget(&thumbprint)).await
    }

    async fn on_shelf<T: Send + 'static>(
        &self,
        work: impl FnOnce(&CertificateShelf) -> Result<T, ShopFloorError> + Send + 'static,
    ) -> Result<T, ShopFloorError> {
        let floor = Arc::clone(&self.floor);
        tokio::task::spawn_blocking(move || work(&floor.certificates))
            .await
            .map_err(|_| ShopFloorError::Stopped)?
    }

    fn change_registry<T>(
        &self,
        change: impl FnOnce(&mut Registry) -> Result<T, ShopFloorError>,
    ) -> Result<T, ShopFloorError> {
        let mut registry = self.floor.registry.write();
        if registry.is_stopped {
            return Err(ShopFloorError::Stopped);
        }
        let result = change(&mut registry);
        drop(registry);
        self.floor.status_has_changed();
        result
    }

    fn connection(&self, source: &SourceId) -> Result<Connection, ShopFloorError> {
        let registry = self.floor.registry.read();
        let entry = registry.sources.get(source).filter(|entry| entry.config().is_some());
        let entry = entry.ok_or_else(|| ShopFloorError::UnknownSource(source.clone()))?;
        entry.connection().ok_or_else(|| ShopFloorError::NotConnected(source.clone()))
    }
}

/// The entry of a source; made where there is none.
fn entry(
    registry: &mut Registry,
    id: &SourceId,
    limit: usize,
) -> Result<Arc<Entry>, ShopFloorError> {
    if !registry.sources.contains_key(id) && registry.sources.len() >= limit {
        return Err(ShopFloorError::LimitReached { what: "sources", limit });
    }
    let entry =
        registry.sources.entry(id.clone()).or_insert_with(|| Arc::new(Entry::new(id.clone())));
    Ok(Arc::clone(entry))
}

/// A source need not care for these inputs any more.
fn release(registry: &mut Registry, id: &SourceId, inputs: &[InputKey]) {
    if let Some(entry) = registry.sources.get(id) {
        entry.release(inputs);
        if entry.config().is_none() && entry.is_unwanted() {
            registry.sources.shift_remove(id);
        }
    }
}

fn check_options(options: &MonitorOptions) -> Result<(), ShopFloorError> {
    let invalid = |text: &str| Err(ShopFloorError::Invalid(text.into()));
    if options
        .sampling_interval_ms
        .is_some_and(|interval| !(0.0..=86_400_000.0).contains(&interval))
    {
        return invalid("a sampling interval must be between 0 ms and a day");
    }
    if options.queue_size.is_some_and(|size| !(1..=10_000).contains(&size)) {
        return invalid("a queue must hold 1 to 10000 changes");
    }
    if options
        .index_range
        .as_deref()
        .is_some_and(|range| range.len() > 200 || source::parse_range(range).is_none())
    {
        return invalid("an index range must look like 2 or 1:3");
    }
    if options
        .browse_path
        .as_ref()
        .is_some_and(|path| path.0.is_empty() || path.0.len() > shop_floor_model::PATH_ELEMENTS_MAX)
    {
        return invalid("a browse path must have 1 to 64 elements");
    }
    Ok(())
}
