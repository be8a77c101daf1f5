//! The twin as a component: built from its configuration, runs until shutdown.

use std::{
    net::{SocketAddr, TcpListener},
    sync::{Arc, OnceLock},
    time::Duration,
};

use asi_model::FactoryId;
use futures::future::maybe_done;
use opcua_stack::{
    NamespaceTable, limits,
    opcua::{
        crypto::SecurityPolicy,
        server::{
            ANONYMOUS_USER_TOKEN_ID, ClientLimits, Server, ServerBuilder, ServerCapabilities,
            ServerEndpoint, ServerHandle, ServiceCapabilities,
            node_manager::{DynNodeManager, NodeManagerBuilder, ServerContext},
        },
        types::{BuildInfo, MessageSecurityMode, ServerState},
    },
};
use tokio::sync::{Notify, watch};
use tokio_util::sync::CancellationToken;

use crate::{
    access::{Authenticator, FieldWriter},
    asi::{AsiProvider, AsiSurroundings, TypeProvider, model},
    clock,
    config::{TwinConfig, TwinLimits},
    discovery::Discovery,
    error::TwinError,
    events::{EventReporter, SessionAudit},
    handle::{TrustFiles, TwinHandle},
    host::{HostManager, NodeHost},
    host_names::host_names,
    security::{
        application_certificate::{ApplicationCertificate, application_uri},
        certificate,
        connections::ConnectionLimits,
        login::Login,
        renewal::Renewal,
        review::SessionReview,
        trust::TrustList,
        validation::Validator,
    },
    standard_nodes::{self, PROFILES},
};

/// Time limit to close the connections. A client that does not answer must not hold up the
/// shutdown.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(5);

/// Longest request in bytes: some ten thousand monitored items, or values to write. Answers may be longer.
const REQUEST_BYTES_MAX: usize = 4 << 20;

/// Most nodes of one Browse request, and references of each in one answer: a request cannot ask for much more than what it
/// would read one after the other.
const BROWSED_NODES_MAX: usize = 200;
const BROWSED_REFERENCES_MAX: usize = 1000;

// Shares of one client in all its sessions and connections, where nobody has a reason to set them.

/// Values that wait to be published or acknowledged, beyond the newest one of each item; about 100 bytes each.
const QUEUED_VALUES_MAX: usize = 1_000_000;
/// Continuation points of Browse; each may hold all references of a node.
const CONTINUATION_POINTS_MAX: usize = 100;
/// Requests in progress but those that wait for changes.
const REQUESTS_MAX: usize = 100;
/// Bytes of requests that are not complete or in progress.
const REQUESTS_BYTES_MAX: usize = 4 * REQUEST_BYTES_MAX;
/// Bytes of answers that the client does not take.
const RESPONSES_BYTES_MAX: usize = 2 * limits::MESSAGE_BYTES_MAX;

// Bounds on what all clients hold together: as much as one may hold, and as much again for the others.

/// Values that wait to be published or acknowledged.
const QUEUED_VALUES_OF_ALL_MAX: usize = 2 * QUEUED_VALUES_MAX;
/// Bytes of requests that are not complete or in progress.
const REQUESTS_BYTES_OF_ALL_MAX: usize = 4 * REQUESTS_BYTES_MAX;
/// Bytes of answers that clients do not take.
const RESPONSES_BYTES_OF_ALL_MAX: usize = 2 * RESPONSES_BYTES_MAX;

/// The Collaborative Process Twin, ready to run.
pub struct Twin {
    server: Server,
    handle: ServerHandle,
    listener: TcpListener,
    url: Arc<str>,
    endpoint: watch::Sender<Option<Arc<str>>>,
    discovery: Discovery,
    renewal: Renewal,
    review: SessionReview,
}

