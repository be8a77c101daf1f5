//! The web side as a whole: the API under `/api/v1` with its own description, pages, health, and
//! what guards them.

use std::sync::{Arc, LazyLock};

use axum::{
    Router,
    extract::DefaultBodyLimit,
    http::{HeaderMap, StatusCode, header},
    middleware,
    response::{IntoResponse, Response},
    routing::get,
};
use rust_embed::RustEmbed;
use tower_http::{catch_panic::CatchPanicLayer, compression::CompressionLayer, trace::TraceLayer};
use utoipa::openapi::{
    OpenApi,
    security::{ApiKey, ApiKeyValue, SecurityScheme},
};
use utoipa_axum::router::OpenApiRouter;

use super::{
    assets::with_app,
    client_address::{TrustedProxies, with_client_address},
    composition::{open_composed_schemas, share_page_items},
    compressed::FixedBody,
    headers::secured,
    health::{self, Readiness},
    problem::{Problem, unknown_method, unknown_route},
    responses::{add_share_refusals, describe_responses, operations_of, share_problem_responses},
    roles::SESSION,
    session::{Accounts, Sessions, require_session},
    shares::{hold_body, within_share_of_client},
};
use crate::{notices::NOTICES, telemetry::Metrics};

/// Path below which all operations are.
const API: &str = "/api/v1";
/// Path of what others wrote, with the licences.
const NOTICES_PATH: &str = "/third-party-notices.txt";
/// Largest body of an operation without a session, in bytes: names, passwords and tokens.
const OPEN_BODY_BYTES_MAX: usize = 4096;

/// The operations of an API.
pub struct Operations<S> {
    /// Routes that need a session.
    pub guarded: OpenApiRouter<S>,
    /// Routes that do not.
    pub open: OpenApiRouter<S>,
}

/// Parts that the operations are served with.
pub struct Shell<S, A: Accounts> {
    /// State that handlers extract.
    pub state: S,
    /// Sessions that guard the operations.
    pub sessions: Sessions<A>,
    /// Readiness behind `/readyz`.
    pub readiness: Readiness,
    /// Metrics behind `/metrics`.
    pub metrics: Metrics,
    /// Largest body of any request, in bytes, unless an operation says otherwise.
    pub body_bytes_max: usize,
    /// Cookies and pages are for TLS only.
    pub has_tls: bool,
    /// Proxies whose word about their clients counts.
    pub trusted_proxies: TrustedProxies,
}

/// Pages `P`, operations and health in one router.
pub fn router<P, S, A>(
    operations: Operations<S>,
    description: OpenApi,
    shell: Shell<S, A>,
) -> Router
where
    P: RustEmbed + 'static,
    S: Clone + Send + Sync + 'static,
    A: Accounts,
{
    let (guarded, _) = operations.guarded.split_for_parts();
    let (open, _) = operations.open.split_for_parts();
    let open = open.layer(DefaultBodyLimit::max(OPEN_BODY_BYTES_MAX)).layer(
        middleware::from_fn_with_state(shell.sessions.strangers().clone(), within_share_of_client),
    );
    let description = serde_json::to_vec(&description).expect("a description has no other keys");
    let description = Arc::new(FixedBody::new(description));
    let guarded = guarded
        .layer(DefaultBodyLimit::max(shell.body_bytes_max))
        .layer(middleware::from_fn(hold_body))
        .layer(middleware::from_fn_with_state(shell.sessions, require_session::<A>));
    let api = guarded
        .merge(open)
        .route(
            "/openapi.json",
            get(move |headers: HeaderMap| async move {
                fixed("application/json", &description, &headers)
            }),
        )
        .fallback(unknown_route)
        .method_not_allowed_fallback(unknown_method);
    let router = Router::new()
        .nest(API, api)
        .with_state(shell.state)
        .merge(health::routes(shell.readiness, shell.metrics))
        .route(NOTICES_PATH, get(notices))
        .method_not_allowed_fallback(unknown_method);
    let router = with_client_address(with_app::<P, ()>(router), shell.trusted_proxies);
    secured(router, shell.has_tls)
        .layer(CompressionLayer::new())
        .layer(CatchPanicLayer::custom(panicked))
        .layer(TraceLayer::new_for_http())
}

async fn notices(headers: HeaderMap) -> Response {
    static BODY: LazyLock<FixedBody> = LazyLock::new(|| FixedBody::new(NOTICES));
    fixed("text/plain; charset=utf-8", &BODY, &headers)
}

/// Answers with what is part of the program.
fn fixed(kind: &'static str, body: &FixedBody, asked: &HeaderMap) -> Response {
    let (headers, bytes) = body.for_client(asked);
    ([(header::CONTENT_TYPE, kind)], headers, bytes).into_response()
}

/// Adds all operations to what `description` says of the API as a whole; `cookie` is the first part of
/// the name of the session's cookie. The id of an operation is its handler's name in camel case.
#[must_use]
pub fn described<S>(
    mut description: OpenApi,
    operations: Operations<S>,
    version: &str,
    cookie: &str,
) -> OpenApi
where
    S: Clone + Send + Sync + 'static,
{
    let scheme = SecurityScheme::ApiKey(ApiKey::Cookie(ApiKeyValue::with_description(
        cookie,
        "The name ends with the port, as in `daemon_8080`, and begins with `__Host-` over HTTPS.",
    )));
    description.components.get_or_insert_default().add_security_scheme(SESSION, scheme);
    let mut operations = operations;
    add_share_refusals(operations.guarded.get_openapi_mut());
    // Merged first: `nest` would replace a path that both parts have, as `/session`.
    let (_, mut all) = operations.guarded.merge(operations.open).split_for_parts();
    for operation in all.paths.paths.values_mut().flat_map(operations_of) {
        operation.operation_id = operation.operation_id.as_deref().map(camel_case);
    }
    description = description.nest(API, all);
    describe_responses(&mut description);
    share_problem_responses(&mut description);
    share_page_items(&mut description);
    open_composed_schemas(&mut description);
    version.clone_into(&mut description.info.version);
    description
}

/// `list_policies` as `listPolicies`, the case of everything in the API's JSON.
fn camel_case(name: &str) -> String {
    let mut words = name.split('_');
    let first = words.next().unwrap_or_default().to_owned();
    words.fold(first, |name, word| {
        let (initial, rest) = word.split_at(word.len().min(1));
        name + &initial.to_ascii_uppercase() + rest
    })
}

fn panicked(_: Box<dyn std::any::Any + Send>) -> Response {
    metrics::counter!("verbund_handler_panics_total").increment(1);
    let message = "Something went wrong here; the program's log says what.";
    Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "INTERNAL", message).into_response()
}
