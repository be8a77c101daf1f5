//! A running twin with substitutes for the connector, and clients of the same stack.

#[path = "harness/samples.rs"]
mod samples;

use std::{
    net::IpAddr,
    sync::{Arc, OnceLock},
    time::Duration,
};

use asi_model::{
    DataValue, DateTime, FactoryId, FieldKey, StatusCode,
    messages::{MappingState, ValueSource},
};
use async_trait::async_trait;
use opcua_stack::{
    limits,
    opcua::{
        client::{ClientBuilder, IdentityToken, Session},
        crypto::SecurityPolicy,
        types::{
            AttributeId, BrowseDescription, BrowseDirection, BrowseResultMask,
            DataValue as StackValue, Error, MessageSecurityMode, MonitoredItemCreateRequest,
            MonitoringMode, MonitoringParameters, NodeId, ReadValueId, ReferenceDescription,
            ReferenceTypeId, StatusCode as StackStatus, TimestampsToReturn, UserTokenPolicy,
            Variant,
        },
    },
};
use parking_lot::Mutex;
pub use samples::{document, external, field, field_id, good, instance, message, released};
use tokio::sync::mpsc;
use tokio_util::sync::CancellationToken;
use twin::{
    Authenticator, FieldRecord, FieldWriter, Role, SecurityConfig, SignInRefusal, Twin, TwinConfig,
    TwinDecision, TwinHandle, TwinUser,
};

/// Time limit of every wait in a test.
pub const DEADLINE: Duration = Duration::from_secs(20);
/// The namespace index of the instances: 0 standard, 1 server, 2 types.
pub const INSTANCES: u16 = 3;
pub const TYPES: u16 = 2;
/// Value that a policy makes of any other, while the answer is GoodClamped.
pub const COARSENED: u64 = 4000;

/// Substitute for the connector: stores values and decisions, and publishes like the connector after
/// a commit what its answer says that the gate lets through.
#[derive(Default)]
pub struct Connector {
    pub handle: OnceLock<TwinHandle>,
    pub writes: Mutex<Vec<(FieldKey, DataValue, TwinUser)>>,
    pub decisions: Mutex<Vec<(FieldKey, TwinDecision, TwinUser)>>,
    pub answer: Mutex<Option<StatusCode>>,
}

#[async_trait]
impl FieldWriter for Connector {
    async fn write(&self, field: &FieldKey, value: DataValue, user: &TwinUser) -> StatusCode {
        self.writes.lock().push((field.clone(), value.clone(), user.clone()));
        let answer = self.answer.lock().unwrap_or(StatusCode::GOOD);
        let disclosed = match answer {
            StatusCode::GOOD => Some(released(value)),
            StatusCode::GOOD_CLAMPED => Some(good(COARSENED)),
            _ => None,
        };
        if let (Some(handle), Some(disclosed)) = (self.handle.get(), disclosed) {
            handle.publish_values(vec![(field.clone(), disclosed)]);
        }
        answer
    }

    async fn decide(
        &self,
        field: &FieldKey,
        decision: TwinDecision,
        user: &TwinUser,
    ) -> StatusCode {
        self.decisions.lock().push((field.clone(), decision.clone(), user.clone()));
        if let Some(handle) = self.handle.get() {
            let record = FieldRecord {
                mapping_state: decision.mapping_state,
                value_source: (decision.mapping_state == MappingState::Mapped)
                    .then_some(ValueSource::External),
                reason: decision.reason.map(Into::into),
                decided_by: Some(Arc::clone(&user.name)),
                decision_time: Some(now()),
                ..FieldRecord::default()
            };
            handle.publish_decision(field, record);
        }
        StatusCode::GOOD
    }
}

/// The engineer `anna`, the operator `otto` and the viewer `vera`; the password is the name with
/// `-secret`.
struct Users;

#[async_trait]
impl Authenticator for Users {
    async fn authenticate(
        &self,
        user_name: &str,
        password: &str,
        _: Option<IpAddr>,
    ) -> Result<Role, SignInRefusal> {
        let role = match user_name {
            "anna" => Role::Engineer,
            "otto" => Role::Operator,
            "vera" => Role::Viewer,
            _ => return Err(SignInRefusal::WrongCredentials),
        };
        if password == format!("{user_name}-secret") {
            Ok(role)
        } else {
            Err(SignInRefusal::WrongCredentials)
        }
    }
}

