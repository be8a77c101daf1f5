//! HTTP API `/api/v1` described by OpenAPI, with the partners' pages and health checks.
//!
//! Handlers extract, authorise, call and map; they contain no SQL and no business decisions. Data
//! outside the viewer's scope is "not found".

mod accesses;
mod account;
mod administrator_only;
mod audit;
pub mod bodies;
mod collaborations;
mod comments;
mod dead_letters;
mod enrolments;
mod factories;
mod leases;
mod ledger_logs;
mod live;
mod networks;
mod organisations;
mod own_factory;
mod page;
mod passkeys;
mod problems;
mod removals;
mod reports;
mod requests;
mod revocations;
mod session;
mod status;
mod tools;
mod users;
mod writers;

use axum::{Router, middleware};
use daemon::web::{
    self, Problem,
    api::{Operations, Shell},
    problem::ProblemFault,
    shares::{downloads, in_turn, streams},
};
use utoipa::OpenApi;
use utoipa_axum::{router::OpenApiRouter, routes};

use crate::application::Application;

/// Largest body of any request: a network may be as large as its parts together.
const BODY_BYTES_MAX: usize = 4 * 1024 * 1024;

/// Partners' pages, built by Vite.
#[derive(rust_embed::RustEmbed)]
#[folder = "../web/dist/partner"]
struct PartnerPages;

#[derive(OpenApi)]
#[openapi(
    info(
        title = "Verbund platform",
        description = "Operation networks, requests, reports and progress of collaborating \
        factories. Errors are problem documents (RFC 9457). Changes need the session's token in `x-csrf-token`."
    ),
    components(schemas(Problem, ProblemFault))
)]
struct Description;

/// Returns pages, API and health checks as one router.
pub fn router(application: &Application, has_tls: bool) -> Router {
    let shell = Shell {
        state: application.clone(),
        sessions: application.sessions.clone(),
        readiness: application.readiness.clone(),
        metrics: application.metrics.clone(),
        body_bytes_max: BODY_BYTES_MAX,
        has_tls,
        trusted_proxies: application.config.web.proxies(),
    };
    web::api::router::<PartnerPages, _, _>(operations(), openapi(), shell)
}

/// Returns the OpenAPI description of the whole API.
#[must_use]
pub fn openapi() -> utoipa::openapi::OpenApi {
    let version = env!("CARGO_PKG_VERSION");
    web::api::described(Description::openapi(), operations(), version, "verbund_platform")
}

fn operations() -> Operations<Application> {
    Operations { guarded: guarded(), open: open() }
}

/// Operations that need a session. What lasts has shares of its own, and exports read in turns a portion at a time; all
/// else comes in turns, to read or to change.
fn guarded() -> OpenApiRouter<Application> {
    in_turns()
        .route_layer(middleware::from_fn(in_turn))
        .routes(downloads(routes!(accesses::export)))
        .routes(downloads(routes!(audit::export)))
        .routes(streams(routes!(live::stream)))
}

/// Operations that need a session and end soon.
fn in_turns() -> OpenApiRouter<Application> {
    OpenApiRouter::new()
        .routes(routes!(session::show, session::sign_out))
        .routes(routes!(account::change_password))
        .routes(routes!(account::list_sessions))
        .routes(routes!(account::end_session))
        .routes(routes!(
            account::show_second_factor,
            account::begin_second_factor,
            account::confirm_second_factor
        ))
        .routes(routes!(account::remove_second_factor))
        .routes(routes!(passkeys::list, passkeys::begin, passkeys::add))
        .routes(routes!(passkeys::remove))
        .routes(routes!(account::list_user_sessions))
        .routes(routes!(account::end_user_session))
        .routes(routes!(account::reset_second_factor))
        .routes(routes!(status::show))
        .routes(routes!(organisations::list, organisations::add))
        .routes(routes!(users::list))
        .routes(routes!(users::put, removals::user))
        .routes(routes!(removals::organisation))
        .routes(routes!(removals::factory))
        .routes(routes!(removals::tool))
        .routes(routes!(factories::list, factories::add))
        .routes(routes!(factories::make_token))
        .routes(routes!(factories::revoke))
        .routes(routes!(leases::show))
        .routes(routes!(leases::hand_over))
        .routes(routes!(writers::list))
        .routes(routes!(accesses::list))
        .routes(routes!(accesses::checkpoint))
        .routes(routes!(audit::list))
        .routes(routes!(tools::list, tools::add))
        .routes(routes!(tools::make_credential, tools::revoke))
        .routes(routes!(collaborations::list, collaborations::add))
        .routes(routes!(removals::collaboration))
        .routes(routes!(collaborations::add_member, removals::member))
        .routes(routes!(collaborations::add_factory, removals::collaboration_factory))
        .routes(routes!(networks::list))
        .routes(routes!(networks::show, networks::put, networks::withdraw))
        .routes(routes!(requests::add))
        .routes(routes!(requests::remove))
        .routes(routes!(comments::list, comments::add))
        .routes(routes!(revocations::list))
        .routes(routes!(reports::list))
        .routes(routes!(dead_letters::list))
        .routes(routes!(dead_letters::replay))
        .routes(routes!(ledger_logs::list))
}

/// Operations without a session.
fn open() -> OpenApiRouter<Application> {
    OpenApiRouter::new().routes(routes!(session::sign_in)).routes(routes!(enrolments::enrol))
}
