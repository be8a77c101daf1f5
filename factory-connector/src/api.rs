//! Pages and API of the factory engineer.

mod accounts;
mod application_certificate;
mod client_authorities;
mod client_certificates;
mod comments;
mod configuration;
mod documents;
mod events;
mod exchange;
mod fields;
mod inbox;
mod leaks;
mod ledger;
mod mapping_status;
mod networks;
mod operator;
mod policies;
mod preview;
mod problems;
mod revocations;
mod rules;
mod search;
mod session;
mod shadow;
mod sources;
mod spool;
mod status;
mod suggestions;
mod templates;
mod trials;
mod users;
mod versions;
mod view;

use std::{path::PathBuf, sync::Arc};

use asi_model::{DateTime, FactoryId, pubsub::json::Encoding};
use axum::{Router, extract::DefaultBodyLimit};
use daemon::{
    configuration::Setting,
    telemetry::Metrics,
    web::{
        self,
        api::{Operations, Shell},
        events::EventLog,
        health::Readiness,
        problem::{Problem, ProblemFault},
        session::{SessionConfig, Sessions},
    },
};
use mapping_engine::MappingEngineHandle;
use messaging::LinkHandle;
use shop_floor::ShopFloorHandle;
use sqlx::{Sqlite, SqlitePool, pool::PoolConnection};
use tokio::sync::{Notify, watch};
use tokio_util::sync::CancellationToken;
use twin::TwinHandle;
use utoipa::OpenApi;
use utoipa_axum::{
    router::{OpenApiRouter, UtoipaMethodRouterExt as _},
    routes,
};

pub use accounts::{Principal, StoredAccounts};

use crate::{books::ConnectorEvent, catalog::CatalogHandle, desk::DeskHandle, lease::LeaseStatus};

const COOKIE: &str = "verbund_connector";
/// Largest body of any request, in bytes.
const BODY_BYTES_MAX: usize = 1024 * 1024;

/// What the API speaks to.
pub struct Parts {
    /// Changes anything.
    pub desk: DeskHandle,
    /// Reads the store.
    pub readers: SqlitePool,
    /// Local OPC UA servers.
    pub shop_floor: ShopFloorHandle,
    /// Checks and tries mappings.
    pub engine: MappingEngineHandle,
    /// Which variables local servers have.
    pub catalog: CatalogHandle,
    /// The OPC UA server.
    pub twin: TwinHandle,
    /// The link to the platform.
    pub link: Option<LinkHandle>,
    /// Whether this connector may speak for its factory.
    pub lease: watch::Receiver<LeaseStatus>,
    /// What pages are told.
    pub events: EventLog<ConnectorEvent>,
    /// What the connector waits for.
    pub readiness: Readiness,
    /// Metrics.
    pub metrics: Metrics,
    /// When it started.
    pub started_at: DateTime,
    /// Whose it is.
    pub factory_id: FactoryId,
    /// Where the store lies.
    pub data_directory: PathBuf,
    /// How reports are written.
    pub encoding: Encoding,
    /// Ends live streams.
    pub shutdown: CancellationToken,
    /// What it runs with, to read.
    pub settings: Vec<Setting>,
    /// Cookies are for TLS only.
    pub has_tls: bool,
    /// Tells the twin that people were changed.
    pub users_changed: Arc<Notify>,
}

/// The API's state; clones share it.
#[derive(Clone)]
pub struct Api {
    parts: Arc<Parts>,
    sessions: Sessions<StoredAccounts>,
    accounts: StoredAccounts,
}

impl Api {
    /// Over these parts.
    #[must_use]
    pub fn new(parts: Parts) -> Self {
        let accounts = StoredAccounts::new(parts.readers.clone());
        let sessions = Sessions::new(SessionConfig::new(COOKIE, parts.has_tls), accounts.clone());
        Self { parts: Arc::new(parts), sessions, accounts }
    }
}

impl Api {
    /// A connection for reading.
    async fn reader(&self) -> Result<PoolConnection<Sqlite>, Problem> {
        self.parts.readers.acquire().await.map_err(|error| Problem::internal(&error))
    }
}

impl std::ops::Deref for Api {
    type Target = Parts;
    fn deref(&self) -> &Parts {
        &self.parts
    }
}

#[derive(rust_embed::RustEmbed)]
#[folder = "../web/dist/engineer"]
struct EngineerPages;

#[derive(OpenApi)]
#[openapi(
    info(
        title = "Verbund factory connector",
        description = "Inbox, decisions, sources, ledger and state of a factory's \
        connector. Errors are problem documents (RFC 9457). Changes need the session's token in `x-csrf-token`."
    ),
    components(schemas(Problem, ProblemFault))
)]
struct Description;

