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
        .routes(routes!(session::show_session, session::sign_out))
        .routes(routes!(status::show_status))
        .routes(routes!(configuration::show_configuration))
        .routes(routes!(users::list_users))
        .routes(routes!(users::put_user, users::remove_user))
        .routes(routes!(inbox::list_inbox))
        .routes(routes!(inbox::show_request))
        .routes(routes!(networks::list_operation_networks))
        .routes(routes!(networks::show_operation_network))
        .routes(routes!(networks::show_revision_difference))
        .routes(routes!(fields::show_field))
        .routes(routes!(fields::decide_field))
        .routes(routes!(fields::enter_value))
        .routes(routes!(operator::list_operator_operations))
        .routes(routes!(operator::list_operator_entries, operator::deliver_operator_entries))
        .routes(routes!(preview::preview_decision))
        .routes(routes!(suggestions::list_suggestions))
        .routes(routes!(versions::list_mapping_versions))
        .routes(routes!(versions::compare_mapping_versions))
        .routes(routes!(versions::roll_mapping_back))
        .routes(routes!(
            shadow::start_shadow_mapping,
            shadow::show_shadow_mapping,
            shadow::end_shadow_mapping
        ))
        .routes(routes!(shadow::publish_shadow_mapping))
        .routes(routes!(trials::dry_run_mapping))
        .routes(routes!(mapping_status::show_mapping_status))
        .routes(routes!(mapping_status::restart_mapping))
        .routes(routes!(mapping_status::survey_mappings))
        .routes(routes!(exchange::export_mappings))
        .routes(
            routes!(exchange::import_mappings)
                .layer(DefaultBodyLimit::max(exchange::IMPORT_BYTES_MAX)),
        )
        .routes(routes!(templates::list_mapping_templates))
        .routes(routes!(templates::put_mapping_template, templates::remove_mapping_template))
        .routes(routes!(templates::make_mapping_template))
        .routes(routes!(templates::fill_mapping_template))
        .routes(routes!(sources::list_sources, sources::add_source))
        .routes(routes!(sources::change_source, sources::remove_source))
        .routes(routes!(sources::browse_source))
        .routes(routes!(sources::read_source_value))
        .routes(routes!(search::search_source))
        .routes(routes!(sources::list_source_certificates))
        .routes(routes!(sources::trust_source_certificate))
        .routes(routes!(
            application_certificate::show_application_certificate,
            application_certificate::install_application_certificate
        ))
        .routes(routes!(application_certificate::request_application_certificate))
        .routes(routes!(
            client_certificates::list_client_certificates,
            client_certificates::add_client_certificate
        ))
        .routes(routes!(client_certificates::trust_client_certificate))
        .routes(routes!(client_authorities::list_client_authorities))
        .routes(routes!(client_authorities::remove_client_authority))
        .routes(routes!(client_authorities::list_client_revocation_lists))
        .routes(routes!(client_authorities::remove_client_revocation_list))
        .routes(routes!(comments::list_comments, comments::add_comment))
        .routes(routes!(ledger::list_ledger_entries))
        .routes(routes!(ledger::fields::search_ledger_fields))
        .routes(routes!(ledger::checkpoints::list_checkpoints))
        .routes(routes!(ledger::verification::verify_ledger))
        .routes(routes!(ledger::export::export_ledger))
        .routes(routes!(revocations::list_revocations, revocations::revoke_consents))
        .routes(routes!(revocations::show_revocation))
        .routes(routes!(revocations::print_revocation))
        .routes(routes!(spool::show_spool))
        .routes(routes!(spool::list_dead_letters))
        .routes(routes!(leaks::list_leak_budgets))
        .routes(routes!(leaks::summarise_leak_budgets))
        .routes(routes!(leaks::show_consent_offer))
        .routes(routes!(policies::list_policies))
        .routes(routes!(policies::put_policy))
        .routes(routes!(policies::list_policy_versions))
        .routes(routes!(policies::preview_policy))
        .routes(routes!(policies::list_recipients))
        .routes(routes!(policies::put_recipient_policy))
        .routes(routes!(rules::list_rules))
        .routes(routes!(rules::put_rule))
        .routes(routes!(rules::list_rule_versions))
        .routes(routes!(rules::preview_rule))
        .routes(routes!(rules::apply_rules))
        .routes(routes!(rules::list_rule_decisions))
        .routes(routes!(rules::undo_rule_decision))
        .routes(routes!(events::stream_events))
}

fn open() -> OpenApiRouter<Api> {
    OpenApiRouter::new().routes(routes!(session::sign_in))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    #[test]
    fn operation_ids_are_unique() {
        let mut ids = BTreeSet::new();
        for (path, item) in super::openapi().paths.paths {
            let operations = [item.get, item.put, item.post, item.delete, item.patch];
            for operation in operations.into_iter().flatten() {
                let id = operation.operation_id.expect("an operation has an id");
                assert!(ids.insert(id.clone()), "{path}: another operation is also named {id}");
            }
        }
    }

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
