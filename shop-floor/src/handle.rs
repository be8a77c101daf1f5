//! Handle through which other crates use the client.

use std::sync::Arc;

use asi_model::values::{DataValue, NodeId, StatusCode, Variant};
use tokio::sync::watch;

use crate::{
    BrowsePath, BrowsedNode, InputKey, MonitorOptions, MonitorRequest, OwnCertificates,
    PeerCertificate, ServerOffer, ShopFloorError, SourceCallResult, SourceConfig, SourceId,
    SourceProblem, SourceStatus, TestedServer, TrustState, VariableList,
    certificates::PkiDirectory, context::SourceContext, monitor_options, registry::SourceRegistry,
    source,
};

/// Cloneable handle to the [`ShopFloor`](crate::ShopFloor).
#[derive(Clone)]
pub struct ShopFloorHandle {
    context: Arc<SourceContext>,
    registry: Arc<SourceRegistry>,
}

impl ShopFloorHandle {
    pub(crate) const fn new(context: Arc<SourceContext>, registry: Arc<SourceRegistry>) -> Self {
        Self { context, registry }
    }

    /// Adds a source, or replaces its configuration and connects it again.
    ///
    /// # Errors
    /// [`ShopFloorError::LimitReached`], [`ShopFloorError::Invalid`] when the address is no
    /// `opc.tcp://` one, [`ShopFloorError::Stopped`].
    pub fn put_source(&self, config: SourceConfig) -> Result<(), ShopFloorError> {
        self.check_source(&config)?;
        self.registry.put(config)
    }

    /// Checks a source that is to be added or changed, so that it is stored only where it is taken.
    ///
    /// # Errors
    /// [`ShopFloorError::LimitReached`], [`ShopFloorError::Invalid`] when the address is no
    /// `opc.tcp://` one.
    pub fn check_source(&self, config: &SourceConfig) -> Result<(), ShopFloorError> {
        check_address(&config.endpoint_url)?;
        self.registry.check(&config.source_id)
    }

    /// Returns the bytes that all connections hold of messages that are not complete or not delivered yet.
    #[must_use]
    pub fn incoming_bytes(&self) -> usize {
        self.context.incoming.held_bytes()
    }

    /// Removes a source. Its inputs stay monitored and yield `BadNotConnected` until the source is
    /// added again.
    pub fn remove_source(&self, id: &SourceId) {
        self.registry.remove(id);
    }

    /// Returns the statuses of all sources, in the order they were added.
    #[must_use]
    pub fn states(&self) -> Vec<SourceStatus> {
        self.registry.statuses()
    }

    /// Returns a version that changes with the states, problems or live inputs in
    /// [`Self::states`], but not with counters and ages.
    #[must_use]
    pub fn watch(&self) -> watch::Receiver<u64> {
        self.context.watch_status()
    }

    /// Monitors a variable under the caller's key; a key in use is reassigned. The first value, or a
    /// status with the reason for its absence, arrives as a change.
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

    /// Monitors many variables: all of them, or none on an error.
    ///
    /// # Errors
    /// As [`Self::monitor`].
    pub fn monitor_many<R: Into<Arc<MonitorRequest>>>(
        &self,
        requests: Vec<R>,
    ) -> Result<(), ShopFloorError> {
        let requests: Vec<Arc<MonitorRequest>> = requests.into_iter().map(Into::into).collect();
        for request in &requests {
            monitor_options::check(&request.options)?;
        }
        self.registry.monitor(requests)
    }

    /// Checks the options of an input that is to be monitored later.
    ///
    /// # Errors
    /// [`ShopFloorError::Invalid`] when an option is out of range.
    pub fn check_options(options: &MonitorOptions) -> Result<(), ShopFloorError> {
        monitor_options::check(options)
    }

    /// Stops monitoring an input.
    pub fn unmonitor(&self, input: InputKey) {
        self.unmonitor_many(&[input]);
    }

    /// Stops monitoring many inputs.
    pub fn unmonitor_many(&self, inputs: &[InputKey]) {
        self.registry.unmonitor(inputs);
    }