impl Twin {
    /// Prepares the twin of a factory: reads or makes its certificate, binds its address and builds
    /// the server. Generates an RSA key at the first start, which takes about a second. Clients are
    /// served once the twin runs.
    ///
    /// # Errors
    /// [`TwinError`] when the address is in use, the certificate folder is not usable, or the
    /// configuration contradicts itself.
    pub fn new(
        factory_id: FactoryId,
        config: TwinConfig,
        writer: Arc<dyn FieldWriter>,
        authenticator: Arc<dyn Authenticator>,
    ) -> Result<(Self, TwinHandle), TwinError> {
        let faults = config.faults();
        if !faults.is_empty() {
            return Err(TwinError::Faults { faults });
        }
        let application_uri = application_uri(&factory_id);
        certificate::ensure(&config, &application_uri, clock::now())?;
        // Bound before the server is built: its URL needs the port that the system chose.
        let (listener, address) = listen(&config)?;
        let port = address.port();
        let host_name = host_names(&config).swap_remove(0);
        let url: Arc<str> = format!("opc.tcp://{}:{port}/", bracketed(&host_name)).into();

        // Filled below: the reporter needs the built server, which needs those who report.
        let events = Arc::new(OnceLock::new());
        let login = Login::new(authenticator, &config.security);
        let validator = Arc::new(Validator::new(
            &config.pki_directory,
            config.security.trust_unknown_certificates,
            Arc::clone(&events),
        ));
        let host = Arc::new(OnceLock::new());
        let builder = configure(&config, &factory_id, &application_uri)
            .host(bracketed(&host_name))
            .port(port)
            .discovery_urls(vec![url.to_string()])
            .with_authenticator(Arc::new(login))
            .with_certificate_validator(Arc::clone(&validator) as _)
            .with_session_observer(Arc::new(SessionAudit { events: Arc::clone(&events) }))
            .with_connection_filter(Arc::new(ConnectionLimits::new(&config.limits)))
            .with_node_manager(HostBuilder(Arc::clone(&host)));
        let (server, handle) =
            builder.build().map_err(|reason| TwinError::Configuration { reason })?;
        let host = host.get().expect("building the server builds its node managers");

        let reporter = Arc::new(EventReporter::new(&handle, application_uri.clone()));
        events.get_or_init(|| Arc::clone(&reporter));
        let interfaces =
            Arc::new(interfaces(&factory_id, host, &handle, writer, Arc::clone(&reporter)));
        host.add_provider(Arc::clone(&interfaces) as _);
        standard_nodes::tailor(&handle);
        warn_of_development_settings(&config);
        let changed = Arc::new(Notify::new());
        let trust_list = TrustList::new(&config.pki_directory, events, Arc::clone(&changed));
        trust_list.warn_of_unapproved();

        let (endpoint, receiver) = watch::channel(None);
        let twin_handle = TwinHandle::new(
            interfaces,
            Arc::clone(host),
            handle.clone(),
            Arc::clone(&reporter),
            TrustFiles {
                trust_list,
                application_certificate: ApplicationCertificate::new(&factory_id, config.clone()),
            },
            receiver,
        );
        let discovery = Discovery::new(&config, address, &handle, Arc::clone(&validator));
        let (server_handle, events) = (handle.clone(), Arc::clone(&reporter));
        let review = SessionReview { server: server_handle, validator, events, changed };
        let renewal = Renewal { config, application_uri, handle: handle.clone(), events: reporter };
        let twin = Self { server, handle, listener, url, endpoint, discovery, renewal, review };
        Ok((twin, twin_handle))
    }

    /// Serves until `shutdown`; then notifies clients and closes.
    ///
    /// # Errors
    /// [`TwinError`] when the server fails.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), TwinError> {
        let Self { server, handle, listener, url, endpoint, discovery, renewal, review } = self;
        let failed = |reason: String| TwinError::Server { reason };
        let listener = tokio::net::TcpListener::from_std(listener)
            .map_err(|error| failed(error.to_string()))?;
        let serving = server.run_with(listener);
        tokio::pin!(serving);
        tracing::info!(endpoint.url = %url, "The twin listens.");
        endpoint.send_replace(Some(url));
        let companions = maybe_done(async {
            tokio::join!(discovery.run(&shutdown), renewal.run(&shutdown), review.run(&shutdown))
        });
        tokio::pin!(companions);
        tokio::select! {
            ended = &mut serving => return ended.map_err(failed),
            () = shutdown.cancelled() => {}
            () = companions.as_mut() => {}
        }
        handle.set_server_state(ServerState::Shutdown);
        handle.cancel();
        let ((), drained) = tokio::join!(companions, tokio::time::timeout(DRAIN_TIMEOUT, serving));
        match drained {
            Ok(ended) => ended.map_err(failed),
            Err(_) => {
                tracing::warn!("The twin closed before all clients had disconnected.");
                Ok(())
            }
        }
    }
}

