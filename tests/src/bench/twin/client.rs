//! An OPC UA client that measures.

use std::{path::Path, sync::Arc, time::Duration};

use anyhow::Context as _;
use opcua_stack::{
    limits,
    opcua::{
        client::{ClientBuilder, DataChangeCallback, IdentityToken, Session},
        crypto::SecurityPolicy,
        types::{
            AttributeId, BrowseDescription, BrowseDirection, BrowseResultMask, DataValue,
            MessageSecurityMode, MonitoredItemCreateRequest, MonitoringMode, MonitoringParameters,
            NodeId, ReadValueId, ReferenceTypeId, TimestampsToReturn, UserTokenPolicy,
        },
    },
};
use tokio::{sync::mpsc, task::JoinHandle};

/// The namespace index of the instances: 0 standard, 1 server, 2 types.
const INSTANCES: u16 = 3;
/// Monitored items created at a time.
const ITEMS_PER_CALL: usize = 5000;

/// A session without security, as no figure is about cryptography.
pub(super) struct Client {
    session: Arc<Session>,
    events: JoinHandle<opcua_stack::opcua::types::StatusCode>,
}

pub(super) fn instance(identifier: &str) -> NodeId {
    NodeId::new(INSTANCES, identifier)
}

impl Client {
    /// Connects with a user and an encrypted channel.
    pub async fn connect(url: &str, folder: &Path) -> anyhow::Result<Self> {
        let builder = ClientBuilder::new()
            .application_name("Verbund benchmark")
            .application_uri("urn:verbund:bench")
            .pki_dir(folder.join("client-pki"))
            .create_sample_keypair(true)
            .trust_server_certs(true)
            .session_retry_limit(0);
        let mut client = limits::raise_client(builder)
            .client()
            .map_err(|faults| anyhow::anyhow!(faults.join(", ")))?;
        let policy = SecurityPolicy::None;
        let endpoint =
            (url, policy.to_str(), MessageSecurityMode::None, UserTokenPolicy::anonymous());
        let (session, event_loop) =
            client.connect_to_matching_endpoint(endpoint, IdentityToken::Anonymous).await?;
        let events = event_loop.spawn();
        anyhow::ensure!(session.wait_for_connection().await, "the server at {url} can be reached");
        Ok(Self { session, events })
    }

    /// Ends the session.
    pub async fn close(self) -> anyhow::Result<()> {
        self.session.disconnect().await?;
        self.events.await?;
        Ok(())
    }

    /// Reads the value of a node of the interface.
    pub async fn read(&self, identifier: &str) -> anyhow::Result<DataValue> {
        let wanted = ReadValueId {
            node_id: instance(identifier),
            attribute_id: AttributeId::Value as u32,
            ..ReadValueId::default()
        };
        let mut values = self.session.read(&[wanted], TimestampsToReturn::Both, 0.0).await?;
        values.pop().context("one value for one node")
    }

    /// Returns the number of forward references of a node.
    pub async fn browse(&self, identifier: &str) -> anyhow::Result<usize> {
        let wanted = BrowseDescription {
            node_id: instance(identifier),
            browse_direction: BrowseDirection::Forward,
            reference_type_id: ReferenceTypeId::References.into(),
            include_subtypes: true,
            node_class_mask: 0,
            result_mask: BrowseResultMask::All as u32,
        };
        let found = self
            .session
            .browse(&[wanted], 0, None)
            .await?
            .pop()
            .context("one result for one node")?;
        anyhow::ensure!(
            found.status_code.is_good(),
            "browsing {identifier}: {}",
            found.status_code
        );
        Ok(found.references.map_or(0, |references| references.len()))
    }

    /// Subscribes to values; each change is (position among the nodes, value).
    pub async fn subscribe(
        &self,
        nodes: &[NodeId],
        interval: Duration,
    ) -> anyhow::Result<mpsc::UnboundedReceiver<(usize, DataValue)>> {
        let (sender, receiver) = mpsc::unbounded_channel();
        let callback = DataChangeCallback::new(move |value, item| {
            // Handles count from 1. The receiver may be gone once the measurement ended.
            sender.send((item.client_handle() as usize - 1, value)).ok();
        });
        let subscription =
            self.session.create_subscription(interval, 1000, 100, 0, 0, true, callback).await?;
        let items: Vec<_> =
            (1_u32..).zip(nodes).map(|(handle, node_id)| item(handle, node_id)).collect();
        for chunk in items.chunks(ITEMS_PER_CALL) {
            let created = self
                .session
                .create_monitored_items(subscription, TimestampsToReturn::Both, chunk.to_vec())
                .await?;
            anyhow::ensure!(
                created.iter().all(|i| i.result.status_code.is_good()),
                "all nodes can be monitored"
            );
        }
        Ok(receiver)
    }
}

fn item(handle: u32, node_id: &NodeId) -> MonitoredItemCreateRequest {
    MonitoredItemCreateRequest {
        item_to_monitor: ReadValueId {
            node_id: node_id.clone(),
            attribute_id: AttributeId::Value as u32,
            ..ReadValueId::default()
        },
        monitoring_mode: MonitoringMode::Reporting,
        requested_parameters: MonitoringParameters {
            client_handle: handle,
            sampling_interval: 0.0,
            queue_size: 100,
            discard_oldest: true,
            ..MonitoringParameters::default()
        },
    }
}
