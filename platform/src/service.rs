//! The platform as a component: opened from its configuration, run until shutdown.

mod broker_login;
mod brokers;
mod error;

use std::{convert::Infallible, net::SocketAddr, path::Path, sync::Arc, time::Duration};

use daemon::{
    data_directory,
    lifecycle::{Importance, Lifecycle},
    plaintext, sealing,
    telemetry::Metrics,
    web::{
        health::Readiness,
        server::{self, ServerError},
        session::{PasswordHashing, SessionConfig, Sessions},
    },
};
use messaging::{Link, LinkState};
use tokio::{net::TcpListener, sync::watch};
use tokio_util::sync::CancellationToken;

use crate::{
    access_log_key::{self, ACCESS_LOG_KEY_FILE, AccessLogKeyError},
    accesses::AccessRecorder,
    accounts::StoredAccounts,
    administrator, api,
    application::{Application, ApplicationParts},
    audit::RecordingStore,
    broker_access::BrokerAccess,
    broker_process::{BrokerProcessHandle, EmbeddedBroker},
    clock::Clock,
    config::PlatformConfig,
    enrolment::EnrolmentAddress,
    ingest::{Ingest, IngestConfig, RoomConfig},
    live::{EVENTS_MAX, LiveLog},
    networks::Resender,
    progress_notifier::ProgressNotifier,
    receipts::Receipter,
    retention::Retention,
    spool::StoredSpool,
    store::Store,
    witness::WitnessKey,
};

use broker_login::BrokerLogin;
use brokers::OpenedBroker;
pub use brokers::start_broker_alone;
pub use error::StartError;

/// An opened platform; [`start`](Self::start) its tasks.
pub struct Platform {
    application: Application,
    store: Store,
    web_listener: TcpListener,
    web_tls: Option<Arc<rustls::ServerConfig>>,
    broker: Option<OpenedBroker>,
    link: Link,
    tasks: (Ingest, ProgressNotifier),
}

/// Addresses and shared state of an opened platform.
#[derive(Debug, Clone)]
pub struct PlatformHandle {
    /// Address of pages and API, with the real port.
    pub web_address: SocketAddr,
    /// Addresses of the embedded broker, with the real ports, in the order TLS, plain, WebSocket.
    pub broker_addresses: Vec<SocketAddr>,
    /// The shared parts, for tests and commands inside the process.
    pub application: Application,
}

impl Platform {
    /// Opens everything that can fail: database, listeners, broker, certificates. `lifecycle` gives
    /// the shutdown that live streams end with; `program` is the platform's program, for the process
    /// of the broker.
    ///
    /// # Errors
    /// [`StartError`].
    pub async fn open(
        config: PlatformConfig,
        clock: Clock,
        lifecycle: &Lifecycle,
        program: &Path,
    ) -> Result<(Self, PlatformHandle), StartError> {
        data_directory::create(&config.data_directory, config.allow_shared_data_directory)?;
        let plaintext_ways = warned(&config);
        let metrics = Metrics::install()?;
        let store = open_store(&config).await?;
        let recording = RecordingStore::new(store.clone(), clock.clone());
        let hashing = PasswordHashing::default();
        administrator::ensure(&recording, &config, &hashing, clock.now()).await?;

        let started_at = clock.now();
        // The mark of this start: a page that comes with an id from before it loads everything.
        let live = LiveLog::new(EVENTS_MAX, u64::try_from(started_at.ticks()).unwrap_or_default());
        let accesses = open_accesses(&config, &store, &clock)?;
        let broker_access = BrokerAccess::new(config.broker.users.clone());
        let (progress_notifier, progress) = ProgressNotifier::new(store.clone(), live.clone());
        let witness = Arc::new(WitnessKey::open(&config.data_directory)?);
        let (ingest, ingest_handle) = Ingest::new(
            ingest_config(&config, Arc::clone(&witness)),
            store.clone(),
            live.clone(),
            broker_access.clone(),
            progress,
            accesses.clone(),
            clock.clone(),
        )
        .await?;

        let (broker, access, link_config) =
            brokers::open(&config, &broker_access, &store.reader(), started_at, program).await?;
        let broker_addresses =
            broker_access.broker().map(|broker| broker.addresses().to_vec()).unwrap_or_default();
        let always_read = link_config.consumed.clone();
        let (link, link_handle) = Link::new(
            link_config,
            Arc::new(StoredSpool::new(store.clone())),
            Arc::new(ingest_handle.clone()),
        )?;
        broker_access.set_link(link_handle, always_read);

        let web_tls = config.web.tls.as_ref().map(server::TlsFiles::load).transpose()?;
        let (web_listener, web_address) = listen(&config).await?;
        let scheme = if web_tls.is_some() { "https" } else { "http" };
        let public_url =
            config.web.public_url.clone().unwrap_or_else(|| format!("{scheme}://{web_address}"));
        let session_config = session_config(&config, &public_url, web_address.port());
        let accounts = StoredAccounts::new(store.clone(), clock.clone());
        let sessions = Sessions::new(session_config, accounts, hashing, config.sealer());
        let application = Application::new(ApplicationParts {
            store: recording,
            accesses,
            live,
            broker_access,
            ingest: ingest_handle,
            witness,
            sessions,
            clock,
            broker_endpoint: access,
            enrolment_address: EnrolmentAddress::new(&config.web, public_url)?,
            plaintext_ways,
            config,
            readiness: Readiness::new(),
            metrics,
            started_at,
            shutdown: lifecycle.shutdown(),
        });
        let tasks = (ingest, progress_notifier);
        let handle =
            PlatformHandle { web_address, broker_addresses, application: application.clone() };
        Ok((Self { application, store, web_listener, web_tls, broker, link, tasks }, handle))
    }