    /// Returns the children of a node, or of the Objects folder.
    ///
    /// # Errors
    /// [`ShopFloorError`] when the source is unknown or not connected, or the server refuses.
    pub async fn browse(
        &self,
        source: &SourceId,
        parent: Option<&NodeId>,
    ) -> Result<Vec<BrowsedNode>, ShopFloorError> {
        Ok(source::browse(&self.registry.connection(source)?, parent, 0, usize::MAX).await?.0)
    }

    /// Returns one page of a node's children: at most `limit`, starting at the index `from`, and
    /// the index of the next page, `None` after the last.
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
        source::browse(&self.registry.connection(source)?, parent, from, limit).await
    }

    /// Returns one node with the same details as [`Self::browse`].
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn describe(
        &self,
        source: &SourceId,
        node: &NodeId,
    ) -> Result<BrowsedNode, ShopFloorError> {
        source::describe(&self.registry.connection(source)?, node).await
    }

    /// Returns up to 1000 nodes with the same details as [`Self::browse`], in the order of the
    /// request. Nodes that the server does not know are left out.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn describe_many(
        &self,
        source: &SourceId,
        nodes: &[NodeId],
    ) -> Result<Vec<BrowsedNode>, ShopFloorError> {
        source::describe_many(&self.registry.connection(source)?, nodes).await
    }

    /// Lists all variables below the Objects folder except properties and the Server object. Stops
    /// after `visited_max` nodes. Takes seconds on a large server: requests are sent one after the
    /// other, so that the server has time for its other clients.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn variables(
        &self,
        source: &SourceId,
        visited_max: usize,
    ) -> Result<VariableList, ShopFloorError> {
        source::list_variables(&self.registry.connection(source)?, visited_max).await
    }

    /// Finds nodes below the Objects folder whose browse or display name contains a text, ignoring
    /// case. Stops after `found_max` results (at most 1000) or 20 000 visited nodes.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn search(
        &self,
        source: &SourceId,
        text: &str,
        found_max: usize,
    ) -> Result<Vec<BrowsedNode>, ShopFloorError> {
        source::search(&self.registry.connection(source)?, text, found_max).await
    }

    /// Returns the id of a node with the URI of its namespace. An index, as other clients show it, is that of this server
    /// at present.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub fn with_uri(&self, source: &SourceId, node: NodeId) -> Result<NodeId, ShopFloorError> {
        Ok(self.registry.connection(source)?.with_uri(node))
    }

    /// Returns the browse path from the Objects folder to a node.
    ///
    /// # Errors
    /// As [`Self::browse`]; [`ShopFloorError::Invalid`] when the node is not below the Objects
    /// folder.
    pub async fn browse_path(
        &self,
        source: &SourceId,
        node: &NodeId,
    ) -> Result<BrowsePath, ShopFloorError> {
        source::browse_path(&self.registry.connection(source)?, node).await
    }

    /// Reads values, in the order of the request.
    ///
    /// # Errors
    /// As [`Self::browse`]; the failure of a single node is the status of its value.
    pub async fn read(
        &self,
        source: &SourceId,
        nodes: &[NodeId],
    ) -> Result<Vec<DataValue>, ShopFloorError> {
        source::read(&self.registry.connection(source)?, nodes).await
    }

    /// Writes values and returns a status for each, in the order of the request.
    ///
    /// # Errors
    /// As [`Self::browse`].
    pub async fn write(
        &self,
        source: &SourceId,
        values: &[(NodeId, DataValue)],
    ) -> Result<Vec<StatusCode>, ShopFloorError> {
        source::write(&self.registry.connection(source)?, values).await
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
    ) -> Result<SourceCallResult, ShopFloorError> {
        source::call(&self.registry.connection(source)?, object, method, inputs).await
    }

    /// Asks a server what it offers (GetEndpoints), and looks at its certificates. Nothing is kept. The outer error is
    /// of the address, the inner one of what is behind it.
    ///
    /// # Errors
    /// [`ShopFloorError::Invalid`] when the address is no `opc.tcp://` one.
    pub async fn discover(
        &self,
        endpoint_url: &str,
    ) -> Result<Result<ServerOffer, SourceProblem>, ShopFloorError> {
        check_address(endpoint_url)?;
        Ok(source::discover(&self.context, endpoint_url).await)
    }

    /// Opens a session as the source would, reads what the server says of itself, and closes it again. The source is not
    /// stored; a certificate that no person has approved is listed by [`Self::certificates`].
    ///
    /// # Errors
    /// [`ShopFloorError::Invalid`] when the address is no `opc.tcp://` one.
    pub async fn test_source(
        &self,
        config: &SourceConfig,
    ) -> Result<Result<TestedServer, SourceProblem>, ShopFloorError> {
        check_address(&config.endpoint_url)?;
        Ok(source::test_source(&self.context, config).await)
    }

    /// Returns the client's application instance certificate, which is created on first use, and the next one.
    ///
    /// # Errors
    /// [`ShopFloorError::Certificates`].
    pub async fn own_certificates(&self) -> Result<OwnCertificates, ShopFloorError> {
        self.with_certificates(PkiDirectory::own_and_next).await
    }

    /// Makes the next certificate of the client, unless there is one. It is not used before [`Self::use_next_certificate`],
    /// so that machines can be made to trust it.
    ///
    /// # Errors
    /// [`ShopFloorError::Certificates`].
    pub async fn prepare_next_certificate(&self) -> Result<OwnCertificates, ShopFloorError> {
        self.with_certificates(PkiDirectory::prepare_next).await
    }

    /// Uses the next certificate: sessions that are open go on, and each new one begins with it.
    ///
    /// # Errors
    /// [`ShopFloorError::Invalid`] without a next certificate.
    pub async fn use_next_certificate(&self) -> Result<OwnCertificates, ShopFloorError> {
        let certificates = self.with_certificates(PkiDirectory::use_next).await?;
        self.registry.retry_all();
        Ok(certificates)
    }

    /// Deletes the next certificate and its key.
    ///
    /// # Errors
    /// [`ShopFloorError::Certificates`].
    pub async fn discard_next_certificate(&self) -> Result<OwnCertificates, ShopFloorError> {
        self.with_certificates(PkiDirectory::discard_next).await
    }

    /// Lists the servers' certificates seen so far. Rejected ones wait for a person's approval.
    ///
    /// # Errors
    /// [`ShopFloorError::Certificates`], [`ShopFloorError::Stopped`].
    pub async fn certificates(&self) -> Result<Vec<PeerCertificate>, ShopFloorError> {
        self.with_certificates(PkiDirectory::list).await
    }

    /// Changes the trust in a certificate; sources that wait for it retry at once, and sessions that rest on it end.
    ///
    /// # Errors
    /// [`ShopFloorError::Invalid`] when it is not known.
    pub async fn set_trust(
        &self,
        thumbprint: &str,
        trust: TrustState,
    ) -> Result<PeerCertificate, ShopFloorError> {
        let thumbprint = thumbprint.to_owned();
        let certificate =
            self.with_certificates(move |pki| pki.set_trust(&thumbprint, trust)).await?;
        self.context.notify_trust_changed();
        self.registry.retry_all();
        Ok(certificate)
    }

    /// Deletes a server's certificate; sessions that rest on it end.
    ///
    /// # Errors
    /// [`ShopFloorError::Certificates`].
    pub async fn forget_certificate(&self, thumbprint: &str) -> Result<(), ShopFloorError> {
        let thumbprint = thumbprint.to_owned();
        self.with_certificates(move |pki| pki.forget(&thumbprint)).await?;
        self.context.notify_trust_changed();
        Ok(())
    }

    async fn with_certificates<T: Send + 'static>(
        &self,
        work: impl FnOnce(&PkiDirectory) -> Result<T, ShopFloorError> + Send + 'static,
    ) -> Result<T, ShopFloorError> {
        self.context.with_certificates(work).await.map_err(|_| ShopFloorError::Stopped)?
    }
}

fn check_address(endpoint_url: &str) -> Result<(), ShopFloorError> {
    if !endpoint_url.starts_with("opc.tcp://") || endpoint_url.len() > 4096 {
        return Err(ShopFloorError::Invalid(
            "the endpoint address must start with opc.tcp://".into(),
        ));
    }
    Ok(())
}
