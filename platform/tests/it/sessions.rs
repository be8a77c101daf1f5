//! Sessions of the running platform.

use reqwest::Method;
use serde_json::json;

use crate::harness::{ADMIN, PASSWORD, World};

#[tokio::test(flavor = "multi_thread")]
async fn behind_a_proxy_that_speaks_tls_the_cookie_is_for_tls_alone() {
    let world = World::start_behind_tls().await;
    let body = json!({ "userName": ADMIN, "password": PASSWORD });
    let request = world.anonymous().client.request(Method::POST, "/api/v1/session").json(&body);
    let answer = request.send().await.expect("an answer");
    assert!(answer.status().is_success(), "{answer:?}");
    let cookie = answer.headers()["set-cookie"].to_str().expect("text");
    assert!(cookie.starts_with("__Host-verbund_platform_"), "{cookie}");
    assert!(cookie.contains("; Secure") && !cookie.contains("Domain"), "{cookie}");
}
