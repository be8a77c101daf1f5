//! The platform as a component: opened from its configuration, run until shutdown.

use std::{
    convert::Infallible, net::SocketAddr, os::unix::fs::DirBuilderExt, path::PathBuf, sync::Arc, time::Duration,
};

use asi_model::DateTime;
use broker::{Broker, BrokerConfig, BrokerError, Carrier, Listener, TlsIdentity};
use daemon::{
    lifecycle::{Importance, Lifecycle},
    telemetry::{Metrics, TelemetryError},
    web::{
        health::Readiness,
        server::{self, ServerError},
        session::{PasswordError, SessionConfig, Sessions, random_token},
    },
};
use messaging::{BrokerProfile, BrokerUrl, Link, LinkConfig, LinkError, LinkState, Login, Roots};
use tokio::{net::TcpListener, sync::watch};
use tokio_util::sync::CancellationToken;

use crate::{
    accounts::StoredAccounts,
    administrator::{self, AdministratorError},
    api,
    application::{Application, BrokerAccess, Parts},
    certificates::{CertificateAuthority, CertificateError},
    clock::Clock,
    config::PlatformConfig,
    ingest::Ingest,
    live::{EVENTS_KEPT_MAX, LiveLog},
    networks::Resender,
    outgoing::StoredSpool,
    progress_board::ProgressBoard,
    reach::{PLATFORM_USER, Reach, ReachError},
    receipts::Receipter,
    retention::Retention,
    store::{Store, StoreError},
};

