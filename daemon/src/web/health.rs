//! `/healthz`, `/readyz` and `/metrics`.

use std::{collections::BTreeMap, sync::Arc};

use axum::{
    Json, Router,
    http::{StatusCode, header},
    response::{IntoResponse, Response},
    routing::get,
};
use parking_lot::Mutex;
use serde::Serialize;

use crate::telemetry::Metrics;

/// Conditions that a daemon waits for before it is ready. Parts set their own entry; clones share them.
#[derive(Debug, Clone, Default)]
pub struct Readiness(Arc<Mutex<BTreeMap<&'static str, Option<String>>>>);

impl Readiness {
    /// Makes one with nothing to wait for yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Reports that a part works; `/readyz` answers 200 once all parts do.
    pub fn ready(&self, part: &'static str) {
        self.0.lock().insert(part, None);
    }

    /// Reports that a part does not work, with the reason that `/readyz` shows.
    pub fn waiting(&self, part: &'static str, reason: impl Into<String>) {
        self.0.lock().insert(part, Some(reason.into()));
    }

    fn report(&self) -> ReadinessReport {
        let parts = self.0.lock().clone();
        ReadinessReport {
            ready: parts.values().all(Option::is_none),
            waiting_for: parts
                .into_iter()
                .filter_map(|(part, reason)| Some((part, reason?)))
                .collect(),
        }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct ReadinessReport {
    ready: bool,
    waiting_for: BTreeMap<&'static str, String>,
}

/// The three routes. They tell nothing of plant or partners and need no session.
pub fn routes<S: Clone + Send + Sync + 'static>(
    readiness: Readiness,
    metrics: Metrics,
) -> Router<S> {
    Router::new()
        .route("/healthz", get(|| async { "ok\n" }))
        .route("/readyz", get(move || async move { ready_answer(&readiness) }))
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

fn ready_answer(readiness: &Readiness) -> Response {
    let report = readiness.report();
    let status = if report.ready { StatusCode::OK } else { StatusCode::SERVICE_UNAVAILABLE };
    (status, Json(report)).into_response()
}