    /// Starts all tasks in the lifecycle.
    pub fn start(self, lifecycle: &Lifecycle) {
        let Self { application, store, web_listener, web_tls, broker, link, tasks } = self;
        let (ingest, progress_notifier) = tasks;
        let (broker_access, clock) = (application.broker_access.clone(), application.clock.clone());
        // At shutdown the link goes first, so that what it has received is still stored and
        // settled; then its two ends.
        let after_link = CancellationToken::new();
        if let Some(broker) = broker {
            broker.start(lifecycle, after_link.clone());
        }
        if let Some(EmbeddedBroker::Process(process)) = broker_access.broker() {
            start_watching(&process, &application, lifecycle);
        }
        let ending = ingest.ending();
        lifecycle.spawn("ingest", Importance::Essential, ingest.run(after_link.clone()));
        // Queues can only be declared once the broker runs, so this is the first task's work and
        // not the opening's.
        let reconciling =
            broker_access.clone().reconcile_at_start(store.reader(), lifecycle.shutdown());
        lifecycle.spawn("reach", Importance::Optional, async move {
            reconciling.await;
            Ok::<(), Infallible>(())
        });
        let running = run_link(link, lifecycle.shutdown(), after_link, ending);
        lifecycle.spawn("link", Importance::Essential, running);
        if let (Some(external), Some(link)) =
            (application.config.broker.external.clone(), broker_access.link())
        {
            let login = BrokerLogin::new(external, application.config.sealer(), link);
            lifecycle.spawn("broker login", Importance::Optional, login.run(lifecycle.shutdown()));
        }
        if let Some(link) = broker_access.link() {
            let watching = watch_link(link.state(), application.clone());
            let watching = lifecycle.shutdown().run_until_cancelled_owned(watching);
            lifecycle.spawn("link watch", Importance::Optional, async move {
                watching.await;
                Ok::<(), Infallible>(())
            });
        }
        let receipter = Receipter::new(
            store.clone(),
            broker_access.clone(),
            clock.clone(),
            application.config.receipt_interval(),
        );
        lifecycle.spawn("receipts", Importance::Essential, receipter.run(lifecycle.shutdown()));
        let resender =
            Resender::new(store.clone(), broker_access, clock.clone(), application.resend_after());
        lifecycle.spawn("resending", Importance::Essential, resender.run(lifecycle.shutdown()));
        lifecycle.spawn(
            "progress",
            Importance::Essential,
            progress_notifier.run(lifecycle.shutdown()),
        );
        let accesses = application.accesses.clone();
        lifecycle.spawn("accesses", Importance::Essential, accesses.run(lifecycle.shutdown()));
        // Optional: a platform that cannot forget still serves.
        lifecycle.spawn(
            "retention",
            Importance::Optional,
            Retention::new(store, clock, &application.config.retention).run(lifecycle.shutdown()),
        );
        let metrics = application.metrics.clone().run(lifecycle.shutdown());
        lifecycle.spawn("metrics", Importance::Optional, async move {
            metrics.await;
            Ok::<(), Infallible>(())
        });
        let router = api::router(&application, web_tls.is_some());
        let limits = application.config.web.limits();
        let serving = server::serve(web_listener, web_tls, router, limits, lifecycle.shutdown());
        lifecycle.spawn("web", Importance::Essential, async move {
            serving.await;
            Ok::<(), Infallible>(())
        });
    }
}

