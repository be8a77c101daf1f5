//! Composition of the connector: opens every part that can fail, then spawns the tasks.

mod link;
mod mappings;
mod status_events;

use std::{net::SocketAddr, sync::Arc};

use anyhow::Context as _;
use asi_model::FactoryId;
use connector_state::StateConfig;
use daemon::{
    Confidential,
    lifecycle::{Importance, Lifecycle},
    telemetry::Metrics,
    web::{
        events::EventLog,
        health::Readiness,
        server::{listen, serve},
        session::{PasswordHash, PasswordPolicy, random_token},
    },
};
use mapping_engine::MappingEngine;
use messaging::Link;
use shop_floor::{ShopFloor, SourceConfig};
use tokio::sync::mpsc;
use twin::Twin;

use crate::ledger_key::{self, LEDGER_KEY_FILE};
use crate::{
    api::{self, Api},
    catalog::Catalog,
    config::ConnectorConfig,
    coordinator::{self, Coordinator, CoordinatorConfig, Outputs, now},
    in_flight::InFlight,
    keep_alive_queue::KeepAliveQueue,
    lease::{self, Instance, LeaseClient, LeaseGate},
    link_adapter::{ConnectorSpool, PlatformInbox},
    store::{Readers, Role, Session, Store, User},
    twin_adapter::{CoordinatorWriter, StoredUsers, UserWatch},
};

/// Most events that are retained for pages that catch up.
const EVENTS_KEPT_MAX: usize = 4096;
/// Most batches of mappings that wait for the engine.
const MAPPING_BATCHES_MAX: usize = 1024;

/// Addresses of a started connector.
#[derive(Debug, Clone)]
pub struct ConnectorHandle {
    pub factory_id: FactoryId,
    /// Bound address of pages and API.
    pub web_address: SocketAddr,
    /// URL of the twin's endpoint (`opc.tcp`).
    pub twin_url: Arc<str>,
}

/// Opens and starts a connector; it runs until the lifecycle ends.
///
/// # Errors
/// Sentences with the remedy, about the part that cannot be opened.
pub async fn start(
    config: ConnectorConfig,
    lifecycle: &Lifecycle,
) -> anyhow::Result<ConnectorHandle> {
    let started_at = now();
    let directory = config.data_directory.clone();
    std::fs::create_dir_all(&directory)
        .with_context(|| format!("making the data directory {}", directory.display()))?;
    let mut session = Store::connect(&directory).await?;
    let enrolled = session.enrolments().current().await?.context(
        "this connector is not enrolled yet: ask an administrator of the platform for a token and run \
         `factory-connector enrol <token>` with the same --config",
    )?;
    ensure_first_user(&mut session, &config).await?;
    drop(session);
    let factory_id = FactoryId::new(&enrolled.factory_id)?;
    let store = Store::open(&directory, &factory_id, started_at).await?;
    let key = ledger_key::open(&directory.join(LEDGER_KEY_FILE))?;
    let metrics = Metrics::install()?;
    let identity = store.identity().clone();
    let instance = Instance {
        factory_id: factory_id.clone(),
        instance_id: identity.instance_id,
        place: identity.place,
        host: identity.host,
        started_at,
    };
    let readers = store.readers();
    let shutdown = lifecycle.shutdown();

    let (coordinator_handle, commands) = coordinator::channel();
    let (twin, twin_handle) = Twin::new(
        factory_id.clone(),
        config.twin_config(),
        Arc::new(CoordinatorWriter(coordinator_handle.clone())),
        Arc::new(StoredUsers(readers.clone())),
    )?;
    let users_changed = Arc::new(tokio::sync::Notify::new());
    let user_watch =
        UserWatch::new(readers.clone(), twin_handle.clone(), Arc::clone(&users_changed)).await?;
    let floor_config = shop_floor::Config::new(
        directory.join("source-pki"),
        "Verbund factory connector",
        &format!("urn:verbund:connector:{factory_id}"),
    );
    let (floor, floor_handle, changes) = ShopFloor::new(floor_config);
    let (engine, engine_handle, candidates) =
        MappingEngine::new(config.mapping.clone(), floor_handle.clone(), changes);
    let keep_alives = Arc::new(KeepAliveQueue::default());
    let in_flight = Arc::new(InFlight::default());
    let gate = Arc::new(LeaseGate::default());
    let (catalog, catalog_handle) = Catalog::new(floor_handle.clone());
    let spool = ConnectorSpool::new(
        factory_id.clone(),
        readers.clone(),
        coordinator_handle.clone(),
        Arc::clone(&keep_alives),
        Arc::clone(&in_flight),
        Arc::clone(&gate),
    );
    let (lease_answers, answers) = lease::channel(factory_id.clone());
    let mut link_config = link::link_config(&enrolled, &config.broker, &factory_id)?;
    link_config.consumed = LeaseClient::received_at_start(&factory_id, identity.was_lease_held);
    let (link, link_handle) = Link::new(
        link_config,
        Arc::new(spool),
        Arc::new(PlatformInbox { coordinator: coordinator_handle.clone(), lease: lease_answers }),
    )?;
    let events =
        EventLog::new(EVENTS_KEPT_MAX, u64::try_from(started_at.ticks()).unwrap_or_default());
    let (lease_client, lease_status) = LeaseClient::new(
        instance,
        identity.was_lease_held,
        gate,
        link_handle.clone(),
        coordinator_handle.clone(),
        answers,
        events.clone(),
    );
    let (mappings, mapping_work) = mpsc::channel(MAPPING_BATCHES_MAX);
    let sources = stored_sources(&readers).await?;
    let coordinator = Coordinator::new(
        CoordinatorConfig {
            state: StateConfig {
                factory_id: factory_id.clone(),
                encoding: config.reports.encoding,
            },
            publishing_interval: config.publishing_interval(),
            spool: config.spool,
            retention: config.ledger,
        },
        store,
        Outputs {
            twin: twin_handle.clone(),
            mappings,
            link: Some(link_handle.clone()),
            keep_alives,
            in_flight,
            events: events.clone(),
        },
        key,
        commands,
        candidates,
    )
    .await?;
    for source in sources {
        floor_handle.put_source(source)?;
    }

    let readiness = Readiness::new();
    readiness.waiting("twin", "the twin is starting");
    let web_listener = listen(config.web.listen).await?;
    let web_address = web_listener.local_addr()?;
    let tls = config.web.tls.as_ref().map(daemon::web::server::TlsFiles::load).transpose()?;
    let token = shutdown.clone();
    let (pages, link_state, source_states) =
        (events.clone(), link_handle.state(), floor_handle.watch());
    lifecycle.spawn("status events", Importance::Essential, async move {
        status_events::publish(pages, link_state, source_states, token).await;
        anyhow::Ok(())
    });
    let router = api::router(
        Api::new(api::Parts {
            coordinator: coordinator_handle,
            readers,
            shop_floor: floor_handle,
            engine: engine_handle.clone(),
            catalog: catalog_handle,
            twin: twin_handle.clone(),
            link: Some(link_handle),
            lease: lease_status,
            events,
            users_changed,
            instance: api::Instance {
                factory_id: factory_id.clone(),
                started_at,
                data_directory: directory,
                encoding: config.reports.encoding,
                settings: config.settings.clone(),
            },
            server: api::ServerParts {
                readiness: readiness.clone(),
                metrics,
                shutdown: shutdown.clone(),
                has_tls: tls.is_some(),
            },
        }),
        tls.is_some(),
    );

    let token = shutdown.clone();
    lifecycle.spawn("coordinator", Importance::Essential, async move {
        coordinator.run(token).await.map_err(anyhow::Error::from)
    });
    let token = shutdown.clone();
    lifecycle.spawn("twin", Importance::Essential, async move {
        twin.run(token).await.map_err(anyhow::Error::from)
    });
    let token = shutdown.clone();
    lifecycle.spawn("user watch", Importance::Essential, async move {
        user_watch.run(token).await;
        anyhow::Ok(())
    });
    let token = shutdown.clone();
    lifecycle.spawn("shop floor", Importance::Essential, async move {
        floor.run(token).await;
        anyhow::Ok(())
    });
    let token = shutdown.clone();
    lifecycle.spawn("catalog", Importance::Essential, async move {
        catalog.run(token).await;
        anyhow::Ok(())
    });
    let token = shutdown.clone();
    lifecycle.spawn("mapping engine", Importance::Essential, async move {
        engine.run(token).await;
        anyhow::Ok(())
    });
    let token = shutdown.clone();
    lifecycle.spawn("mappings", Importance::Essential, async move {
        mappings::publish(mapping_work, engine_handle, token).await;
        anyhow::Ok(())
    });
    let token = shutdown.clone();
    lifecycle.spawn("lease", Importance::Essential, async move {
        lease_client.run(token).await;
        anyhow::Ok(())
    });
    let token = shutdown.clone();
    lifecycle.spawn("link", Importance::Essential, async move {
        link.run(token).await;
        anyhow::Ok(())
    });
    lifecycle.spawn("web", Importance::Essential, async move {
        serve(web_listener, tls, router, shutdown).await.map_err(anyhow::Error::from)
    });
    let twin_url = twin_handle.ready().await?;
    readiness.ready("twin");
    Ok(ConnectorHandle { factory_id, web_address, twin_url })
}

