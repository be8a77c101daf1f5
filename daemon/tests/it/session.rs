//! Signing in and out.

use std::time::{Duration, SystemTime};

use reqwest::Method;
use serde_json::{Value, json};

use crate::harness::Harness;

const SESSION: &str = "/api/v1/session";

async fn sign_in(harness: &Harness, user: &str, password: &str) -> (u16, Value) {
    let body = json!({ "userName": user, "password": password });
    // Without keeping the CSRF token, as a foreign page would not have it.
    let answer = harness.api.call(Method::POST, SESSION, Some(&body)).await.expect("an answer");
    (answer.status.as_u16(), serde_json::from_str(&answer.text).expect("JSON"))
}

async fn who(harness: &Harness) -> u16 {
    harness.get(SESSION).await.status().as_u16()
}

#[tokio::test]
async fn a_session_from_sign_in_to_sign_out() {
    let harness = Harness::start().await;
    assert_eq!(who(&harness).await, 401);
    let (status, view) = sign_in(&harness, "ann", "correct horse").await;
    assert_eq!((status, &view["userName"]), (200, &json!("ann")));
    assert_eq!(who(&harness).await, 200);

    assert_eq!(harness.send(Method::DELETE, SESSION).await.status(), 403);
    let sign_out = async |token: &str| {
        let request = harness.api.request(Method::DELETE, SESSION).header("x-csrf-token", token);
        request.send().await.expect("an answer").status()
    };
    assert_eq!(sign_out("x").await, 403);
    assert_eq!(sign_out(view["csrfToken"].as_str().expect("a token")).await, 200);
    assert_eq!(who(&harness).await, 401);
    assert!(harness.memory.sessions.lock().is_empty());
}

#[tokio::test]
async fn the_cookie_is_guarded_and_the_store_does_not_know_it() {
    let harness = Harness::start().await;
    let body = json!({ "userName": "ann", "password": "correct horse" });
    let request = harness.api.request(Method::POST, SESSION).json(&body);
    let response = request.send().await.expect("an answer");
    let cookie = response.headers()["set-cookie"].to_str().expect("text").to_owned();
    for part in ["HttpOnly", "SameSite=Strict", "Path=/", "Max-Age=43200"] {
        assert!(cookie.contains(part), "{cookie}");
    }
    let token = cookie.split(['=', ';']).nth(1).expect("a value");
    assert!(harness.memory.sessions.lock().keys().all(|id| id != token));
}

#[tokio::test]
async fn wrong_names_and_passwords_look_alike_and_are_slowed() {
    let harness = Harness::start().await;
    let (wrong_password, first) = sign_in(&harness, "ann", "wrong").await;
    let (wrong_name, second) = sign_in(&harness, "bob", "correct horse").await;
    assert_eq!((wrong_password, wrong_name), (401, 401));
    assert_eq!(first, second);
    for _ in 0..4 {
        sign_in(&harness, "ann", "wrong").await;
    }
    let (status, problem) = sign_in(&harness, "ann", "correct horse").await;
    assert_eq!(status, 429);
    assert_eq!(problem["retryAfterSeconds"], 1);
}

#[tokio::test]
async fn a_session_ends_by_time_and_with_its_user() {
    let harness = Harness::start().await;
    sign_in(&harness, "ann", "correct horse").await;
    for session in harness.memory.sessions.lock().values_mut() {
        session.expires_at = SystemTime::UNIX_EPOCH;
    }
    assert_eq!(who(&harness).await, 401);

    sign_in(&harness, "ann", "correct horse").await;
    assert_eq!(who(&harness).await, 200);
    harness.memory.users.lock().clear();
    assert_eq!(who(&harness).await, 401);
}

#[tokio::test]
async fn who_is_no_longer_signed_in_hears_no_more() {
    let harness = Harness::start().await;
    assert_eq!(harness.get("/api/v1/live").await.status(), 401);
    sign_in(&harness, "ann", "correct horse").await;
    let mut live = harness.get("/api/v1/live").await;
    assert!(live.chunk().await.expect("it goes on").is_some());
    let silence = tokio::time::timeout(Duration::from_millis(200), live.chunk()).await;
    assert!(silence.is_err(), "it goes on while the session does: {silence:?}");
    harness.memory.sessions.lock().clear();
    let end = tokio::time::timeout(Duration::from_secs(20), live.chunk())
        .await
        .expect("it ends with the session");
    assert_eq!(end.expect("it ends well"), None);
}