/// Builds the node manager while the server is built, and publishes its host.
struct HostBuilder(Arc<OnceLock<Arc<NodeHost>>>);

impl NodeManagerBuilder for HostBuilder {
    fn build(self: Box<Self>, context: ServerContext) -> Arc<DynNodeManager> {
        let host = self.0.get_or_init(|| Arc::new(NodeHost::new(&context)));
        Arc::new(HostManager(Arc::clone(host)))
    }
}

/// Connections that wait to be accepted: the library's 128 are full as soon as a crowd comes. Linux drops those
/// that come next, and they try again after a second only.
const ACCEPT_QUEUE: i32 = 4096;

fn listen(config: &TwinConfig) -> Result<(TcpListener, SocketAddr), TwinError> {
    let failed = |source| TwinError::Listen { address: config.listen, source };
    let listener = TcpListener::bind(config.listen).map_err(failed)?;
    rustix::net::listen(&listener, ACCEPT_QUEUE).map_err(|error| failed(error.into()))?;
    listener.set_nonblocking(true).map_err(failed)?;
    let address = listener.local_addr().map_err(failed)?;
    Ok((listener, address))
}

/// Puts an IPv6 address in brackets, as in URLs.
fn bracketed(host: &str) -> String {
    if host.contains(':') && !host.starts_with('[') { format!("[{host}]") } else { host.to_owned() }
}

/// The share of one client in what the server holds.
fn client_limits(limits: &TwinLimits) -> ClientLimits {
    ClientLimits {
        max_sessions: limits.sessions_per_client_max,
        max_subscriptions: limits.subscriptions_per_client_max,
        max_monitored_items: limits.monitored_items_per_client_max,
        max_queued_values: QUEUED_VALUES_MAX,
        max_continuation_points: CONTINUATION_POINTS_MAX,
        max_requests: REQUESTS_MAX,
        max_request_bytes: REQUESTS_BYTES_MAX,
        max_response_bytes: RESPONSES_BYTES_MAX,
    }
}

/// The services and profiles that the twin has.
fn capabilities() -> ServerCapabilities {
    ServerCapabilities {
        profiles: PROFILES.map(ToOwned::to_owned).to_vec(),
        services: ServiceCapabilities { history: false, node_management: false, query: false },
        ..ServerCapabilities::default()
    }
}

