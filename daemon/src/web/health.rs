//! `/healthz` and `/readyz` for everybody; reasons and `/metrics` for those who run the machine.

use std::{collections::BTreeMap, sync::Arc};

use axum::{
    Json, Router,
    http::{StatusCode, header},
    response::{IntoResponse, Response},
    routing::get,
};
use parking_lot::Mutex;
use serde::Serialize;
use tokio::net::TcpListener;
use tokio_util::sync::CancellationToken;

use super::server::{self, ServerLimits};
use crate::telemetry::Metrics;

/// Conditions that a daemon waits for before it is ready. Parts set their own entry; clones share them.
#[derive(Debug, Clone, Default)]
pub struct Readiness(Arc<Mutex<BTreeMap<&'static str, Option<String>>>>);

impl Readiness {
    /// Nothing to wait for yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Reports that a part works; `/readyz` answers 200 once all parts do.
    pub fn ready(&self, part: &'static str) {
        self.0.lock().insert(part, None);
    }

    /// Reports that a part does not work, with the reason that the listener of metrics shows.
    pub fn waiting(&self, part: &'static str, reason: impl Into<String>) {
        self.0.lock().insert(part, Some(reason.into()));
    }

    fn report(&self) -> ReadinessReport {
        let parts = self.0.lock().clone();
        ReadinessReport {
            ready: parts.values().all(Option::is_none),
            waiting_for: Some(
                parts.into_iter().filter_map(|(part, reason)| Some((part, reason?))).collect(),
            ),
        }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct ReadinessReport {
    ready: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    waiting_for: Option<BTreeMap<&'static str, String>>,
}

impl ReadinessReport {
    fn without_reasons(self) -> Self {
        Self { waiting_for: None, ..self }
    }
}

/// Routes beside the pages, which need no session: whether the daemon lives and is ready, not why.
pub fn public_routes<S: Clone + Send + Sync + 'static>(readiness: Readiness) -> Router<S> {
    Router::new()
        .route("/healthz", get(|| async { "ok\n" }))
        .route("/readyz", get(move || async move { answer(&readiness.report().without_reasons()) }))
}

/// Routes of a listener of their own: readiness with reasons, and metrics, whose labels name factories.
pub fn operator_routes(readiness: Readiness, metrics: Metrics) -> Router {
    Router::new()
        .route("/healthz", get(|| async { "ok\n" }))
        .route("/readyz", get(move || async move { answer(&readiness.report()) }))
        .route(
            "/metrics",
            get(move || async move {
                (
                    [(header::CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")],
                    metrics.render(),
                )
            }),
        )
}

/// Serves the operator's routes until shutdown.
pub async fn serve_operator(
    listener: TcpListener,
    readiness: Readiness,
    metrics: Metrics,
    shutdown: CancellationToken,
) {
    let router = operator_routes(readiness, metrics);
    let limits = ServerLimits { listener: "metrics", ..ServerLimits::default() };
    server::serve(listener, None, router, limits, shutdown).await;
}

fn answer(report: &ReadinessReport) -> Response {
    let status = if report.ready { StatusCode::OK } else { StatusCode::SERVICE_UNAVAILABLE };
    (status, Json(report)).into_response()
}
