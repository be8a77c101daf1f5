//! The platform as a component: opened from its configuration, run until shutdown.

mod brokers;

use std::{
    convert::Infallible, net::SocketAddr, os::unix::fs::DirBuilderExt, path::PathBuf, sync::Arc,
    time::Duration,
};

use broker::{Broker, BrokerError};
use daemon::{
    lifecycle::{Importance, Lifecycle},
    telemetry::{Metrics, TelemetryError},
    web::{
        health::Readiness,
        server::{self, ServerError},
        session::{PasswordError, SessionConfig, Sessions},
    },
};
use messaging::{Link, LinkError, LinkState};
use tokio::{net::TcpListener, sync::watch};
use tokio_util::sync::CancellationToken;

use crate::{
    accounts::StoredAccounts,
    administrator::{self, AdministratorError},
    api,
    application::{Application, Parts},
    certificates::CertificateError,
    clock::Clock,
    config::PlatformConfig,
    ingest::Ingest,
    live::{EVENTS_KEPT_MAX, LiveLog},
    networks::Resender,
    outgoing::StoredSpool,
    progress_board::ProgressBoard,
    reach::{Reach, ReachError},
    receipts::Receipter,
    retention::Retention,
    store::{Store, StoreError},
};

pub use brokers::start_broker_alone;

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
    /// Opens everything that can fail: database, listeners, broker, certificates. `lifecycle` gives
    /// the shutdown that live streams end with.
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
        let live =
            LiveLog::new(EVENTS_KEPT_MAX, u64::try_from(started_at.ticks()).unwrap_or_default());
        let reach = Reach::new(config.broker.users.clone());
        let (board, progress) = ProgressBoard::new(store.clone(), live.clone());
        let resend_after = Duration::from_millis(config.parts.resend_after_ms);
        let silence = config.lease_silence();
        let (ingest, ingest_handle) = Ingest::new(
            store.clone(),
            live.clone(),
            reach.clone(),
            progress,
            clock.clone(),
            resend_after,
            silence,
        )
        .await?;

        let (broker, access, link_config) =
            brokers::open(&config, &reach, &store, started_at).await?;
        let broker_addresses =
            reach.broker().map(|broker| broker.local_addresses().to_vec()).unwrap_or_default();
        let (link, link_handle) = Link::new(
            link_config,
            Arc::new(StoredSpool::new(store.clone())),
            Arc::new(ingest_handle.clone()),
        )?;
        reach.set_link(link_handle);

        let web_tls = config.web.tls.as_ref().map(server::TlsFiles::load).transpose()?;
        let web_listener = server::listen(config.web.listen).await?;
        let web_address = web_listener
            .local_addr()
            .map_err(|source| ServerError::Listen { address: config.web.listen, source })?;
        let scheme = if web_tls.is_some() { "https" } else { "http" };
        let public_url =
            config.web.public_url.clone().unwrap_or_else(|| format!("{scheme}://{web_address}"));
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
        let handle =
            PlatformHandle { web_address, broker_addresses, application: application.clone() };
        Ok((Self { application, web_listener, web_tls, broker, link, ingest, board }, handle))
    }

    /// Starts all tasks in the lifecycle.
    pub fn start(self, lifecycle: &Lifecycle) {
        let Self { application, web_listener, web_tls, broker, link, ingest, board } = self;
        let (store, reach, clock) =
            (application.store.clone(), application.reach.clone(), application.clock.clone());
        // At shutdown the link goes first, so that what it has received is still stored and
        // settled; then its two ends.
        let after_link = CancellationToken::new();
        if let Some(broker) = broker {
            lifecycle.spawn("broker", Importance::Essential, broker.run(after_link.clone()));
        }
        lifecycle.spawn("ingest", Importance::Essential, ingest.run(after_link.clone()));
        // Queues can only be declared once the broker runs, so this is the first task's work and
        // not the opening's.
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
        let receipter = Receipter::new(
            store.clone(),
            reach.clone(),
            clock.clone(),
            application.config.receipt_interval(),
        );
        lifecycle.spawn("receipts", Importance::Essential, receipter.run(lifecycle.shutdown()));
        let resender =
            Resender::new(store.clone(), reach, clock.clone(), application.resend_after());
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

/// Keeps `/readyz` in line with the link.
async fn watch_link(mut states: watch::Receiver<LinkState>, application: Application) {
    loop {
        let state = states.borrow_and_update().clone();
        if state.is_up() {
            application.readiness.ready("link");
        } else {
            let reason =
                state.reason.unwrap_or_else(|| "the link to the broker is not up yet".to_owned());
            application.readiness.waiting("link", reason);
        }
        if states.changed().await.is_err() {
            return;
        }
    }
}
