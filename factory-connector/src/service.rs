//! Composition of the connector: opens every part that can fail, then spawns the tasks.

mod broker_login;
mod link;
mod mappings;
mod recorded_values;
mod status_events;
mod tasks;

use std::{net::SocketAddr, path::Path, str::FromStr as _, sync::Arc};

use anyhow::Context as _;
use asi_model::{DateTime, FactoryId};
use broker_login::BrokerLogin;
use connector_state::StateConfig;
use daemon::{
    Confidential, data_directory,
    lifecycle::{Importance, Lifecycle},
    plaintext::{self, PlaintextWay},
    sealing::{self, Sealer},
    telemetry::Metrics,
    web::{
        health::Readiness,
        server::{listen, serve},
        session::{PasswordHashing, PasswordPolicy, random_token},
    },
};
use link::OpenedLink;
use mapping_engine::{MappingEngine, MappingEngineHandle};
use messaging::{BrokerUrl, LinkHandle};
use recorded_values::RecordedValues;
use shop_floor::{ShopFloor, ShopFloorHandle, SourceConfig};
use tasks::Tasks;
use tokio::sync::{Notify, mpsc, watch};
use twin::{Twin, TwinError, TwinHandle};

use crate::{
    api::{self, Api},
    catalog::{Catalog, CatalogHandle},
    clock::now,
    config::ConnectorConfig,
    coordinator::{self, Coordinator, CoordinatorConfig, CoordinatorHandle, Outputs},
    lease::LeaseStatus,
    ledger_key::{self, LEDGER_KEY_FILE},
    live_events::LiveEvents,
    passwords,
    store::{Enrolment, ReaderUse, Readers, Role, Store, StoreSession, User},
    twin_adapter::{CoordinatorWriter, StoredUsers, UserWatch},
};

/// Most events that are retained for pages that catch up. Pages that are further behind load
/// everything.
const EVENTS_MAX: usize = 4096;
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
    let enrolled = prepare(&config).await?;
    let factory_id = FactoryId::new(&enrolled.factory_id)?;
    let plaintext_ways = plaintext_ways(&config, &enrolled)?;
    let shutdown = lifecycle.shutdown();
    let (metrics, hashing) = (Metrics::install()?, PasswordHashing::default());
    let users = StoredUsers::default();
    let opened = open(&config, &enrolled, &factory_id, started_at, users.clone()).await?;

    let readiness = Readiness::new();
    readiness.waiting("twin", "the twin is starting");
    let web_listener = listen(config.web.listen).await?;
    let web_address = web_listener.local_addr()?;
    let tls = config.web.tls.as_ref().map(daemon::web::server::TlsFiles::load).transpose()?;
    let token = shutdown.clone();
    let (pages, link_state, source_states) =
        (opened.events.clone(), opened.link_handle.state(), opened.floor_handle.watch());
    lifecycle.spawn("status events", Importance::Essential, async move {
        status_events::publish(pages, link_state, source_states, token).await;
        anyhow::Ok(())
    });
    let api = Api::new(api::ApiParts {
        coordinator: opened.coordinator_handle,
        readers: opened.readers,
        shop_floor: opened.floor_handle,
        engine: opened.engine_handle,
        catalog: opened.catalog_handle,
        twin: opened.twin_handle.clone(),
        link: Some(opened.link_handle),
        lease: opened.lease_status,
        events: opened.events,
        users_changed: opened.users_changed,
        instance: api::RunningConnector {
            factory_id: factory_id.clone(),
            started_at,
            data_directory: directory,
            sealer: config.sealer(),
            encoding: config.reports.encoding,
            settings: config.settings.clone(),
            plaintext_ways,
        },
        server: api::ServerParts {
            readiness: readiness.clone(),
            metrics,
            shutdown: shutdown.clone(),
            is_secure: config.web.is_secure(),
            port: web_address.port(),
            public_url: config.web.public_url(web_address),
            trusted_proxies: config.web.proxies(),
            share_per_person: config.web.share_per_person.clone(),
            hashing,
        },
    });
    users.sign_in_as_on(api.sign_in());
    let router = api::router(api, tls.is_some());

    opened.tasks.spawn(lifecycle);
    let limits = config.web.limits();
    lifecycle.spawn("web", Importance::Essential, async move {
        serve(web_listener, tls, router, limits, shutdown).await;
        anyhow::Ok(())
    });
    let twin_url = opened.twin_handle.ready().await?;
    readiness.ready("twin");
    Ok(ConnectorHandle { factory_id, web_address, twin_url })
}