fn configure(config: &TwinConfig, factory_id: &FactoryId, application_uri: &str) -> ServerBuilder {
    let mut builder = limits::raise_server(ServerBuilder::new());
    let bounds = builder.limits_mut();
    bounds.max_sessions = config.limits.sessions_max;
    bounds.max_request_size = REQUEST_BYTES_MAX;
    bounds.client = client_limits(&config.limits);
    bounds.all_clients = ClientLimits {
        max_queued_values: QUEUED_VALUES_OF_ALL_MAX,
        max_request_bytes: REQUESTS_BYTES_OF_ALL_MAX,
        max_response_bytes: RESPONSES_BYTES_OF_ALL_MAX,
        ..ClientLimits::default()
    };
    bounds.operational.max_nodes_per_browse = BROWSED_NODES_MAX;
    bounds.operational.max_references_per_browse_node = BROWSED_REFERENCES_MAX;
    bounds.subscriptions.max_monitored_items_per_sub =
        config.limits.monitored_items_per_subscription_max;
    #[expect(clippy::cast_precision_loss, reason = "milliseconds fit a double")]
    {
        bounds.subscriptions.min_publishing_interval_ms =
            config.limits.publishing_interval_ms_min as f64;
    }
    let version = env!("CARGO_PKG_VERSION");
    builder = builder
        .application_name(format!("Verbund Twin of {factory_id}"))
        .application_uri(application_uri)
        .product_uri("urn:verbund:twin")
        .build_info(BuildInfo {
            product_uri: "urn:verbund:twin".into(),
            manufacturer_name: "Verbund".into(),
            product_name: "Collaborative Process Twin".into(),
            software_version: version.into(),
            build_number: version.into(),
            build_date: standard_nodes::build_date(),
        })
        .pki_dir(&config.pki_directory)
        .certificate_path(certificate::CERTIFICATE_FILE)
        .private_key_path(certificate::KEY_FILE)
        .check_cert_time(true)
        .capabilities(capabilities())
        .diagnostics_enabled(true)
        .subscription_poll_interval_ms(config.limits.publishing_tick_ms.max(1));
    for (policy, name) in [
        (SecurityPolicy::Basic256Sha256, "basic256sha256"),
        (SecurityPolicy::Aes128Sha256RsaOaep, "aes128sha256rsaoaep"),
        (SecurityPolicy::Aes256Sha256RsaPss, "aes256sha256rsapss"),
    ] {
        let signed = config.security.allow_signed_unencrypted;
        for (mode, suffix, is_offered) in [
            (MessageSecurityMode::Sign, "sign", signed),
            (MessageSecurityMode::SignAndEncrypt, "sign_and_encrypt", true),
        ] {
            if is_offered {
                let endpoint = ServerEndpoint::new("/", policy, mode, &[]);
                builder = builder.add_endpoint(format!("{name}_{suffix}"), endpoint);
            }
        }
    }
    if config.security.allow_anonymous_unencrypted {
        let anonymous = [ANONYMOUS_USER_TOKEN_ID.to_owned()];
        builder = builder.add_endpoint("none", ServerEndpoint::new_none("/", &anonymous));
    }
    builder
}

fn interfaces(
    factory_id: &FactoryId,
    host: &NodeHost,
    handle: &ServerHandle,
    writer: Arc<dyn FieldWriter>,
    events: Arc<EventReporter>,
) -> AsiProvider {
    let uri = model::instance_namespace_uri(factory_id);
    let types = host.namespace_index(model::ASI_NAMESPACE_URI);
    let instances = host.namespace_index(&uri);
    host.add_provider(Arc::new(TypeProvider::new(types)));
    AsiProvider::new(AsiSurroundings {
        types,
        instances,
        uri,
        subscriptions: Arc::clone(handle.subscriptions()),
        namespaces: namespace_table(handle),
        writer,
        events,
    })
}

fn namespace_table(handle: &ServerHandle) -> NamespaceTable {
    let tree = handle.type_tree().read();
    let mut known: Vec<(u16, String)> = tree
        .namespaces()
        .known_namespaces()
        .iter()
        .map(|(uri, index)| (*index, uri.clone()))
        .collect();
    known.sort();
    NamespaceTable::new(known.into_iter().map(|(_, uri)| uri))
}

fn warn_of_development_settings(config: &TwinConfig) {
    if config.security.allow_anonymous_unencrypted {
        tracing::warn!(
            "DEVELOPMENT SETTING: every client on the network may read the twin, without encryption and without a \
             user, because `allow_anonymous_unencrypted` is set. Remove it outside of development."
        );
    }
    if config.security.allow_signed_unencrypted {
        tracing::warn!(
            "Everybody on the way between the twin and a client that does not encrypt reads values and writes, because \
             `allow_signed_unencrypted` is set. Remove it as soon as all clients encrypt."
        );
    }
    if config.security.trust_unknown_certificates {
        tracing::warn!(
            "DEVELOPMENT SETTING: the twin trusts every client certificate that nobody denied, as long as \
             `trust_unknown_certificates` is set. Remove it outside of development and approve certificates one by one."
        );
    }
}
