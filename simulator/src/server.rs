//! The OPC UA server of a machine, made from its blueprint.

mod conditions;
mod events;
mod layout;
mod nodes;

use std::{
    collections::HashMap,
    net::SocketAddr,
    path::{Path, PathBuf},
    sync::{Arc, atomic::Ordering},
    time::Duration,
};

use asi_model::values::{BuiltInType, DataValue, DateTime, NodeId};
use opcua_stack::{
    NamespaceTable, limits,
    opcua::{
        crypto::SecurityPolicy,
        nodes::{Event, NodeType},
        server::{
            ANONYMOUS_USER_TOKEN_ID, Server, ServerBuilder, ServerEndpoint, ServerHandle,
            ServerUserToken,
            address_space::AddressSpace,
            diagnostics::DiagnosticsNodeManagerBuilder,
            node_manager::{
                ServerContext,
                memory::{CoreNodeManagerBuilder, InMemoryNodeManager, InMemoryNodeManagerBuilder},
            },
        },
        types::{
            AttributeId, DataEncoding, DataValue as StackValue, MessageSecurityMode,
            NodeId as StackId, NumericRange, ObjectTypeId, TimestampsToReturn,
        },
    },
    values::{node_id_from_stack, to_stack},
};
use shop_floor_model::ProfileLimit;
use tokio::{net::TcpListener, task::JoinHandle};

use crate::{
    Layout, MachineCondition, MachineConfig, MachineEvent, SecurityConfig, SimulatorError,
    blueprint::Blueprint, records::MachineRecords,
};

use conditions::ConditionMethods;
use events::ShownEvent;
use nodes::{MachineNodes, Variable};

/// Longest wait until a server ends by itself.
const STOP_TIMEOUT: Duration = Duration::from_millis(500);

/// Running OPC UA server of one machine.
pub(crate) struct MachineServer {
    handle: ServerHandle,
    task: JoinHandle<()>,
    address: SocketAddr,
    nodes: Arc<InMemoryNodeManager<MachineNodes>>,
    table: NamespaceTable,
    variables: HashMap<String, Variable>,
    name: String,
    records: Arc<MachineRecords>,
}

impl MachineServer {
    /// Builds and starts a server; it is reachable when this returns. Clients are told
    /// `public_port`.
    pub(crate) async fn start(
        config: &MachineConfig,
        blueprint: &Arc<Blueprint>,
        layout: Layout,
        listener: TcpListener,
        public_port: u16,
        pki_directory: &Path,
        records: Arc<MachineRecords>,
    ) -> Result<Self, SimulatorError> {
        let fail = |reason: String| SimulatorError::Server { machine: config.name.clone(), reason };
        let address = listener.local_addr().map_err(|error| fail(error.to_string()))?;
        let assembled = {
            let (config, blueprint, pki) =
                (config.clone(), Arc::clone(blueprint), pki_directory.join(&config.name));
            let records = Arc::clone(&records);
            // Making a key takes seconds without optimisation.
            tokio::task::spawn_blocking(move || {
                assemble(&config, blueprint, layout, address, public_port, pki, records)
            })
            .await
        };
        let (server, handle) = assembled.map_err(|error| fail(error.to_string()))?.map_err(fail)?;
        let nodes = handle.node_managers().get_of_type::<InMemoryNodeManager<MachineNodes>>();
        let nodes = nodes.ok_or_else(|| fail("the server has no machine".into()))?;
        let (table, variables) = (nodes.inner().table().clone(), nodes.inner().variables().clone());
        let task = tokio::spawn(async move {
            if let Err(error) = server.run_with(listener).await {
                tracing::error!(%error, "The server of a machine ended.");
            }
        });
        // The server says its own port to clients as soon as it runs; theirs is another one behind
        // a relay.
        while handle.info().port.load(Ordering::Relaxed) == 0 && !task.is_finished() {
            tokio::task::yield_now().await;
        }
        handle.info().port.store(public_port, Ordering::Relaxed);
        let name = config.name.clone();
        Ok(Self { handle, task, address, nodes, table, variables, name, records })
    }

    /// Returns the address that the server listens on.
    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// The present identity of each variable.
    pub(crate) fn node_ids(&self) -> HashMap<String, NodeId> {
        self.variables
            .iter()
            .map(|(key, variable)| (key.clone(), node_id_from_stack(&variable.id, &self.table)))
            .collect()
    }

