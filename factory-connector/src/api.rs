//! Pages and API of the factory engineer.

mod account;
mod accounts;
mod alliances;
mod application_certificate;
pub mod bodies;
mod caps;
mod client_authorities;
mod client_certificates;
mod comments;
mod configuration;
mod context;
mod documents;
mod dry_runs;
mod events;
mod exchange;
mod fields;
mod inbox;
mod leaks;
mod ledger;
mod machine_turns;
mod mapping_import;
mod mapping_status;
mod networks;
mod operator;
mod passkeys;
mod past;
mod paths;
mod person_sessions;
mod policies;
mod preview;
mod previews;
mod problems;
mod revocations;
mod roles;
mod rules;
mod search;
mod session;
mod shadow;
mod source_client_certificates;
mod source_inquiry;
mod sources;
mod spool;
mod status;
mod store_writer;
mod suggestions;
mod templates;
mod users;
mod values;
mod versions;
mod view;

use axum::{Router, extract::DefaultBodyLimit};
use context::COOKIE;
use daemon::{
    guarded,
    web::{
        self,
        api::{Operations, Shell},
        problem::{Problem, ProblemFault},
        shares::{downloads, streams},
    },
};
use utoipa::OpenApi;
use utoipa_axum::{
    router::{OpenApiRouter, UtoipaMethodRouterExt as _},
    routes,
};

pub use self::{
    accounts::{Principal, StoredAccounts},
    context::{Api, ApiParts, RunningConnector, ServerParts},
    roles::{BeforeGate, Engineer, Operator, Viewer},
    values::ShownValue,
};

/// Largest body of any request, in bytes.
const BODY_BYTES_MAX: usize = 1024 * 1024;

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

/// Returns pages, API and health in one router.
pub fn router(api: Api, has_tls: bool) -> Router {
    let shell = Shell {
        sessions: api.sessions.clone(),
        readiness: api.server.readiness.clone(),
        metrics: api.server.metrics.clone(),
        trusted_proxies: api.server.trusted_proxies.clone(),
        state: api,
        body_bytes_max: BODY_BYTES_MAX,
        has_tls,
    };
    web::api::router::<EngineerPages, _, _>(operations(), openapi(), shell)
}

/// Returns the OpenAPI description of the whole API.
#[must_use]
pub fn openapi() -> utoipa::openapi::OpenApi {
    web::api::described(Description::openapi(), operations(), env!("CARGO_PKG_VERSION"), COOKIE)
}

fn operations() -> Operations<Api> {
    Operations { guarded: guarded(), open: open() }
}

/// Operations behind a session; the first argument of each handler is the role that it needs.
fn guarded() -> OpenApiRouter<Api> {
    let import = guarded!(exchange::import_mappings);
    OpenApiRouter::new()
        .routes(guarded!(session::show_session))
        .routes(guarded!(session::sign_out))
        .merge(account())
        .routes(guarded!(status::show_status))
        .routes(guarded!(configuration::show_configuration))
        .routes(guarded!(users::list_users))
        .routes(guarded!(users::put_user))
        .routes(guarded!(users::remove_user))
        .routes(guarded!(inbox::list_inbox))
        .routes(guarded!(inbox::show_request))
        .routes(guarded!(networks::list_operation_networks))
        .routes(guarded!(networks::show_operation_network))
        .routes(guarded!(networks::show_revision_difference))
        .routes(guarded!(operator::operations::list_operator_operations))
        .routes(guarded!(operator::entries::list_operator_entries))
        .routes(guarded!(operator::entries::deliver_operator_entries))
        .routes(guarded!(mapping_status::survey_mappings))
        .routes(downloads(guarded!(exchange::export_mappings)))
        .routes(guarded!(templates::list_mapping_templates))
        .routes(guarded!(templates::put_mapping_template))
        .routes(guarded!(templates::remove_mapping_template))
        .routes(guarded!(templates::fill_mapping_template))
        .merge(sources())
        .routes(guarded!(application_certificate::show_application_certificate))
        .routes(guarded!(application_certificate::request_application_certificate))
        .routes(guarded!(application_certificate::install_application_certificate))
        .routes(guarded!(client_certificates::list_client_certificates))
        .routes(guarded!(client_certificates::trust_client_certificate))
        .routes(guarded!(client_certificates::add_client_certificate))
        .routes(guarded!(client_authorities::list_client_authorities))
        .routes(guarded!(client_authorities::remove_client_authority))
        .routes(guarded!(client_authorities::list_client_revocation_lists))
        .routes(guarded!(client_authorities::remove_client_revocation_list))
        .routes(guarded!(comments::list_comments))
        .routes(guarded!(comments::add_comment))
        .routes(guarded!(ledger::list_ledger_entries))
        .routes(guarded!(ledger::fields::search_ledger_fields))
        .routes(guarded!(ledger::checkpoints::list_checkpoints))
        .routes(downloads(guarded!(ledger::verification::verify_ledger)))
        .routes(downloads(guarded!(ledger::export::export_ledger)))
        .routes(guarded!(ledger::logs::list_ledger_logs))
        .routes(guarded!(ledger::logs::begin_ledger_log))
        .routes(guarded!(revocations::list_revocations))
        .routes(guarded!(revocations::revoke_consents))
        .routes(guarded!(revocations::show_revocation))
        .routes(guarded!(revocations::print_revocation))
        .routes(guarded!(past::list_past_offers))
        .routes(guarded!(past::decide_past))
        .routes(guarded!(past::list_past_decisions))
        .routes(guarded!(spool::show_spool))
        .routes(guarded!(spool::list_dead_letters))
        .merge(disclosure())
        .routes(streams(guarded!(events::stream_events)))
        .routes(import.layer(DefaultBodyLimit::max(exchange::IMPORT_BYTES_MAX)))
        .nest(paths::FIELD, field())
}