/// Makes the data directory and its first user where they are not there yet, and returns the
/// enrolment, without which a connector cannot start.
async fn prepare(config: &ConnectorConfig) -> anyhow::Result<Enrolment> {
    let directory = &config.data_directory;
    data_directory::create(directory, config.allow_shared_data_directory)?;
    let mut session = Store::connect(directory).await?;
    let sealer = config.sealer();
    sealer.warn_of_place();
    // Before anything reads them: a store of before has them in plain text.
    let sealed = sealing::seal_all(&mut session, &sealer).await?;
    if sealed > 0 {
        tracing::info!(secrets.count = sealed, "Secrets in the store were sealed.");
    }
    let enrolled = session.enrolments().current().await?.context(
        "this connector is not enrolled yet: ask an administrator of the platform for a token and run \
         `factory-connector enrol --token-file FILE` with the same --config",
    )?;
    ensure_first_user(&mut session, config).await?;
    Ok(enrolled)
}

/// Checks the broker's address of the enrolment like an own one, and warns of what is allowed without TLS.
fn plaintext_ways(
    config: &ConnectorConfig,
    enrolled: &Enrolment,
) -> anyhow::Result<Vec<PlaintextWay>> {
    let named = BrokerUrl::from_str(&enrolled.broker_url)
        .context("reading the broker's address of the enrolment")?;
    if config.broker.url.is_none() {
        config.check_named_broker(&named).map_err(anyhow::Error::msg)?;
    }
    Ok(plaintext::warned(config.plaintext_ways(&named)))
}

/// Parts of an opened connector: its tasks, and the handles that pages and API use.
struct Opened {
    tasks: Tasks,
    readers: Readers,
    events: LiveEvents,
    /// Notified after a user was changed through the API.
    users_changed: Arc<Notify>,
    coordinator_handle: CoordinatorHandle,
    twin_handle: TwinHandle,
    floor_handle: ShopFloorHandle,
    engine_handle: MappingEngineHandle,
    catalog_handle: CatalogHandle,
    link_handle: LinkHandle,
    lease_status: watch::Receiver<LeaseStatus>,
}

