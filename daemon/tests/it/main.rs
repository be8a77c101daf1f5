//! The web side as a browser meets it: over a real socket, with cookies.

mod harness;
mod guessing;
mod session;
mod slow_clients;
mod tls;

use harness::Harness;
use reqwest::Method;

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
async fn health_says_what_it_waits_for() {
    let harness = Harness::start().await;
    let get = async || {
        let response = harness.get("/readyz").await;
        (response.status().as_u16(), response.json::<serde_json::Value>().await.expect("JSON"))
    };
    harness.readiness.waiting("broker", "not connected yet");
    let (status, report) = get().await;
    assert_eq!((status, &report["waitingFor"]["broker"]), (503, &"not connected yet".into()));
    harness.readiness.ready("broker");
    assert_eq!(get().await.0, 200);
    assert_eq!(harness.get("/metrics").await.status(), 200);
    let by_proxy =
        harness.api.request(Method::GET, "/metrics").header("x-forwarded-for", "192.0.2.7");
    assert_eq!(by_proxy.send().await.expect("an answer").status(), 403);
}