/// Returns the configured sources, passwords included.
async fn stored_sources(readers: &Readers) -> anyhow::Result<Vec<SourceConfig>> {
    let mut configs = Vec::new();
    for row in readers.session().await?.sources().all().await? {
        let mut json: serde_json::Value = serde_json::from_str(&row.config)
            .with_context(|| format!("reading the stored source {}", row.source_id))?;
        if let Some(password) = row.password {
            json["identity"]["password"] = password.into();
        }
        configs.push(
            serde_json::from_value(json)
                .with_context(|| format!("reading the stored source {}", row.source_id))?,
        );
    }
    Ok(configs)
}

/// Stores a first user, an engineer, where there is none. A made-up password goes into a file that
/// only its owner can read.
async fn ensure_first_user(session: &mut Session, config: &ConnectorConfig) -> anyhow::Result<()> {
    if session.users().count().await? > 0 {
        return Ok(());
    }
    let (password, is_made_up) = match &config.admin.password {
        Some(password) => (password.clone(), false),
        None => (Confidential::from(random_token()), true),
    };
    let hash = PasswordHash::of(&password, PasswordPolicy::default())
        .context("admin.password is refused")?;
    let user = User {
        user_name: config.admin.user_name.clone(),
        role: Role::Engineer,
        password_hash: hash.as_str().to_owned(),
    };
    session.users().put(&user, now()).await?;
    if is_made_up {
        let file = config.data_directory.join("engineer-password.txt");
        write_secret(&file, password.expose())
            .with_context(|| format!("writing {}", file.display()))?;
        tracing::warn!(user.name = %user.user_name, file = %file.display(), "The first user was made; its password is in the file. Sign in, then delete the file.");
    }
    Ok(())
}

fn write_secret(file: &std::path::Path, secret: &str) -> std::io::Result<()> {
    use std::{io::Write as _, os::unix::fs::OpenOptionsExt as _};
    let mut file = std::fs::OpenOptions::new()
        .create(true)
        .truncate(true)
        .write(true)
        .mode(0o600)
        .open(file)?;
    writeln!(file, "{secret}")
}