/// Operations on one's own account, and on those of others.
fn account() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(guarded!(account::change_password))
        .routes(guarded!(account::list_sessions))
        .routes(guarded!(account::end_session))
        .routes(guarded!(account::show_second_factor))
        .routes(guarded!(account::begin_second_factor))
        .routes(guarded!(account::confirm_second_factor))
        .routes(guarded!(account::remove_second_factor))
        .routes(guarded!(passkeys::list_passkeys))
        .routes(guarded!(passkeys::begin_passkey))
        .routes(guarded!(passkeys::add_passkey))
        .routes(guarded!(passkeys::remove_passkey))
        .routes(guarded!(account::list_user_sessions))
        .routes(guarded!(account::end_user_session))
        .routes(guarded!(account::reset_second_factor))
}

/// Operations on the OPC UA servers of machines, and on those that may become sources.
fn sources() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(guarded!(sources::list_sources))
        .routes(guarded!(sources::add_source))
        .routes(guarded!(sources::change_source))
        .routes(guarded!(sources::remove_source))
        .routes(guarded!(sources::show_source_use))
        .routes(guarded!(sources::browse_source))
        .routes(guarded!(sources::read_source_values))
        .routes(guarded!(search::search_source))
        .routes(guarded!(source_inquiry::discover_source))
        .routes(guarded!(source_inquiry::test_source))
        .routes(guarded!(source_inquiry::list_server_profiles))
        .routes(guarded!(sources::list_source_certificates))
        .routes(guarded!(sources::trust_source_certificate))
        .routes(guarded!(source_client_certificates::show_source_client_certificate))
        .routes(guarded!(source_client_certificates::prepare_source_client_certificate))
        .routes(guarded!(source_client_certificates::discard_source_client_certificate))
        .routes(guarded!(source_client_certificates::use_source_client_certificate))
}

/// Operations on policies, standing rules, leak budgets and caps.
fn disclosure() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(guarded!(leaks::list_leak_budgets))
        .routes(guarded!(leaks::summarise_leak_budgets))
        .routes(guarded!(policies::list_policies))
        .routes(guarded!(policies::put_policy))
        .routes(guarded!(policies::list_policy_versions))
        .routes(guarded!(policies::preview_policy))
        .routes(guarded!(policies::list_recipients))
        .routes(guarded!(policies::put_recipient_policy))
        .routes(guarded!(alliances::list_alliances))
        .routes(guarded!(alliances::put_alliance))
        .routes(guarded!(alliances::list_alliance_versions))
        .routes(guarded!(alliances::list_alliance_budgets))
        .routes(guarded!(caps::list_caps))
        .routes(guarded!(caps::put_cap))
        .routes(guarded!(caps::list_cap_versions))
        .routes(guarded!(caps::preview_cap))
        .routes(guarded!(rules::list_rules))
        .routes(guarded!(rules::put_rule))
        .routes(guarded!(rules::list_rule_versions))
        .routes(guarded!(rules::preview_rule))
        .routes(guarded!(rules::apply_rules))
        .routes(guarded!(rules::list_rule_decisions))
        .routes(guarded!(rules::undo_rule_decision))
}

/// Operations on one field.
fn field() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(guarded!(fields::show_field))
        .routes(guarded!(fields::decide_field))
        .routes(guarded!(fields::enter_value))
        .routes(guarded!(preview::preview_decision))
        .routes(guarded!(suggestions::list_suggestions))
        .routes(guarded!(versions::list_mapping_versions))
        .routes(guarded!(versions::compare_mapping_versions))
        .routes(guarded!(versions::roll_mapping_back))
        .routes(guarded!(shadow::start_shadow_mapping))
        .routes(guarded!(shadow::show_shadow_mapping))
        .routes(guarded!(shadow::publish_shadow_mapping))
        .routes(guarded!(shadow::end_shadow_mapping))
        .routes(guarded!(dry_runs::dry_run_mapping))
        .routes(guarded!(mapping_status::show_mapping_status))
        .routes(guarded!(mapping_status::restart_mapping))
        .routes(guarded!(templates::make_mapping_template))
        .routes(guarded!(leaks::show_consent_offer))
}

/// Operations without a session.
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
