//! The web side as a browser meets it: over a real socket, with cookies.

mod corpus;
mod guessing;
mod harness;
mod memory;
mod notices;
mod passkeys;
mod second_factor;
mod session;
mod shares;
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
async fn reasons_and_metrics_are_for_programs_on_the_same_machine() {
    let harness = Harness::start().await;
    let get = async |path: &str| {
        let response = harness.get(path).await;
        (response.status().as_u16(), response.text().await.expect("a text"))
    };
    let get_by_proxy = async |path: &str| {
        let request = harness.api.request(Method::GET, path).header("x-forwarded-for", "192.0.2.7");
        let response = request.send().await.expect("an answer");
        (response.status().as_u16(), response.text().await.expect("a text"))
    };
    harness.readiness.waiting("broker", "not connected yet");
    let (status, report) = get("/readyz").await;
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!((status, &report["waitingFor"]["broker"]), (503, &"not connected yet".into()));
    assert_eq!(get_by_proxy("/readyz").await, (503, r#"{"ready":false}"#.to_owned()));
    harness.readiness.ready("broker");
    assert_eq!(get("/readyz").await.0, 200);
    assert_eq!(get_by_proxy("/readyz").await.0, 200);
    let (status, metrics) = get("/metrics").await;
    assert_eq!(status, 200);
    assert!(metrics.contains("verbund_http_connections"), "{metrics}");
    assert_eq!(get_by_proxy("/metrics").await.0, 403);
}
