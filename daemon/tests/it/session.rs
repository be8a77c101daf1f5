//! Signing in and out.

use std::time::{Duration, SystemTime};

use daemon::web::session::SessionConfig;
use reqwest::Method;
use serde_json::{Value, json};
use testkit::ApiClient;

use crate::harness::{Harness, PAGES};

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
    assert!(cookie.starts_with("verbund_test_8080="), "{cookie}");
    let token = cookie.split(['=', ';']).nth(1).expect("a value");
    assert!(harness.memory.sessions.lock().keys().all(|id| id != token));
}

#[tokio::test]
async fn the_cookie_of_pages_over_tls_is_for_this_host_and_tls_alone() {
    let over_tls = SessionConfig::new("verbund_test", "Verbund test", true, 8080, PAGES);
    let harness = Harness::start_with(|config, _| *config = over_tls).await;
    let body = json!({ "userName": "ann", "password": "correct horse" });
    let request = harness.api.request(Method::POST, SESSION).json(&body);
    let response = request.send().await.expect("an answer");
    let cookie = response.headers()["set-cookie"].to_str().expect("text").to_owned();
    // What browsers demand of such a name (RFC 6265bis, 4.1.3.2).
    assert!(cookie.starts_with("__Host-verbund_test_8080="), "{cookie}");
    assert!(cookie.contains("; Secure") && cookie.contains("; Path=/"), "{cookie}");
    assert!(!cookie.contains("Domain"), "{cookie}");
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
async fn a_session_ends_without_use_and_goes_on_with_it() {
    let harness = Harness::start().await;
    sign_in(&harness, "ann", "correct horse").await;
    let set_back = |by: Duration| {
        for session in harness.memory.sessions.lock().values_mut() {
            session.last_used_at -= by;
        }
    };
    for _ in 0..3 {
        set_back(Duration::from_secs(3500));
        assert_eq!(who(&harness).await, 200, "each use counts");
    }
    set_back(Duration::from_secs(3601));
    assert_eq!(who(&harness).await, 401);
    assert!(harness.memory.sessions.lock().is_empty());
}

#[tokio::test]
async fn a_new_sign_in_ends_the_session_that_the_browser_had() {
    let harness = Harness::start().await;
    for _ in 0..3 {
        sign_in(&harness, "ann", "correct horse").await;
        assert_eq!(harness.memory.sessions.lock().len(), 1);
    }
}

#[tokio::test]
async fn a_person_has_a_bounded_number_of_sessions() {
    let harness = Harness::start().await;
    let mut browsers = Vec::new();
    for _ in 0..34 {
        browsers.push(browser(&harness, "correct horse").await);
    }
    assert_eq!(harness.memory.sessions.lock().len(), 32);
    let last = browsers.pop().expect("a browser");
    assert_eq!(last.call(Method::GET, SESSION, None).await.expect("an answer").status, 200);
}

/// Another browser in which ann has signed in.
async fn browser(harness: &Harness, password: &str) -> ApiClient {
    let mut browser =
        ApiClient::new(harness.api.origin(), Duration::from_secs(60)).expect("a client");
    let answer = browser.sign_in("ann", password).await.expect("an answer");
    assert_eq!(answer.status, 200, "{}", answer.text);
    browser
}

#[tokio::test]
async fn sessions_are_listed_and_ended_by_their_owner() {
    let harness = Harness::start().await;
    harness.memory.sessions.lock().clear();
    let (here, there) =
        (browser(&harness, "correct horse").await, browser(&harness, "correct horse").await);
    let list = here.call(Method::GET, "/api/v1/sessions", None).await.expect("an answer").json();
    let sessions = list["items"].as_array().expect("sessions");
    assert_eq!(sessions.len(), 2);
    assert!(sessions.iter().all(|each| each["address"] == "127.0.0.1"), "{list}");
    assert_eq!(sessions.iter().filter(|each| each["isPresent"] == true).count(), 1);
    let other = sessions.iter().find(|each| each["isPresent"] == false).expect("the other one");
    let path = format!("/api/v1/sessions/{}", other["sessionId"].as_str().expect("an id"));
    let end = async || here.call(Method::DELETE, &path, None).await.expect("an answer").status;
    assert_eq!(end().await, 204);
    assert_eq!(end().await, 404);
    assert_eq!(there.call(Method::GET, SESSION, None).await.expect("an answer").status, 401);
    assert_eq!(here.call(Method::GET, SESSION, None).await.expect("an answer").status, 200);

    for session in harness.memory.sessions.lock().values_mut() {
        session.user_name = "bob".to_owned();
    }
    let hash = harness.memory.users.lock()["ann"].clone();
    harness.memory.users.lock().insert("bob".to_owned(), hash);
    let ann = browser(&harness, "correct horse").await;
    let id = harness.memory.sessions.lock().values().find(|one| one.user_name == "bob").cloned();
    let path = format!("/api/v1/sessions/{}", id.expect("bob's").id.as_str());
    let answer = ann.call(Method::DELETE, &path, None).await.expect("an answer");
    assert_eq!(answer.status, 404, "what is another's is not found");
}

#[tokio::test]
async fn a_new_password_takes_the_present_one_and_ends_other_sessions() {
    let harness = Harness::start().await;
    let (here, there) =
        (browser(&harness, "correct horse").await, browser(&harness, "correct horse").await);
    let change = async |present: &str, new: &str| {
        let body = json!({ "presentPassword": present, "newPassword": new });
        let answer = here.call(Method::PUT, "/api/v1/session/password", Some(&body)).await;
        let answer = answer.expect("an answer");
        (answer.status.as_u16(), answer.json()["faults"][0]["pointer"].clone())
    };
    let new = "another horse";
    assert_eq!(change("wrong", new).await, (422, json!("/presentPassword")));
    assert_eq!(change("correct horse", "short").await, (422, json!("/newPassword")));
    assert_eq!(change("correct horse", new).await.0, 204);
    assert_eq!(there.call(Method::GET, SESSION, None).await.expect("an answer").status, 401);
    assert_eq!(here.call(Method::GET, SESSION, None).await.expect("an answer").status, 200);
    assert_eq!(sign_in(&harness, "ann", "correct horse").await.0, 401);
    assert_eq!(sign_in(&harness, "ann", new).await.0, 200);
    for _ in 0..5 {
        change("wrong", new).await;
    }
    assert_eq!(change(new, "correct horse").await.0, 429, "guesses count here, too");
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
