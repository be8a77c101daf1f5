//! The HTTP side: `/api/v1` described by OpenAPI, the partners' pages, health.
//!
//! Handlers extract, authorise, call and map; they contain no SQL and no business decisions. What a viewer has no part
//! in is "not found".

mod administrator_only;
mod collaborations;
mod comments;
mod dead_letters;
mod enrolments;
mod factories;
mod live;
mod networks;
mod organisations;
mod page;
mod problems;
mod reports;
mod requests;
pub mod schema;
mod session;
mod status;
mod tools;
mod users;
mod writers;

use axum::{Json, Router, extract::DefaultBodyLimit, middleware, routing::get};
use daemon::web::{
    assets::with_app,
    headers::secured,
    health,
    problem::{unknown_method, unknown_route},
    session::require_session,
};
use tower_http::{catch_panic::CatchPanicLayer, compression::CompressionLayer, trace::TraceLayer};
use utoipa::{
    Modify, OpenApi,
    openapi::security::{ApiKey, ApiKeyValue, SecurityScheme},
};
use utoipa_axum::{router::OpenApiRouter, routes};

use crate::{accounts::StoredAccounts, application::Application};

/// Largest body of any request: a network may be as large as its parts together.
const BODY_BYTES_MAX: usize = 4 * 1024 * 1024;

/// The partners' pages, as Vite has built them.
#[derive(rust_embed::RustEmbed)]
#[folder = "../web/dist/partner"]
struct PartnerPages;

#[derive(OpenApi)]
#[openapi(
    info(title = "Verbund platform", description = "Operation networks, requests, reports and progress of collaborating \
        factories. Errors are problem documents (RFC 9457). Changes need the session's token in `x-csrf-token`."),
    modifiers(&Security),
)]
struct Description;

struct Security;

impl Modify for Security {
    fn modify(&self, openapi: &mut utoipa::openapi::OpenApi) {
        let scheme = SecurityScheme::ApiKey(ApiKey::Cookie(ApiKeyValue::new("verbund_platform")));
        openapi.components.get_or_insert_default().add_security_scheme("session", scheme);
    }
}

/// Pages, API and health in one router.
pub fn router(application: &Application, has_tls: bool) -> Router {
    let (guarded, _) = guarded().split_for_parts();
    let (open, _) = open().split_for_parts();
    let guarded =
        guarded.layer(middleware::from_fn_with_state(application.sessions.clone(), require_session::<StoredAccounts>));
    let description = openapi();
    let api = guarded
        .merge(open)
        .route("/openapi.json", get(move || async move { Json(description) }))
        .fallback(unknown_route)
        .method_not_allowed_fallback(unknown_method)
        .layer(DefaultBodyLimit::max(BODY_BYTES_MAX));
    let router = Router::new()
        .nest("/api/v1", api)
        .with_state(application.clone())
        .merge(health::routes(application.readiness.clone(), application.metrics.clone()));
    secured(with_app::<PartnerPages, ()>(router), has_tls)
        .layer(CompressionLayer::new())
        .layer(CatchPanicLayer::custom(|_: Box<dyn std::any::Any + Send>| {
            metrics::counter!("verbund_handler_panics_total").increment(1);
            axum::response::IntoResponse::into_response(daemon::web::Problem::new(
                axum::http::StatusCode::INTERNAL_SERVER_ERROR,
                "INTERNAL",
                "Something went wrong here; the log of the platform says what.",
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

/// Operations that need a session.
fn guarded() -> OpenApiRouter<Application> {
    OpenApiRouter::new()
        .routes(routes!(session::show, session::sign_out))
        .routes(routes!(status::show))
        .routes(routes!(organisations::list, organisations::add))
        .routes(routes!(users::put))
        .routes(routes!(factories::list, factories::add))
        .routes(routes!(factories::make_token))
        .routes(routes!(factories::revoke))
        .routes(routes!(writers::list))
        .routes(routes!(tools::list, tools::add))
        .routes(routes!(tools::make_credential, tools::revoke))
        .routes(routes!(collaborations::list, collaborations::add))
        .routes(routes!(collaborations::add_member))
        .routes(routes!(collaborations::add_factory))
        .routes(routes!(networks::list))
        .routes(routes!(networks::show, networks::put, networks::withdraw))
        .routes(routes!(requests::add))
        .routes(routes!(requests::remove))
        .routes(routes!(comments::list, comments::add))
        .routes(routes!(reports::list))
        .routes(routes!(dead_letters::list))
        .routes(routes!(dead_letters::replay))
        .routes(routes!(live::stream))
}

/// Operations without a session.
fn open() -> OpenApiRouter<Application> {
    OpenApiRouter::new().routes(routes!(session::sign_in)).routes(routes!(enrolments::enrol))
}
