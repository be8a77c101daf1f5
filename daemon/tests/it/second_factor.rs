//! A second factor from its secret to its removal.

use std::time::Duration;

use daemon::web::session::{SessionConfig, StoredSecondFactor};
use reqwest::Method;
use serde_json::{Value, json};
use testkit::{Answer, ApiClient, authenticator::code};

use crate::harness::Harness;

const SESSION: &str = "/api/v1/session";
const FACTOR: &str = "/api/v1/session/second-factor";
const PASSWORD: &str = "correct horse";

async fn sign_in(client: &ApiClient, code: Option<&str>) -> Answer {
    let mut body = json!({ "userName": "ann", "password": PASSWORD });
    if let Some(code) = code {
        body["code"] = code.into();
    }
    client.call(Method::POST, SESSION, Some(&body)).await.expect("an answer")
}

fn problem(answer: &Answer) -> (u16, Value) {
    (answer.status.as_u16(), answer.json()["code"].clone())
}

/// Starts, signs ann in and turns her second factor on. Returns secret and recovery codes.
async fn with_factor(
    change: impl FnOnce(&mut SessionConfig),
) -> (Harness, ApiClient, String, Vec<Value>) {
    let harness = Harness::start_with(|sessions, _| change(sessions)).await;
    let mut ann = ApiClient::new(harness.api.origin(), Duration::from_secs(60)).expect("a client");
    ann.sign_in("ann", PASSWORD).await.expect("an answer");
    let call =
        async |method, body: Value| ann.call(method, FACTOR, Some(&body)).await.expect("an answer");
    let refused = call(Method::POST, json!({ "password": "wrong" })).await;
    assert_eq!(problem(&refused), (422, json!("WRONG_PASSWORD")));
    let offer = call(Method::POST, json!({ "password": PASSWORD })).await.json();
    let secret = offer["secret"].as_str().expect("a secret").to_owned();
    let uri = offer["uri"].as_str().expect("a URI");
    assert!(uri.starts_with("otpauth://totp/Verbund%20test:ann?secret="), "{uri}");
    assert!(offer["qrCode"].as_str().expect("a picture").starts_with("<svg "));

    let other = ApiClient::new(harness.api.origin(), Duration::from_secs(60)).expect("a client");
    assert_eq!(sign_in(&other, None).await.status, 200, "it counts once it is confirmed");
    let refused = call(Method::PUT, json!({ "code": "000000" })).await;
    assert_eq!(problem(&refused), (422, json!("WRONG_CODE")));
    let confirmed = call(Method::PUT, json!({ "code": code(&secret, 0) })).await.json();
    let codes = confirmed["recoveryCodes"].as_array().expect("codes").clone();
    assert_eq!(codes.len(), 10);
    let again = call(Method::POST, json!({ "password": PASSWORD })).await;
    assert_eq!(problem(&again), (409, json!("SECOND_FACTOR_ON")));
    (harness, ann, secret, codes)
}

#[tokio::test]
async fn signing_in_takes_a_code_which_is_good_once() {
    let (harness, ann, secret, recovery) = with_factor(|_| ()).await;
    let client = ApiClient::new(harness.api.origin(), Duration::from_secs(60)).expect("a client");
    let needed = sign_in(&client, None).await;
    assert_eq!(problem(&needed), (401, json!("SECOND_FACTOR_NEEDED")));
    let wrong = sign_in(&client, Some("000000")).await;
    assert_eq!(problem(&wrong), (401, json!("WRONG_CREDENTIALS")));
    // The present step was used to confirm.
    let next = code(&secret, 1);
    assert_eq!(sign_in(&client, Some(&next)).await.status, 200);
    assert_eq!(sign_in(&client, Some(&next)).await.status, 401, "a replay");

    let recovery = recovery[0].as_str().expect("a code").to_lowercase();
    assert_eq!(sign_in(&client, Some(&recovery)).await.status, 200);
    assert_eq!(sign_in(&client, Some(&recovery)).await.status, 401, "used up");

    harness.memory.factors.lock().get_mut("ann").expect("a factor").last_step = 0;
    let removal = "/api/v1/session/second-factor/removal";
    let remove = async |code: &str| {
        let body = json!({ "password": PASSWORD, "code": code });
        ann.call(Method::POST, removal, Some(&body)).await.expect("an answer").status
    };
    assert_eq!(remove("000000").await, 422);
    assert_eq!(remove(&code(&secret, 0)).await, 204);
    assert_eq!(sign_in(&client, None).await.status, 200);
}

#[tokio::test]
async fn codes_are_guessed_no_faster_than_passwords() {
    let wait = Duration::from_secs(600);
    let (harness, _ann, secret, _) = with_factor(|sessions| {
        sessions.throttle.first_wait = wait;
        sessions.throttle.longest_wait = wait;
    })
    .await;
    let client = ApiClient::new(harness.api.origin(), wait).expect("a client");
    let mut refused = 0;
    for _ in 0..20 {
        // Asking without a code is no way to begin again.
        sign_in(&client, None).await;
        if sign_in(&client, Some("000000")).await.status == 401 {
            refused += 1;
        }
    }
    assert!(refused <= 5, "{refused} guesses");
    assert_eq!(sign_in(&client, Some(&code(&secret, 1))).await.status, 429);
}

#[tokio::test]
async fn a_second_factor_is_stored_sealed_and_opens_for_its_user_with_its_key_alone() {
    let (harness, _, secret, recovery) = with_factor(|_| ()).await;
    let client = ApiClient::new(harness.api.origin(), Duration::from_secs(60)).expect("a client");
    let stored = harness.memory.factors.lock()["ann"].clone();
    let sealed = stored.sealed_secret.clone().expect("sealed");
    assert!(sealed.starts_with("v1.") && !sealed.contains(&secret), "{sealed}");
    let of_bob = StoredSecondFactor { is_confirmed: true, last_step: 0, ..stored };
    harness.memory.factors.lock().insert("bob".to_owned(), of_bob);
    let hash = harness.memory.users.lock()["ann"].clone();
    harness.memory.users.lock().insert("bob".to_owned(), hash);
    let body = json!({ "userName": "bob", "password": PASSWORD, "code": code(&secret, 1) });
    let moved = client.call(Method::POST, SESSION, Some(&body)).await.expect("an answer");
    assert_eq!(problem(&moved), (503, json!("SECOND_FACTOR_SEALED")), "it was sealed for ann");

    std::fs::remove_file(harness.keys.path().join("sealing-key")).expect("lost");
    let lost = sign_in(&client, Some(&code(&secret, 1))).await;
    assert_eq!(problem(&lost), (503, json!("SECOND_FACTOR_SEALED")));
    assert_eq!(problem(&sign_in(&client, None).await), (401, json!("SECOND_FACTOR_NEEDED")));
    let recovery = recovery[0].as_str().expect("a code");
    assert_eq!(sign_in(&client, Some(recovery)).await.status, 200);
    // What a person had removed, since no key opens it.
    harness.memory.factors.lock().get_mut("ann").expect("a factor").sealed_secret = None;
    let forgotten = sign_in(&client, Some(&code(&secret, 1))).await;
    assert_eq!(problem(&forgotten), (503, json!("SECOND_FACTOR_SEALED")));
}