/// The platform cannot start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The data directory cannot be made.
    #[error("cannot make the data directory {}; set data_directory to a place that can be written", path.display())]
    DataDirectory {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The root certificates of an external broker cannot be read.
    #[error("cannot read broker.external.root_certificates {}", path.display())]
    RootCertificates {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The database cannot be used.
    #[error("the database cannot be used")]
    Store(#[from] StoreError),
    /// The embedded broker cannot start.
    #[error("the embedded broker cannot start")]
    Broker(#[from] BrokerError),
    /// The certificate authority cannot be used.
    #[error("the certificate authority cannot be used")]
    Certificates(#[from] CertificateError),
    /// The link cannot be made.
    #[error("the link to the broker cannot be made")]
    Link(#[from] LinkError),
    /// Users and queues cannot be set up.
    #[error("users and queues cannot be set up")]
    Reach(#[from] ReachError),
    /// The pages cannot be served.
    #[error("pages and API cannot be served")]
    Web(#[from] ServerError),
    /// The first administrator cannot be made.
    #[error("the first administrator cannot be made")]
    Administrator(#[from] AdministratorError),
    /// A password is refused.
    #[error("admin.password is refused")]
    Password(#[from] PasswordError),
    /// Metrics cannot be set up.
    #[error("metrics cannot be set up")]
    Telemetry(#[from] TelemetryError),
}

/// An opened platform; [`start`](Self::start) its tasks.
pub struct Platform {
    application: Application,
    web_listener: TcpListener,
    web_tls: Option<Arc<rustls::ServerConfig>>,
    broker: Option<Broker>,
    link: Link,
    ingest: Ingest,
    board: ProgressBoard,
}

/// How an opened platform is reached; the real ports where the configuration said 0.
#[derive(Debug, Clone)]
pub struct PlatformHandle {
    /// Where pages and API listen.
    pub web_address: SocketAddr,
    /// Where the embedded broker listens, in the order TLS, plain, WebSocket.
    pub broker_addresses: Vec<SocketAddr>,
    /// The shared parts, for tests and commands inside the process.
    pub application: Application,
}

impl Platform {
    /// Opens everything that can fail: database, listeners, broker, certificates. `lifecycle` gives the shutdown that
    /// live streams end with.
    ///
    /// # Errors
    /// [`StartError`].
    pub async fn open(
        config: PlatformConfig,
        clock: Clock,
        lifecycle: &Lifecycle,
    ) -> Result<(Self, PlatformHandle), StartError> {
        make_data_directory(&config)?;
        let metrics = Metrics::install()?;
        let store = Store::open(&config.database_path()).await?;
        administrator::ensure(&store, &config, clock.now()).await?;

        let started_at = clock.now();
        let live = LiveLog::new(EVENTS_KEPT_MAX, u64::try_from(started_at.ticks()).unwrap_or_default());
        let reach = Reach::new(config.broker.users.clone());
        let (board, progress) = ProgressBoard::new(store.clone(), live.clone());
        let resend_after = Duration::from_millis(config.parts.resend_after_ms);
        let silence = config.lease_silence();
        let (ingest, ingest_handle) =
            Ingest::new(store.clone(), live.clone(), reach.clone(), progress, clock.clone(), resend_after, silence)
                .await?;

        let (broker, access, link_config) = open_broker(&config, &reach, &store, started_at).await?;
        let broker_addresses = reach.broker().map(|broker| broker.local_addresses().to_vec()).unwrap_or_default();
        let (link, link_handle) =
            Link::new(link_config, Arc::new(StoredSpool::new(store.clone())), Arc::new(ingest_handle.clone()))?;
        reach.set_link(link_handle);

        let web_tls = config.web.tls.as_ref().map(server::TlsFiles::load).transpose()?;
        let web_listener = server::listen(config.web.listen).await?;
        let web_address =
            web_listener.local_addr().map_err(|source| ServerError::Listen { address: config.web.listen, source })?;
        let scheme = if web_tls.is_some() { "https" } else { "http" };
        let public_url = config.web.public_url.clone().unwrap_or_else(|| format!("{scheme}://{web_address}"));
        let is_secure = public_url.starts_with("https://");
        let sessions = Sessions::new(
            SessionConfig::new("verbund_platform", is_secure),
            StoredAccounts::new(store.clone(), clock.clone()),
        );
        let application = Application::new(Parts {
            config,
            store,
            live,
            reach,
            ingest: ingest_handle,
            sessions,
            clock,
            broker_access: access,
            public_url,
            readiness: Readiness::new(),
            metrics,
            started_at,
            shutdown: lifecycle.shutdown(),
        });
        let handle = PlatformHandle { web_address, broker_addresses, application: application.clone() };
        Ok((Self { application, web_listener, web_tls, broker, link, ingest, board }, handle))
    }

    /// Starts all tasks in the lifecycle.
    pub fn start(self, lifecycle: &Lifecycle) {
        let Self { application, web_listener, web_tls, broker, link, ingest, board } = self;
        let (store, reach, clock) = (application.store.clone(), application.reach.clone(), application.clock.clone());
        // At shutdown the link goes first, so that what it has received is still stored and settled; then its two ends.
        let after_link = CancellationToken::new();
        if let Some(broker) = broker {
            lifecycle.spawn("broker", Importance::Essential, broker.run(after_link.clone()));
        }
        lifecycle.spawn("ingest", Importance::Essential, ingest.run(after_link.clone()));
        // Queues can only be declared once the broker runs, so this is the first task's work and not the opening's.
        let reconciling = reach.clone().reconcile_at_start(store.clone(), lifecycle.shutdown());
        lifecycle.spawn("reach", Importance::Optional, async move {
            reconciling.await;
            Ok::<(), Infallible>(())
        });
        let link_shutdown = lifecycle.shutdown();
        lifecycle.spawn("link", Importance::Essential, async move {
            let _ends_with_it = after_link.drop_guard();
            link.run(link_shutdown).await;
            Ok::<(), Infallible>(())
        });
        if let Some(link) = reach.link() {
            let watching = watch_link(link.state(), application.clone());
            let watching = lifecycle.shutdown().run_until_cancelled_owned(watching);
            lifecycle.spawn("link watch", Importance::Optional, async move {
                watching.await;
                Ok::<(), Infallible>(())
            });
        }
        let receipter =
            Receipter::new(store.clone(), reach.clone(), clock.clone(), application.config.receipt_interval());
        lifecycle.spawn("receipts", Importance::Essential, receipter.run(lifecycle.shutdown()));
        let resender = Resender::new(store.clone(), reach, clock.clone(), application.resend_after());
        lifecycle.spawn("resending", Importance::Essential, resender.run(lifecycle.shutdown()));
        lifecycle.spawn("progress", Importance::Essential, board.run(lifecycle.shutdown()));
        let kept = Duration::from_secs(u64::from(application.config.retention.inbox_days) * 86_400);
        lifecycle.spawn(
            "retention",
            Importance::Optional,
            Retention::new(store, clock, kept).run(lifecycle.shutdown()),
        );
        let metrics = application.metrics.clone().run(lifecycle.shutdown());
        lifecycle.spawn("metrics", Importance::Optional, async move {
            metrics.await;
            Ok::<(), Infallible>(())
        });
        let router = api::router(&application, web_tls.is_some());
        lifecycle.spawn(
            "web",
            Importance::Essential,
            server::serve(web_listener, web_tls, router, lifecycle.shutdown()),
        );
    }
}

/// What partners entrust to the platform is for its own user only.
fn make_data_directory(config: &PlatformConfig) -> Result<(), StartError> {
    std::fs::DirBuilder::new()
        .recursive(true)
        .mode(0o700)
        .create(&config.data_directory)
        .map_err(|source| StartError::DataDirectory { path: config.data_directory.clone(), source })
}

/// Runs the embedded broker alone, with the users and queues of the platform's database as they are now.
///
/// # Errors
/// [`StartError`].
pub async fn start_broker_alone(
    config: &PlatformConfig,
    clock: &Clock,
    lifecycle: &Lifecycle,
) -> Result<Vec<SocketAddr>, StartError> {
    make_data_directory(config)?;
    let store = Store::open(&config.database_path()).await?;
    let reach = Reach::new(config.broker.users.clone());
    let embedded = PlatformConfig {
        broker: crate::config::BrokerConfig { external: None, ..config.broker.clone() },
        ..config.clone()
    };
    let (broker, _, _) = open_broker(&embedded, &reach, &store, clock.now()).await?;
    if let Some(broker) = broker {
        lifecycle.spawn("broker", Importance::Essential, broker.run(lifecycle.shutdown()));
    }
    reach.reconcile(&store).await?;
    Ok(reach.broker().map(|broker| broker.local_addresses().to_vec()).unwrap_or_default())
}

/// Opens the embedded broker, or prepares to use another one. The embedded one knows its users from then on: whoever
/// waits at the door of a broker that starts again must not be refused, since a refused peer stays away for minutes.
async fn open_broker(
    config: &PlatformConfig,
    reach: &Reach,
    store: &Store,
    now: DateTime,
) -> Result<(Option<Broker>, BrokerAccess, LinkConfig), StartError> {
    // Unique per running instance, so that a broker's log tells them apart.
    let container = format!("platform-{}", &random_token()[..8]);
    if let Some(external) = &config.broker.external {
        let pem = match &external.root_certificates {
            None => None,
            Some(path) => Some(
                std::fs::read_to_string(path)
                    .map_err(|source| StartError::RootCertificates { path: path.clone(), source })?,
            ),
        };
        let first = external.urls.first().ok_or(LinkError::NoBroker)?;
        let login = Login::new(&external.user_name, external.password.expose());
        let mut link = LinkConfig::new(first.clone(), login, container);
        link.brokers.clone_from(&external.urls);
        link.profile = external.profile.clone();
        if let Some(pem) = &pem {
            link.tls.roots = Roots::Pem(pem.clone().into_bytes().into());
        }
        let url = config.broker.public_url.as_ref().unwrap_or(first).to_string();
        let access = BrokerAccess { url, profile: external.profile.clone(), root_certificate_pem: pem };
        return Ok((None, access, link));
    }

    reach.load_users(store).await?;
    let authority = CertificateAuthority::open(&config.authority_directory(), now.into())?;
    let mut names = vec!["localhost".to_owned(), "127.0.0.1".to_owned(), "::1".to_owned()];
    names.extend(config.broker.host_names.iter().cloned());
    if let Some(url) = &config.broker.public_url {
        names.push(url.host().to_owned());
    }
    names.dedup();
    let issued = authority.issue(&names, now.into())?;
    let tls = TlsIdentity { certificates_pem: issued.certificates_pem, key_pem: issued.key_pem };
    let listener = Listener { address: config.broker.listen, tls: Some(tls.clone()), carrier: Carrier::Stream };
    let mut broker_config = BrokerConfig::new(listener, config.broker_database_path());
    if let Some(address) = config.broker.plain_listen {
        broker_config.listeners.push(Listener { address, tls: None, carrier: Carrier::Stream });
    }
    if let Some(address) = config.broker.websocket_listen {
        broker_config.listeners.push(Listener { address, tls: Some(tls), carrier: Carrier::WebSocket });
    }
    let (broker, handle) = Broker::new(broker_config, reach.users()).await?;
    let address = handle.local_addresses().first().copied().unwrap_or(config.broker.listen);
    reach.set_broker(handle);

    // We reach our own broker on this machine, whatever address it listens on for others.
    let own_host = if address.ip().is_unspecified() { "localhost".to_owned() } else { host(address) };
    let own_url: BrokerUrl =
        format!("amqps://{own_host}:{}", address.port()).parse().expect("a host and a port make a broker address");
    let mut link = LinkConfig::new(own_url.clone(), Login::new(PLATFORM_USER, reach.secret()), container);
    link.tls.roots = Roots::Pem(authority.root_pem().to_owned().into_bytes().into());
    if !address.ip().is_loopback() {
        link.tls.server_name = Some("localhost".to_owned());
    }
    let access = BrokerAccess {
        url: config.broker.public_url.as_ref().unwrap_or(&own_url).to_string(),
        profile: BrokerProfile::embedded(),
        root_certificate_pem: Some(authority.root_pem().to_owned()),
    };
    Ok((Some(broker), access, link))
}

fn host(address: SocketAddr) -> String {
    match address {
        SocketAddr::V4(address) => address.ip().to_string(),
        SocketAddr::V6(address) => format!("[{}]", address.ip()),
    }
}

/// Keeps `/readyz` in line with the link.
async fn watch_link(mut states: watch::Receiver<LinkState>, application: Application) {
    loop {
        let state = states.borrow_and_update().clone();
        if state.is_up() {
            application.readiness.ready("link");
        } else {
            let reason = state.reason.unwrap_or_else(|| "the link to the broker is not up yet".to_owned());
            application.readiness.waiting("link", reason);
        }
        if states.changed().await.is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use broker::Credentials;

    use super::*;

    #[tokio::test]
    async fn the_broker_knows_its_users_before_it_accepts_anyone() {
        drop(rustls::crypto::ring::default_provider().install_default());
        let folder = tempfile::tempdir().expect("a folder");
        let text = format!(
            "data_directory = {:?}\n[broker]\nlisten = \"127.0.0.1:0\"\n[[broker.users]]\nuser_name = \"observer\"\n\
             password = \"of the broker alone\"\nconsume = []\nproduce = []\n",
            folder.path()
        );
        let config: PlatformConfig = daemon::configuration::parse(None, &text, "NOTHING", []).expect("valid");
        let store = Store::open(&config.database_path()).await.expect("a database");
        let reach = Reach::new(config.broker.users.clone());
        let (broker, ..) = open_broker(&config, &reach, &store, Clock::system().now()).await.expect("it opens");
        assert!(broker.is_some(), "it is embedded, and does not run yet");
        for user in ["observer", PLATFORM_USER] {
            assert!(reach.users().user(user).is_some(), "{user}");
        }
    }
}
