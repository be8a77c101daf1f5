//! Pages and API of the factory engineer.

mod accounts;
mod client_certificates;
mod comments;
mod configuration;
mod events;
mod exchange;
mod fields;
mod inbox;
mod leaks;
mod ledger;
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
mod versions;
mod view;

use std::{path::PathBuf, sync::Arc};

use asi_model::{DateTime, FactoryId, pubsub::json::Encoding};
use axum::{Json, Router, extract::DefaultBodyLimit, middleware, routing::get};
use daemon::{
    configuration::Setting,
    telemetry::Metrics,
    web::{
        assets::with_app,
        events::EventLog,
        headers::secured,
        health::{self, Readiness},
        problem::{Problem, ProblemFault, unknown_method, unknown_route},
        session::{SessionConfig, Sessions, require_session},
    },
};
use mapping_engine::MappingEngineHandle;
use messaging::LinkHandle;
use shop_floor::ShopFloorHandle;
use sqlx::{Sqlite, SqlitePool, pool::PoolConnection};
use tokio_util::sync::CancellationToken;
use tower_http::{catch_panic::CatchPanicLayer, compression::CompressionLayer, trace::TraceLayer};
use twin::TwinHandle;
use utoipa::{
    Modify, OpenApi,
    openapi::security::{ApiKey, ApiKeyValue, SecurityScheme},
};
use utoipa_axum::{
    router::{OpenApiRouter, UtoipaMethodRouterExt as _},
    routes,
};

pub use accounts::{Principal, StoredAccounts};

use crate::{books::ConnectorEvent, catalog::CatalogHandle, desk::DeskHandle};

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
}

/// The API's state; clones share it.
#[derive(Clone)]
pub struct Api {
    parts: Arc<Parts>,
    sessions: Sessions<StoredAccounts>,
}

impl Api {
    /// Over these parts.
    #[must_use]
    pub fn new(parts: Parts) -> Self {
        let accounts = StoredAccounts::new(parts.readers.clone());
        let sessions = Sessions::new(SessionConfig::new(COOKIE, parts.has_tls), accounts);
        Self { parts: Arc::new(parts), sessions }
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
    info(title = "Verbund factory connector", description = "Inbox, decisions, sources, ledger and state of a factory's \
        connector. Errors are problem documents (RFC 9457). Changes need the session's token in `x-csrf-token`."),
    components(schemas(Problem, ProblemFault)),
    modifiers(&Security),
)]
struct Description;

struct Security;

impl Modify for Security {
    fn modify(&self, openapi: &mut utoipa::openapi::OpenApi) {
        let scheme = SecurityScheme::ApiKey(ApiKey::Cookie(ApiKeyValue::new(COOKIE)));
        openapi.components.get_or_insert_default().add_security_scheme("session", scheme);
    }
}

/// Pages, API and health in one router.
pub fn router(api: Api, has_tls: bool) -> Router {
    let (guarded, _) = guarded().split_for_parts();
    let (open, _) = open().split_for_parts();
    let guarded =
        guarded.layer(middleware::from_fn_with_state(api.sessions.clone(), require_session::<StoredAccounts>));
    let description = openapi();
    let routes = guarded
        .merge(open)
        .route("/openapi.json", get(move || async move { Json(description) }))
        .fallback(unknown_route)
        .method_not_allowed_fallback(unknown_method)
        .layer(DefaultBodyLimit::max(BODY_BYTES_MAX));
    let router = Router::new()
        .nest("/api/v1", routes)
        .with_state(api.clone())
        .merge(health::routes(api.readiness.clone(), api.metrics.clone()));
    secured(with_app::<EngineerPages, ()>(router), has_tls)
        .layer(CompressionLayer::new())
        .layer(CatchPanicLayer::custom(|_: Box<dyn std::any::Any + Send>| {
            metrics::counter!("verbund_handler_panics_total").increment(1);
            axum::response::IntoResponse::into_response(Problem::new(
                axum::http::StatusCode::INTERNAL_SERVER_ERROR,
                "INTERNAL",
                "Something went wrong here; the log of the connector says what.",
            ))
        }))
        .layer(TraceLayer::new_for_http())
}

/// The description of the whole API.
#[must_use]
pub fn openapi() -> utoipa::openapi::OpenApi {
    let mut description = Description::openapi();
    for router in [guarded(), open()] {
        let (_, part) = router.split_for_parts();
        let part: utoipa::openapi::OpenApi = part;
        description = description.nest("/api/v1", part);
    }
    description.info.version = env!("CARGO_PKG_VERSION").to_owned();
    description
}

fn guarded() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(routes!(session::show, session::sign_out))
        .routes(routes!(status::show))
        .routes(routes!(configuration::show))
        .routes(routes!(inbox::list))
        .routes(routes!(inbox::networks))
        .routes(routes!(inbox::network))
        .routes(routes!(inbox::news))
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
        .routes(routes!(trials::status))
        .routes(routes!(trials::restart))
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
        .routes(routes!(client_certificates::list, client_certificates::add))
        .routes(routes!(client_certificates::trust))
        .routes(routes!(comments::list, comments::add))
        .routes(routes!(ledger::list))
        .routes(routes!(ledger::verify))
        .routes(routes!(ledger::export))
        .routes(routes!(revocations::list, revocations::revoke))
        .routes(routes!(revocations::show))
        .routes(routes!(revocations::print))
        .routes(routes!(spool::show))
        .routes(routes!(spool::dead_letters))
        .routes(routes!(leaks::list))
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
        assert!(committed == current, "factory-connector/openapi.json is stale; run this test with UPDATE_OPENAPI=1");
    }
}