    /// The built-in type of a variable.
    pub(crate) fn built_in(&self, key: &str) -> Option<BuiltInType> {
        self.variables.get(key).map(|variable| variable.built_in)
    }

    /// Returns the current value of a variable.
    pub(crate) fn value(&self, key: &str) -> Option<DataValue> {
        let variable = self.variables.get(key)?;
        let space = self.nodes.address_space().read();
        let value = match space.find(&variable.id)? {
            NodeType::Variable(node) => node.value(
                TimestampsToReturn::Both,
                &NumericRange::None,
                &DataEncoding::Binary,
                0.0,
            ),
            _ => return None,
        };
        Some(opcua_stack::values::from_stack(value, &self.table))
    }

    /// Stores values and tells the subscriptions.
    pub(crate) fn publish<'a>(&self, values: impl IntoIterator<Item = (&'a str, DataValue)>) {
        let values: Vec<(StackId, StackValue)> = values
            .into_iter()
            .filter_map(|(key, value)| {
                let Variable { id, has_history, .. } = self.variables.get(key)?.clone();
                if has_history {
                    self.records.record(key, value.clone());
                }
                match to_stack(&value, &self.table) {
                    Ok(value) => Some((id, value)),
                    Err(error) => {
                        tracing::error!(variable = key, %error, "A machine's value cannot be shown.");
                        None
                    }
                }
            })
            .collect();
        let mut space = self.nodes.address_space().write();
        for (id, value) in &values {
            if let Some(NodeType::Variable(node)) = space.find_mut(id) {
                node.set_data_value(value.clone());
            }
        }
        // Told under the lock, so that a new item gets either its first value or the notification,
        // in order.
        let muted = self.nodes.inner().muted();
        let mut notifier = self.handle.subscriptions().data_notifier();
        for (id, value) in values {
            let Some(mut batch) = notifier.notify_for(&id, AttributeId::Value) else { continue };
            for (handle, _) in
                batch.entries().filter(|(handle, _)| handle.monitored_item_id > muted)
            {
                batch.data_value_to_item(value.clone(), handle);
            }
        }
    }

    /// Raises an event of the machine.
    pub(crate) fn raise(&self, event: &MachineEvent, at: DateTime) {
        let source = (self.nodes.inner().root(), self.name.as_str());
        self.notify(&ShownEvent::new(ObjectTypeId::SystemEventType, event, source, at));
    }

    /// Raises the event of a condition whose state changed.
    pub(crate) fn show_condition(&self, name: &str, condition: &MachineCondition, at: DateTime) {
        let source = (self.nodes.inner().root(), self.name.as_str());
        self.notify(&ShownEvent::alarm(name, condition, source, at));
    }

    fn notify(&self, event: &ShownEvent) {
        let root = self.nodes.inner().root();
        self.handle.subscriptions().notify_events([(event as &dyn Event, root)].into_iter());
    }

    /// Mutes the notifications of existing monitored items, or ends that.
    pub(crate) fn mute(&self, is_muted: bool) {
        self.nodes.inner().mute(is_muted);
    }

    /// Ends the server. Clients are not notified when their connections were cut before.
    pub(crate) async fn stop(mut self) {
        self.handle.cancel();
        if tokio::time::timeout(STOP_TIMEOUT, &mut self.task).await.is_err() {
            self.task.abort();
            let _ = self.task.await;
        }
    }
}

fn assemble(
    config: &MachineConfig,
    blueprint: Arc<Blueprint>,
    layout: Layout,
    address: SocketAddr,
    public_port: u16,
    pki_directory: PathBuf,
    records: Arc<MachineRecords>,
) -> Result<(Server, ServerHandle), String> {
    let name = config.name.clone();
    let builder = limited(limits::raise_server(ServerBuilder::new()), config);
    let builder = builder
        .application_name(format!("{name} (simulated)"))
        .application_uri(application_uri(config))
        .product_uri("urn:verbund:simulator")
        .host(address.ip().to_string())
        .port(public_port)
        .discovery_urls(vec!["/".to_owned()])
        .pki_dir(pki_directory)
        .certificate_path("own/cert.der")
        .private_key_path("private/private.pem")
        .create_sample_keypair(config.security.protected)
        .trust_client_certs(config.security.trusts_all_clients);
    let nodes =
        InMemoryNodeManagerBuilder::new(move |context: ServerContext, space: &mut AddressSpace| {
            MachineNodes::build(&blueprint, layout, &name, records, &context, space)
        });
    secure(builder, &config.security)
        .without_node_managers()
        .with_node_manager(|context: ServerContext| ConditionMethods::new(&context))
        .with_node_manager(InMemoryNodeManagerBuilder::new(CoreNodeManagerBuilder))
        .with_node_manager(DiagnosticsNodeManagerBuilder)
        .with_node_manager(nodes)
        .build()
}