/// Pages, API and health in one router.
pub fn router(api: Api, has_tls: bool) -> Router {
    let shell = Shell {
        sessions: api.sessions.clone(),
        readiness: api.readiness.clone(),
        metrics: api.metrics.clone(),
        state: api,
        body_bytes_max: BODY_BYTES_MAX,
        has_tls,
    };
    web::api::router::<EngineerPages, _, _>(operations(), openapi(), shell)
}

/// The description of the whole API.
#[must_use]
pub fn openapi() -> utoipa::openapi::OpenApi {
    web::api::described(Description::openapi(), operations(), env!("CARGO_PKG_VERSION"), COOKIE)
}

fn operations() -> Operations<Api> {
    Operations { guarded: guarded(), open: open() }
}

fn guarded() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(routes!(session::show, session::sign_out))
        .routes(routes!(status::show))
        .routes(routes!(configuration::show))
        .routes(routes!(users::list))
        .routes(routes!(users::put, users::remove))
        .routes(routes!(inbox::list))
        .routes(routes!(inbox::request))
        .routes(routes!(networks::list))
        .routes(routes!(networks::show))
        .routes(routes!(networks::news))
        .routes(routes!(fields::read))
        .routes(routes!(fields::decide))
        .routes(routes!(fields::enter))
        .routes(routes!(operator::operations))
        .routes(routes!(operator::entries, operator::deliver))
        .routes(routes!(preview::preview))
        .routes(routes!(suggestions::list))
        .routes(routes!(versions::list))
        .routes(routes!(versions::difference))
        .routes(routes!(versions::rollback))
        .routes(routes!(shadow::start, shadow::status, shadow::end))
        .routes(routes!(shadow::publish))
        .routes(routes!(trials::run))
        .routes(routes!(mapping_status::status))
        .routes(routes!(mapping_status::restart))
        .routes(routes!(mapping_status::survey))
        .routes(routes!(exchange::export))
        .routes(routes!(exchange::import).layer(DefaultBodyLimit::max(exchange::IMPORT_BYTES_MAX)))
        .routes(routes!(templates::list))
        .routes(routes!(templates::put, templates::remove))
        .routes(routes!(templates::from_field))
        .routes(routes!(templates::fill))
        .routes(routes!(sources::list, sources::add))
        .routes(routes!(sources::change, sources::remove))
        .routes(routes!(sources::nodes))
        .routes(routes!(sources::value))
        .routes(routes!(search::search))
        .routes(routes!(sources::certificates))
        .routes(routes!(sources::trust))
        .routes(routes!(application_certificate::show, application_certificate::install))
        .routes(routes!(application_certificate::request))
        .routes(routes!(client_certificates::list, client_certificates::add))
        .routes(routes!(client_certificates::trust))
        .routes(routes!(client_authorities::list))
        .routes(routes!(client_authorities::remove))
        .routes(routes!(client_authorities::revocation_lists))
        .routes(routes!(client_authorities::remove_revocation_list))
        .routes(routes!(comments::list, comments::add))
        .routes(routes!(ledger::list))
        .routes(routes!(ledger::fields::search))
        .routes(routes!(ledger::checkpoints::list))
        .routes(routes!(ledger::verification::verify))
        .routes(routes!(ledger::export::export))
        .routes(routes!(revocations::list, revocations::revoke))
        .routes(routes!(revocations::show))
        .routes(routes!(revocations::print))
        .routes(routes!(spool::show))
        .routes(routes!(spool::dead_letters))
        .routes(routes!(leaks::list))
        .routes(routes!(leaks::summary))
        .routes(routes!(leaks::offer))
        .routes(routes!(policies::list))
        .routes(routes!(policies::put))
        .routes(routes!(policies::versions))
        .routes(routes!(policies::preview))
        .routes(routes!(policies::recipients))
        .routes(routes!(policies::set_recipient))
        .routes(routes!(rules::list))
        .routes(routes!(rules::put))
        .routes(routes!(rules::versions))
        .routes(routes!(rules::preview))
        .routes(routes!(rules::apply))
        .routes(routes!(rules::decisions))
        .routes(routes!(rules::undo))
        .routes(routes!(events::stream))
}

fn open() -> OpenApiRouter<Api> {
    OpenApiRouter::new().routes(routes!(session::sign_in))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_committed_description_is_fresh() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.json");
        let current = super::openapi().to_pretty_json().expect("it serialises") + "\n";
        if std::env::var_os("UPDATE_OPENAPI").is_some() {
            std::fs::write(path, &current).expect("written");
        }
        let committed = std::fs::read_to_string(path).unwrap_or_default();
        assert!(
            committed == current,
            "factory-connector/openapi.json is stale; run this test with UPDATE_OPENAPI=1"
        );
    }
}