/// Opens store, twin, sources, mapping engine, link and coordinator.
async fn open(
    config: &ConnectorConfig,
    enrolled: &Enrolment,
    factory_id: &FactoryId,
    started_at: DateTime,
    users: StoredUsers,
) -> anyhow::Result<Opened> {
    let directory = &config.data_directory;
    let store = Store::open(directory, factory_id, started_at).await?;
    let key = ledger_key::open(&directory.join(LEDGER_KEY_FILE))?;
    let identity = store.identity().clone();
    let readers = store.readers();
    let sign_in = readers.reserved_for(ReaderUse::SignIn);

    let (coordinator_handle, commands) = coordinator::channel();
    let (twin, twin_handle) = open_twin(config, factory_id, &coordinator_handle, users)?;
    let users_changed = Arc::new(Notify::new());
    let user_watch =
        UserWatch::new(sign_in.clone(), twin_handle.clone(), Arc::clone(&users_changed)).await?;
    let (floor, floor_handle, changes) = ShopFloor::new(floor_config(directory, factory_id));
    let (mut engine, engine_handle, candidates) =
        MappingEngine::new(config.mapping.clone(), floor_handle.clone(), changes);
    let recorded_values = RecordedValues::resume(config, &mut engine).await;
    let (catalog, catalog_handle) = Catalog::new(floor_handle.clone());
    // The mark of this start: a page that comes with an id from before it loads everything.
    let events = LiveEvents::new(EVENTS_MAX, u64::try_from(started_at.ticks()).unwrap_or_default());
    let password = passwords::of_broker(&config.sealer(), enrolled)?;
    let broker = link::link_config(enrolled, &password, config, factory_id, started_at)?;
    let OpenedLink {
        link,
        handle: link_handle,
        lease_client,
        lease_status,
        keep_alives,
        in_flight,
    } = link::open(broker, identity, &key, started_at, &readers, &coordinator_handle, &events)?;

    let (mappings, mapping_work) = mpsc::channel(MAPPING_BATCHES_MAX);
    let outputs = Outputs {
        twin: twin_handle.clone(),
        mappings,
        link: Some(link_handle.clone()),
        keep_alives,
        in_flight,
        events: events.clone(),
    };
    let coordinator_config = coordinator_config(config, factory_id);
    let coordinator =
        Coordinator::new(coordinator_config, store, outputs, key, commands, candidates).await?;
    for source in stored_sources(&readers, &config.sealer()).await? {
        floor_handle.put_source(source)?;
    }
    let tasks = Tasks {
        coordinator,
        twin,
        user_watch,
        floor,
        catalog,
        engine,
        engine_handle: engine_handle.clone(),
        mapping_work,
        recorded_values,
        lease_client,
        broker_login: BrokerLogin::new(sign_in, config.sealer(), &link_handle, enrolled),
        link,
    };
    Ok(Opened {
        tasks,
        readers,
        events,
        users_changed,
        coordinator_handle,
        twin_handle,
        floor_handle,
        engine_handle,
        catalog_handle,
        link_handle,
        lease_status,
    })
}

fn open_twin(
    config: &ConnectorConfig,
    factory_id: &FactoryId,
    coordinator: &CoordinatorHandle,
    users: StoredUsers,
) -> Result<(Twin, TwinHandle), TwinError> {
    Twin::new(
        factory_id.clone(),
        config.twin_config(),
        Arc::new(CoordinatorWriter(coordinator.clone())),
        Arc::new(users),
    )
}

fn floor_config(directory: &Path, factory_id: &FactoryId) -> shop_floor::Config {
    shop_floor::Config::new(
        directory.join("source-pki"),
        "Verbund factory connector",
        &format!("urn:verbund:connector:{factory_id}"),
    )
}

fn coordinator_config(config: &ConnectorConfig, factory_id: &FactoryId) -> CoordinatorConfig {
    CoordinatorConfig {
        state: StateConfig { factory_id: factory_id.clone(), encoding: config.reports.encoding },
        publishing_interval: config.publishing_interval(),
        spool: config.spool,
        retention: config.ledger.retention(),
        witness_wait: config.ledger.witness_wait(),
    }
}

/// Returns the configured sources, passwords included.
async fn stored_sources(readers: &Readers, sealer: &Sealer) -> anyhow::Result<Vec<SourceConfig>> {
    let mut configs = Vec::new();
    for row in readers.session().await?.sources().all().await? {
        let mut json: serde_json::Value = serde_json::from_str(&row.config)
            .with_context(|| format!("reading the stored source {}", row.source_id))?;
        // A column of its own, so that the document can be shown without it.
        if let Some(password) = passwords::of_source(sealer, &row)? {
            json["identity"]["password"] = password.expose().as_str().into();
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
async fn ensure_first_user(
    session: &mut StoreSession,
    config: &ConnectorConfig,
) -> anyhow::Result<()> {
    if session.users().count().await? > 0 {
        return Ok(());
    }
    let (password, is_made_up) = match &config.admin.password {
        Some(password) => (password.clone(), false),
        None => (Confidential::from(random_token()), true),
    };
    let hash = PasswordHashing::default().hash(password.clone(), PasswordPolicy::default()).await;
    let hash = hash.context("admin.password is refused")?;
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
        // From its creation on: afterwards there would be a moment in which others can open it.
        .mode(0o600)
        .open(file)?;
    writeln!(file, "{secret}")
}
