//! The web side as a browser meets it: over a real socket, with cookies.

mod guessing;
mod harness;
mod second_factor;
mod session;
mod slow_clients;
mod tls;

use std::time::Duration;

use daemon::{
    telemetry::Metrics,
    web::{health::serve_operator, server},
};
use harness::Harness;
use reqwest::Method;
use testkit::ApiClient;
use tokio_util::sync::CancellationToken;

#[tokio::test]
async fn problems_are_documents_everywhere() {
    let harness = Harness::start().await;
    let check = async |path: &str, status: u16, code: &str| {
        let response = harness.get(path).await;
        assert_eq!(response.status(), status, "{path}");
        assert_eq!(response.headers()["content-type"], "application/problem+json", "{path}");
        let problem: serde_json::Value = response.json().await.expect("JSON");
        assert_eq!(problem["code"], code, "{path}: {problem}");
    };
    check("/api/v1/nothing", 404, "UNKNOWN_ROUTE").await;
    check("/api/v1/session", 401, "NOT_SIGNED_IN").await;
    check("/assets/missing.js", 404, "UNKNOWN_ROUTE").await;
    check("/", 503, "NO_PAGES").await;

    let body = serde_json::json!({ "userName": "ann", "password": 7 });
    let answer = harness.api.call(Method::POST, "/api/v1/session", Some(&body)).await;
    let answer = answer.expect("an answer");
    assert_eq!(answer.status, 422);
    let problem = answer.json();
    assert_eq!(problem["faults"][0]["pointer"], "/password", "{problem}");

    let response = harness.send(Method::DELETE, "/healthz").await;
    assert_eq!(response.status(), 405);
    assert_eq!(response.headers()["content-type"], "application/problem+json");
}

#[tokio::test]
async fn every_answer_carries_the_security_headers() {
    let harness = Harness::start().await;
    for path in ["/healthz", "/api/v1/nothing"] {
        let response = harness.get(path).await;
        let policy = response.headers()["content-security-policy"].to_str().expect("text");
        assert!(policy.contains("frame-ancestors 'none'"), "{policy}");
        assert_eq!(response.headers()["x-content-type-options"], "nosniff");
        assert_eq!(response.headers()["cache-control"], "no-store");
    }
    let foreign =
        harness.api.request(Method::POST, "/api/v1/session").header("sec-fetch-site", "cross-site");
    assert_eq!(foreign.send().await.expect("an answer").status(), 403);
}

#[tokio::test]
async fn strangers_learn_whether_it_is_ready_and_operators_why_not() {
    let harness = Harness::start().await;
    let metrics = Metrics::install().expect("the recorder");
    let listener = server::listen(([127, 0, 0, 1], 0).into()).await.expect("a free port");
    let origin = format!("http://{}", listener.local_addr().expect("bound"));
    let shutdown = CancellationToken::new();
    let _stops = shutdown.clone().drop_guard();
    tokio::spawn(serve_operator(listener, harness.readiness.clone(), metrics, shutdown));
    let operator = ApiClient::new(origin, Duration::from_secs(60)).expect("a client");
    let get = async |client: &ApiClient, path| {
        client.call(Method::GET, path, None).await.expect("an answer")
    };

    harness.readiness.waiting("broker", "not connected yet");
    let (public, private) = (get(&harness.api, "/readyz").await, get(&operator, "/readyz").await);
    assert_eq!((public.status.as_u16(), private.status.as_u16()), (503, 503));
    assert_eq!(public.json(), serde_json::json!({ "ready": false }));
    assert_eq!(private.json()["waitingFor"]["broker"], "not connected yet");
    harness.readiness.ready("broker");
    assert_eq!(get(&harness.api, "/readyz").await.status, 200);

    assert_eq!(get(&harness.api, "/metrics").await.status, 404);
    let shown = get(&operator, "/metrics").await;
    assert!(shown.text.contains("verbund_http_connections{listener=\"pages\"}"), "{}", shown.text);
}