/// A running twin.
pub struct TestTwin {
    pub handle: TwinHandle,
    pub connector: Arc<Connector>,
    pub url: Arc<str>,
    pub folder: tempfile::TempDir,
    shutdown: CancellationToken,
    running: tokio::task::JoinHandle<Result<(), twin::TwinError>>,
}

pub fn now() -> DateTime {
    DateTime::from(std::time::SystemTime::now())
}

impl TestTwin {
    /// Starts a twin that trusts every client certificate: the clients of the tests make new ones.
    pub async fn start() -> Self {
        Self::start_with(|config| config.security.trust_unknown_certificates = true).await
    }

    pub async fn start_with(adjust: impl FnOnce(&mut TwinConfig)) -> Self {
        Self::start_of("FOR_MUC", adjust).await
    }

    /// Starts the twin of a given factory.
    pub async fn start_of(factory: &str, adjust: impl FnOnce(&mut TwinConfig)) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut config = TwinConfig {
            listen: "127.0.0.1:0".parse().unwrap(),
            pki_directory: folder.path().join("pki"),
            security: SecurityConfig::default(),
            ..TwinConfig::default()
        };
        adjust(&mut config);
        let connector = Arc::new(Connector::default());
        let factory = FactoryId::new(factory).unwrap();
        let writer: Arc<dyn FieldWriter> = Arc::clone(&connector) as _;
        let (twin, handle) = Twin::new(factory, config, writer, Arc::new(Users)).unwrap();
        connector.handle.get_or_init(|| handle.clone());
        let shutdown = CancellationToken::new();
        let running = tokio::spawn(twin.run(shutdown.clone()));
        let url = tokio::time::timeout(DEADLINE, handle.ready()).await.unwrap().unwrap();
        Self { handle, connector, url, folder, shutdown, running }
    }

    pub async fn stop(self) {
        drop(self.stop_but_keep().await);
    }

    /// Stops the twin and returns its folder.
    pub async fn stop_but_keep(self) -> tempfile::TempDir {
        self.shutdown.cancel();
        tokio::time::timeout(DEADLINE, self.running).await.unwrap().unwrap().unwrap();
        self.folder
    }

    pub async fn client(&self, user: &str) -> Client {
        self.connect(user, &format!("{user}-secret"), SecurityPolicy::Basic256Sha256).await.unwrap()
    }

    pub async fn connect(
        &self,
        user: &str,
        password: &str,
        policy: SecurityPolicy,
    ) -> Result<Client, StackStatus> {
        let identity = IdentityToken::new_user_name(user, password);
        Client::connect(
            &self.url,
            self.folder.path().join(format!("client-{user}")),
            identity,
            policy,
        )
        .await
    }
}

/// A client's session.
pub struct Client {
    pub session: Arc<Session>,
    events: tokio::task::JoinHandle<StackStatus>,
}

impl Client {
    pub async fn connect(
        url: &str,
        pki: std::path::PathBuf,
        identity: IdentityToken,
        policy: SecurityPolicy,
    ) -> Result<Self, StackStatus> {
        Self::connect_for(url, pki, identity, policy, DEADLINE).await
    }

    /// Connects with a session timeout.
    pub async fn connect_for(
        url: &str,
        pki: std::path::PathBuf,
        identity: IdentityToken,
        policy: SecurityPolicy,
        silence: Duration,
    ) -> Result<Self, StackStatus> {
        let builder = ClientBuilder::new()
            .session_timeout(silence.as_millis() as u32)
            .application_name("test client")
            .application_uri("urn:verbund:test:client")
            .pki_dir(pki)
            .create_sample_keypair(true)
            .trust_server_certs(true)
            .session_retry_limit(0);
        let mut client = limits::raise_client(builder).client().unwrap();
        let mode = match policy {
            SecurityPolicy::None => MessageSecurityMode::None,
            _ => MessageSecurityMode::SignAndEncrypt,
        };
        let endpoint = (url, policy.to_str(), mode, UserTokenPolicy::anonymous());
        let connected: Result<_, Error> =
            client.connect_to_matching_endpoint(endpoint, identity).await;
        let (session, event_loop) = connected.map_err(|error| error.status())?;
        let mut events = event_loop.spawn();
        tokio::select! {
            is_connected = session.wait_for_connection() => {
                if is_connected { Ok(Self { session, events }) } else { Err(events.await.unwrap()) }
            }
            ended = &mut events => Err(ended.unwrap()),
        }
    }

