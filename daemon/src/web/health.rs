//! `/healthz` and `/readyz` for everybody; reasons and `/metrics` for those who run the machine.

use std::{collections::BTreeMap, net::SocketAddr, sync::Arc};

use axum::{
    Json, Router,
    extract::ConnectInfo,
    http::{HeaderMap, StatusCode, header},
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

    /// Reports that a part does not work, with the reason that `/readyz` shows on the same machine.
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

/// Header fields by which a proxy says for whom it asks.
const FORWARDING_HEADERS: [&str; 4] = ["forwarded", "via", "x-forwarded-for", "x-real-ip"];

/// The three routes, which need no session. Metrics and reasons are for programs on the same machine:
/// how many values there were before the gate, and when, is more than partners and viewers may learn.
pub fn routes<S: Clone + Send + Sync + 'static>(
    readiness: Readiness,
    metrics: Metrics,
) -> Router<S> {
    Router::new()
        .route("/healthz", get(|| async { "ok\n" }))
        .route(
            "/readyz",
            get(
                move |ConnectInfo(client): ConnectInfo<SocketAddr>, headers: HeaderMap| async move {
                    ready_answer(client, &headers, &readiness)
                },
            ),
        )
        .route(
            "/metrics",
            get(
                move |ConnectInfo(client): ConnectInfo<SocketAddr>, headers: HeaderMap| async move {
                    metrics_answer(client, &headers, &metrics)
                },
            ),
        )
}

fn metrics_answer(client: SocketAddr, headers: &HeaderMap, metrics: &Metrics) -> Response {
    if !is_of_this_machine(client, headers) {
        return (StatusCode::FORBIDDEN, "metrics are for programs on this machine\n")
            .into_response();
    }
    let content_type = "text/plain; version=0.0.4; charset=utf-8";
    ([(header::CONTENT_TYPE, content_type)], metrics.render()).into_response()
}

/// Returns false also where a proxy on this machine asks for another one.
fn is_of_this_machine(client: SocketAddr, headers: &HeaderMap) -> bool {
    client.ip().to_canonical().is_loopback()
        && !FORWARDING_HEADERS.iter().any(|name| headers.contains_key(*name))
}

fn ready_answer(client: SocketAddr, headers: &HeaderMap, readiness: &Readiness) -> Response {
    let mut report = readiness.report();
    if !is_of_this_machine(client, headers) {
        report.waiting_for = None;
    }
    let status = if report.ready { StatusCode::OK } else { StatusCode::SERVICE_UNAVAILABLE };
    (status, Json(report)).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metrics_are_for_programs_on_the_same_machine() {
        let no_headers = HeaderMap::new();
        for (client, expected) in [
            ("127.0.0.1:40000", true),
            ("[::1]:40000", true),
            ("[::ffff:127.0.0.1]:40000", true),
            ("192.0.2.7:40000", false),
            ("[::ffff:192.0.2.7]:40000", false),
            ("[2001:db8::1]:40000", false),
        ] {
            let address = client.parse().expect("an address");
            assert_eq!(is_of_this_machine(address, &no_headers), expected, "{client}");
        }
    }

    #[test]
    fn a_proxy_on_the_machine_gets_no_metrics_for_others() {
        let client = "127.0.0.1:40000".parse().expect("an address");
        for name in FORWARDING_HEADERS {
            let mut headers = HeaderMap::new();
            headers.insert(name, header::HeaderValue::from_static("192.0.2.7"));
            assert!(!is_of_this_machine(client, &headers), "{name}");
        }
    }
}