/// Returns the application URI of a machine's server; one with a profile is recognised by it.
fn application_uri(config: &MachineConfig) -> String {
    let mark = config.profile().and_then(|profile| profile.recognised_by.first());
    let mark = mark.map(|mark| format!(":{mark}")).unwrap_or_default();
    format!("urn:verbund:simulator:server:{}{mark}", config.name)
}

/// Sets the limits of a machine and of its profile.
fn limited(mut builder: ServerBuilder, config: &MachineConfig) -> ServerBuilder {
    use ProfileLimit as Limit;
    let limits = builder.limits_mut();
    let subscriptions = &mut limits.subscriptions;
    if config.items_per_subscription_max > 0 {
        subscriptions.max_monitored_items_per_sub = config.items_per_subscription_max as usize;
    }
    let own = config.subscriptions_per_session_max;
    if let Some(most) = config.limit(own, Limit::SubscriptionsPerSessionMax) {
        subscriptions.max_subscriptions_per_session = most as usize;
    }
    let own = config.publishing_interval_ms_min;
    if let Some(least) = config.limit(own, Limit::PublishingIntervalMsMin) {
        subscriptions.min_publishing_interval_ms = least.into();
    }
    let own = config.sampling_interval_ms_min;
    if let Some(least) = config.limit(own, Limit::SamplingIntervalMsMin) {
        subscriptions.min_sampling_interval_ms = least.into();
    }
    if let Some(most) = config.limit(config.queue_size_max, Limit::QueueSizeMax) {
        subscriptions.max_monitored_item_queue_size = most as usize;
    }
    if let Some(most) = config.limit(0, Limit::KeepAliveCountMax) {
        subscriptions.max_keep_alive_count = most;
    }
    if let Some(most) = config.limit(0, Limit::LifetimeCountMax) {
        subscriptions.max_lifetime_count = most;
    }
    if let Some(most) = config.limit(config.sessions_max, Limit::SessionsMax) {
        limits.max_sessions = most as usize;
    }
    let operational = &mut limits.operational;
    if let Some(most) = config.limit(0, Limit::NodesPerCallMax) {
        let most = most as usize;
        operational.max_nodes_per_read = most;
        operational.max_nodes_per_write = most;
        operational.max_nodes_per_browse = most;
        operational.max_nodes_per_translate_browse_paths_to_node_ids = most;
        operational.max_monitored_items_per_call = most;
    }
    if let Some(most) = config.limit(0, Limit::NodesPerBrowseMax) {
        operational.max_nodes_per_browse = most as usize;
    }
    builder
}

fn secure(mut builder: ServerBuilder, security: &SecurityConfig) -> ServerBuilder {
    let mut users = Vec::new();
    if security.anonymous {
        users.push(ANONYMOUS_USER_TOKEN_ID.to_owned());
    }
    for user in &security.users {
        builder = builder
            .add_user_token(&user.name, ServerUserToken::user_pass(&user.name, &user.password));
        users.push(user.name.clone());
    }
    if security.unprotected {
        let mut endpoint = ServerEndpoint::new_none("/", &users);
        // Many machines take passwords in plain where nothing is protected.
        endpoint.password_security_policy = Some(SecurityPolicy::None.to_str().to_owned());
        builder = builder.add_endpoint("none", endpoint);
    }
    if security.protected {
        for (id, policy) in [
            ("basic256sha256", SecurityPolicy::Basic256Sha256),
            ("aes256sha256rsapss", SecurityPolicy::Aes256Sha256RsaPss),
        ] {
            let endpoint =
                ServerEndpoint::new("/", policy, MessageSecurityMode::SignAndEncrypt, &users);
            builder = builder.add_endpoint(id, endpoint);
        }
    }
    builder
}