    pub async fn close(self) {
        self.session.disconnect().await.unwrap();
        tokio::time::timeout(DEADLINE, self.events).await.unwrap().unwrap();
    }

    /// Drops the connection without closing the session.
    pub fn vanish(self) {
        self.events.abort();
    }

    pub async fn attribute(&self, node_id: &NodeId, attribute: AttributeId) -> StackValue {
        let wanted = ReadValueId {
            node_id: node_id.clone(),
            attribute_id: attribute as u32,
            ..ReadValueId::default()
        };
        let mut values = self.session.read(&[wanted], TimestampsToReturn::Both, 0.0).await.unwrap();
        values.remove(0)
    }

    pub async fn read(&self, identifier: &str) -> StackValue {
        self.attribute(&instance(identifier), AttributeId::Value).await
    }

    pub async fn browse(
        &self,
        node_id: impl Into<NodeId>,
        direction: BrowseDirection,
    ) -> Vec<ReferenceDescription> {
        let wanted = BrowseDescription {
            node_id: node_id.into(),
            browse_direction: direction,
            reference_type_id: ReferenceTypeId::References.into(),
            include_subtypes: true,
            node_class_mask: 0,
            result_mask: BrowseResultMask::All as u32,
        };
        let mut result = self.session.browse(&[wanted], 0, None).await.unwrap().remove(0);
        assert!(result.status_code.is_good(), "{}", result.status_code);
        let mut references = result.references.take().unwrap_or_default();
        while !result.continuation_point.is_null_or_empty() {
            result = self
                .session
                .browse_next(false, &[result.continuation_point])
                .await
                .unwrap()
                .remove(0);
            references.extend(result.references.take().unwrap_or_default());
        }
        references
    }

    /// Returns the BrowseNames of the targets of forward references.
    pub async fn children(&self, node_id: impl Into<NodeId>) -> Vec<String> {
        let references = self.browse(node_id, BrowseDirection::Forward).await;
        references.into_iter().map(|r| r.browse_name.name.to_string()).collect()
    }

    pub async fn write(&self, identifier: &str, value: impl Into<Variant>) -> StackStatus {
        let value = opcua_stack::opcua::types::WriteValue {
            node_id: instance(identifier),
            attribute_id: AttributeId::Value as u32,
            value: StackValue { value: Some(value.into()), ..StackValue::default() },
            ..Default::default()
        };
        self.session.write(&[value]).await.unwrap().remove(0)
    }

    /// Subscribes to values; each change is (position among the nodes, value).
    pub async fn subscribe(&self, nodes: &[NodeId]) -> mpsc::UnboundedReceiver<(u32, StackValue)> {
        let (sender, receiver) = mpsc::unbounded_channel();
        let callback = opcua_stack::opcua::client::DataChangeCallback::new(move |value, item| {
            // The test may have ended.
            // The client takes handle 0 for "any", so they count from 1.
            let _ = sender.send((item.client_handle() - 1, value));
        });
        let interval = Duration::from_millis(10);
        let subscription = self
            .session
            .create_subscription(interval, 1000, 100, 0, 0, true, callback)
            .await
            .unwrap();
        let items: Vec<_> = (1_u32..)
            .zip(nodes)
            .map(|(handle, node_id)| MonitoredItemCreateRequest {
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
            })
            .collect();
        for chunk in items.chunks(5000) {
            let created = self
                .session
                .create_monitored_items(subscription, TimestampsToReturn::Both, chunk.to_vec())
                .await
                .unwrap();
            assert!(
                created.iter().all(|item| item.result.status_code.is_good()),
                "all nodes can be monitored"
            );
        }
        receiver
    }
}

/// Waits for the next notification, within the deadline.
pub async fn next<T>(receiver: &mut mpsc::UnboundedReceiver<T>) -> T {
    tokio::time::timeout(DEADLINE, receiver.recv())
        .await
        .expect("a notification comes in time")
        .unwrap()
}