/// Listens for pages and callers of the API.
async fn listen(config: &PlatformConfig) -> Result<(TcpListener, SocketAddr), ServerError> {
    let address = config.web.listen;
    let listener = server::listen(address).await?;
    let bound = listener.local_addr().map_err(|source| ServerError::Listen { address, source })?;
    Ok((listener, bound))
}

/// Opens the database, and seals what a former version left in plain text before anybody signs in.
async fn open_store(config: &PlatformConfig) -> Result<Store, StartError> {
    let mut store = Store::open(&config.database_path()).await?;
    let sealed = sealing::seal_all(&mut store, &config.sealer()).await;
    let sealed = sealed.map_err(StartError::Sealing)?;
    if sealed > 0 {
        tracing::info!(secrets.count = sealed, "Secrets in the database were sealed.");
    }
    Ok(store)
}

fn session_config(config: &PlatformConfig, public_url: &str, port: u16) -> SessionConfig {
    let is_secure = public_url.starts_with("https://");
    let (daemon, issuer) = ("verbund_platform", "Verbund platform");
    let mut sessions = SessionConfig::new(daemon, issuer, is_secure, port, public_url);
    sessions.shares = config.web.shares();
    sessions
}

/// Opens the recorder of accesses, with the key in the data directory.
fn open_accesses(
    config: &PlatformConfig,
    store: &Store,
    clock: &Clock,
) -> Result<AccessRecorder, AccessLogKeyError> {
    let key = access_log_key::open(&config.data_directory.join(ACCESS_LOG_KEY_FILE))?;
    Ok(AccessRecorder::new(Arc::new(store.clone()), key, clock.clone()))
}

/// Warns of what the configuration allows at one's own risk; returns the addresses without TLS.
fn warned(config: &PlatformConfig) -> Vec<plaintext::PlaintextWay> {
    for note in config.notes() {
        tracing::warn!("{note}");
    }
    config.sealer().warn_of_place();
    plaintext::warned(config.plaintext_ways())
}

fn ingest_config(config: &PlatformConfig, witness: Arc<WitnessKey>) -> IngestConfig {
    IngestConfig {
        resend_after: Duration::from_millis(config.parts.resend_after_ms),
        silence: config.lease_silence(),
        witness,
        room: RoomConfig::of(config),
    }
}

/// Runs the link until shutdown, and then what ends after it. Senders without room are waited for no longer.
async fn run_link(
    link: Link,
    shutdown: CancellationToken,
    after_link: CancellationToken,
    ending: CancellationToken,
) -> Result<(), Infallible> {
    let _ends_with_it = after_link.drop_guard();
    let end = async {
        shutdown.cancelled().await;
        ending.cancel();
    };
    tokio::join!(link.run(shutdown.clone()), end);
    Ok(())
}

/// Shows state and metrics of the broker's process beside those of this one.
fn start_watching(process: &BrokerProcessHandle, application: &Application, lifecycle: &Lifecycle) {
    application.metrics.include(process.metrics());
    let watching = watch_broker(process.is_up(), application.clone());
    let watching = lifecycle.shutdown().run_until_cancelled_owned(watching);
    lifecycle.spawn("broker watch", Importance::Optional, async move {
        watching.await;
        Ok::<(), Infallible>(())
    });
}

/// Keeps `/readyz` in line with the process of the broker.
async fn watch_broker(mut states: watch::Receiver<bool>, application: Application) {
    loop {
        if *states.borrow_and_update() {
            application.readiness.ready("broker");
        } else {
            application.readiness.waiting("broker", "the broker has died and is started again");
        }
        if states.changed().await.is_err() {
            return;
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cookie_is_for_tls_where_browsers_come_by_it() {
        let config = PlatformConfig::default();
        for (url, name) in [
            ("https://verbund.example", "__Host-verbund_platform_8080"),
            ("http://localhost:8080", "verbund_platform_8080"),
        ] {
            assert_eq!(session_config(&config, url, 8080).cookie_name(), name);
        }
    }
}
