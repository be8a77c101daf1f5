//! Passkeys from their registration to their removal.

use std::time::Duration;

use daemon::web::session::{PASSKEYS_MAX, RelyingParty, SessionConfig};
use reqwest::Method;
use serde_json::{Value, json};
use testkit::{Answer, ApiClient, SecurityKey, authenticator::code};

use crate::harness::{Harness, PAGES};

const SESSION: &str = "/api/v1/session";
const PASSKEYS: &str = "/api/v1/session/passkeys";
const FACTOR: &str = "/api/v1/session/second-factor";
const PASSWORD: &str = "correct horse";

/// A small daemon with ann, and her client that is signed in.
struct Pages {
    harness: Harness,
    ann: ApiClient,
}

impl Pages {
    async fn open() -> Self {
        Self::open_with(|_| ()).await
    }

    /// Opens with settings that differ from the usual ones.
    async fn open_with(change: impl FnOnce(&mut SessionConfig)) -> Self {
        let harness = Harness::start_with(|sessions, _| {
            // What is refused here is not to wait for what was refused before.
            sessions.throttle.free_failures = 1000;
            change(sessions);
        })
        .await;
        let ann = signed_in(&harness, "ann").await;
        Self { harness, ann }
    }

    fn stranger(&self) -> ApiClient {
        client(&self.harness)
    }

    /// Signs ann in at a new browser, with members beside name and password.
    async fn sign_in(&self, members: Value) -> Answer {
        sign_in(&self.harness, "ann", members).await
    }

    /// Returns the options with which ann signs in.
    async fn options(&self) -> Value {
        let needed = self.sign_in(json!({})).await;
        assert_eq!(problem(&needed), (401, json!("SECOND_FACTOR_NEEDED")));
        needed.json()["secondFactor"]["passkeyOptions"].clone()
    }

    /// Status of a sign-in of ann with an assertion.
    async fn status(&self, passkey: &Value) -> u16 {
        self.sign_in(json!({ "passkey": passkey })).await.status.as_u16()
    }
}

fn client(harness: &Harness) -> ApiClient {
    ApiClient::new(harness.api.origin(), Duration::from_secs(60)).expect("a client")
}

async fn signed_in(harness: &Harness, user_name: &str) -> ApiClient {
    let mut client = client(harness);
    client.sign_in(user_name, PASSWORD).await.expect("an answer");
    client
}

async fn sign_in(harness: &Harness, user_name: &str, members: Value) -> Answer {
    let mut body = json!({ "userName": user_name, "password": PASSWORD });
    body.as_object_mut().expect("members").extend(members.as_object().expect("members").clone());
    call(&client(harness), Method::POST, SESSION, body).await
}

async fn call(client: &ApiClient, method: Method, path: &str, body: Value) -> Answer {
    client.call(method, path, Some(&body)).await.expect("an answer")
}

fn problem(answer: &Answer) -> (u16, Value) {
    (answer.status.as_u16(), answer.json()["code"].clone())
}

async fn offer(person: &ApiClient) -> Value {
    let offer = call(person, Method::POST, PASSKEYS, json!({ "password": PASSWORD })).await;
    assert_eq!(offer.status, 200, "{}", offer.text);
    offer.json()["options"].clone()
}

async fn add(person: &ApiClient, credential: &Value) -> Answer {
    let body = json!({ "name": "Blue key", "credential": credential });
    call(person, Method::PUT, PASSKEYS, body).await
}

/// Adds a passkey; returns it with the recovery codes.
async fn added(person: &ApiClient, name: &str) -> (SecurityKey, Vec<Value>) {
    let mut key = SecurityKey::new(name, PAGES);
    let credential = key.create(&offer(person).await);
    let answer = add(person, &credential).await;
    assert_eq!(answer.status, 200, "{}", answer.text);
    (key, answer.json()["recoveryCodes"].as_array().expect("codes").clone())
}

async fn listed(person: &ApiClient) -> Vec<Value> {
    let list = person.call(Method::GET, PASSKEYS, None).await.expect("an answer").json();
    list["items"].as_array().expect("a list").clone()
}

async fn remove(person: &ApiClient, passkey: &Value, password: &str) -> u16 {
    let id = passkey["passkeyId"].as_str().expect("an id");
    let path = format!("{PASSKEYS}/{id}/removal");
    call(person, Method::POST, &path, json!({ "password": password })).await.status.as_u16()
}

#[tokio::test]
async fn a_passkey_signs_in_beside_the_password_until_it_is_removed() {
    let pages = Pages::open().await;
    let refused = call(&pages.ann, Method::POST, PASSKEYS, json!({ "password": "wrong" })).await;
    assert_eq!(problem(&refused), (422, json!("WRONG_PASSWORD")));
    let options = offer(&pages.ann).await;
    assert_eq!(options["rp"], json!({ "name": "Verbund test", "id": "localhost" }));
    assert_eq!(options["user"]["name"], "ann");
    assert_eq!(options["attestation"], "none");
    assert_eq!(options["authenticatorSelection"]["userVerification"], "preferred");
    assert_eq!(options["timeout"], 120_000);

    let (mut key, recovery) = added(&pages.ann, "blue").await;
    assert_eq!(recovery.len(), 10, "the first second factor comes with recovery codes");
    let list = listed(&pages.ann).await;
    assert_eq!((list.len(), &list[0]["name"]), (1, &json!("Blue key")));
    assert_eq!(list[0]["lastUsedAt"], Value::Null);
    let needed = pages.sign_in(json!({})).await.json();
    assert_eq!(needed["secondFactor"]["kinds"], json!(["PASSKEY"]));
    let options = needed["secondFactor"]["passkeyOptions"].clone();
    assert_eq!(options["rpId"], "localhost");
    assert_eq!(pages.status(&key.get(&options)).await, 200);
    assert!(listed(&pages.ann).await[0]["lastUsedAt"].is_string());
    // An authenticator need not name the user.
    key.user_handle = None;
    let options = pages.options().await;
    assert_eq!(pages.status(&key.get(&options)).await, 200);

    let code = recovery[0].clone();
    assert_eq!(pages.sign_in(json!({ "code": code })).await.status, 200);
    assert_eq!(pages.sign_in(json!({ "code": code })).await.status, 401, "used up");
    assert_eq!(remove(&pages.ann, &list[0], "wrong").await, 422);
    assert_eq!(remove(&pages.ann, &list[0], PASSWORD).await, 204);
    assert_eq!(remove(&pages.ann, &list[0], PASSWORD).await, 404);
    assert_eq!(pages.sign_in(json!({})).await.status, 200, "the password is enough again");
    assert!(pages.harness.memory.factors.lock().is_empty(), "recovery codes went with it");
}

#[tokio::test]
async fn passkeys_and_codes_are_on_beside_each_other_with_the_same_recovery_codes() {
    let pages = Pages::open().await;
    let (mut key, recovery) = added(&pages.ann, "blue").await;
    let wanted = json!({ "password": PASSWORD });
    let secret = call(&pages.ann, Method::POST, FACTOR, wanted).await.json()["secret"].clone();
    let secret = secret.as_str().expect("a secret").to_owned();
    let confirmed =
        call(&pages.ann, Method::PUT, FACTOR, json!({ "code": code(&secret, 0) })).await;
    assert_eq!(confirmed.json()["recoveryCodes"], json!([]), "those of before stay");
    let needed = pages.sign_in(json!({})).await.json();
    assert_eq!(needed["secondFactor"]["kinds"], json!(["CODE", "PASSKEY"]));
    let options = needed["secondFactor"]["passkeyOptions"].clone();
    assert_eq!(pages.status(&key.get(&options)).await, 200);
    assert_eq!(pages.sign_in(json!({ "code": code(&secret, 1) })).await.status, 200);
    assert_eq!(pages.sign_in(json!({ "code": recovery[0] })).await.status, 200);
    let (_, more) = added(&pages.ann, "red").await;
    assert_eq!(more, Vec::<Value>::new());

    let removal = json!({ "password": PASSWORD, "code": recovery[1] });
    let path = format!("{FACTOR}/removal");
    assert_eq!(call(&pages.ann, Method::POST, &path, removal).await.status, 204);
    let needed = pages.sign_in(json!({})).await.json();
    assert_eq!(needed["secondFactor"]["kinds"], json!(["PASSKEY"]));
    assert_eq!(pages.sign_in(json!({ "code": recovery[1] })).await.status, 401, "used up");
    assert_eq!(pages.sign_in(json!({ "code": recovery[2] })).await.status, 200);
}

#[tokio::test]
async fn assertions_for_other_pages_challenges_people_and_counters_are_refused() {
    let pages = Pages::open().await;
    let (mut key, _) = added(&pages.ann, "blue").await;
    let refused = async |pages: &Pages, passkey: &Value, reason: &str| {
        let answer = pages.sign_in(json!({ "passkey": passkey })).await;
        assert_eq!(problem(&answer), (401, json!("WRONG_CREDENTIALS")), "{reason}");
    };
    let options = pages.options().await;
    let first = key.get(&options);
    assert_eq!(pages.status(&first).await, 200);
    refused(&pages, &first, "a replay").await;

    for origin in ["https://localhost:8080", "http://localhost", "http://evil.localhost:8080"] {
        key.origin = origin.to_owned();
        refused(&pages, &key.get(&pages.options().await), origin).await;
    }
    key.origin = PAGES.to_owned();
    key.rp_id = Some("evil.example".to_owned());
    refused(&pages, &key.get(&pages.options().await), "another relying party").await;
    key.rp_id = None;

    let mut options = pages.options().await;
    options["challenge"] = json!("AAAAAAAAAAAAAAAAAAAAAA");
    refused(&pages, &key.get(&options), "a challenge that was not given").await;
    let mut forged = key.get(&pages.options().await);
    let of_another = SecurityKey::new("red", PAGES).get(&pages.options().await);
    forged["response"]["signature"] = of_another["response"]["signature"].clone();
    refused(&pages, &forged, "a signature by another key").await;
    refused(&pages, &of_another, "an unknown key").await;
    refused(&pages, &json!({}), "no assertion").await;

    // A copy of the key does not know how often it was used.
    key.counter = 0;
    refused(&pages, &key.get(&pages.options().await), "a counter that went back").await;
    key.counter = 50;
    assert_eq!(pages.status(&key.get(&pages.options().await)).await, 200);
    let options = pages.options().await;
    let list = listed(&pages.ann).await;
    added(&pages.ann, "green").await;
    assert_eq!(remove(&pages.ann, &list[0], PASSWORD).await, 204);
    refused(&pages, &key.get(&options), "a removed passkey").await;
}

#[tokio::test]
async fn a_passkey_and_its_challenge_are_for_their_user_alone() {
    let pages = Pages::open().await;
    let hash = pages.harness.memory.users.lock()["ann"].clone();
    pages.harness.memory.users.lock().insert("bob".to_owned(), hash);
    let bob = signed_in(&pages.harness, "bob").await;
    // A credential that was made for bob is none of ann's, nor is his challenge.
    let mut key = SecurityKey::new("stray", PAGES);
    let stray = key.create(&offer(&bob).await);
    assert_eq!(problem(&add(&pages.ann, &stray).await), (422, json!("PASSKEY_REFUSED")));
    assert_eq!(add(&bob, &stray).await.status, 200);
    assert_eq!(problem(&add(&bob, &stray).await), (422, json!("PASSKEY_REFUSED")), "a replay");
    let again = SecurityKey::new("stray", PAGES).create(&offer(&pages.ann).await);
    assert_eq!(problem(&add(&pages.ann, &again).await), (409, json!("PASSKEY_KNOWN")));

    let (mut blue, _) = added(&pages.ann, "blue").await;
    let options = pages.options().await;
    let by_bob = key.get(&options);
    assert_eq!(pages.status(&by_bob).await, 401, "ann, by bob's key");
    let by_ann = blue.get(&pages.options().await);
    let as_bob = sign_in(&pages.harness, "bob", json!({ "passkey": by_ann })).await;
    assert_eq!(as_bob.status, 401, "bob, by ann's challenge");
    assert_eq!(pages.status(&by_ann).await, 200, "which it did not use up");
    let list = listed(&pages.ann).await;
    assert_eq!(remove(&bob, &list[0], PASSWORD).await, 404);
}

#[tokio::test]
async fn credentials_for_other_pages_are_not_registered() {
    let pages = Pages::open().await;
    let mut key = SecurityKey::new("blue", "https://evil.example");
    let credential = key.create(&offer(&pages.ann).await);
    assert_eq!(problem(&add(&pages.ann, &credential).await), (422, json!("PASSKEY_REFUSED")));
    let mut key = SecurityKey::new("blue", PAGES);
    key.rp_id = Some("evil.example".to_owned());
    let credential = key.create(&offer(&pages.ann).await);
    assert_eq!(problem(&add(&pages.ann, &credential).await), (422, json!("PASSKEY_REFUSED")));
    assert_eq!(problem(&add(&pages.ann, &json!({})).await), (422, json!("PASSKEY_REFUSED")));
    for name in ["", "  ", &"x".repeat(65), "a\nb"] {
        let body = json!({ "name": name, "credential": {} });
        let refused = call(&pages.ann, Method::PUT, PASSKEYS, body).await;
        assert_eq!(problem(&refused), (422, json!("NAME_REFUSED")), "{name:?}");
    }
    for count in 0..PASSKEYS_MAX {
        let options = offer(&pages.ann).await;
        assert_eq!(options["excludeCredentials"].as_array().map(Vec::len), Some(count));
        let credential = SecurityKey::new(&count.to_string(), PAGES).create(&options);
        assert_eq!(add(&pages.ann, &credential).await.status, 200);
    }
    let full = call(&pages.ann, Method::POST, PASSKEYS, json!({ "password": PASSWORD })).await;
    assert_eq!(problem(&full), (409, json!("TOO_MANY_PASSKEYS")));
}

#[tokio::test]
async fn a_challenge_expires() {
    // Each sign-in hashes a password first, which takes longer.
    let short = Duration::from_millis(1);
    let pages = Pages::open_with(|sessions| sessions.challenge_lifetime = short).await;
    let mut key = SecurityKey::new("blue", PAGES);
    let options = offer(&pages.ann).await;
    pages.sign_in(json!({})).await;
    let late = add(&pages.ann, &key.create(&options)).await;
    assert_eq!(problem(&late), (422, json!("PASSKEY_REFUSED")));

    let with_key = Pages::open().await;
    let (mut key, _) = added(&with_key.ann, "blue").await;
    pages.harness.memory.passkeys.lock().clone_from(&with_key.harness.memory.passkeys.lock());
    assert_eq!(pages.status(&key.get(&pages.options().await)).await, 401);
    assert_eq!(with_key.status(&key.get(&with_key.options().await)).await, 200);
}

#[tokio::test]
async fn a_flood_of_challenges_is_bounded_and_displaces_the_users_own() {
    let pages = Pages::open().await;
    let (mut key, _) = added(&pages.ann, "blue").await;
    let first = pages.options().await;
    let mut last = Value::Null;
    for _ in 0..8 {
        last = pages.options().await;
    }
    assert_eq!(pages.status(&key.get(&first)).await, 401, "displaced");
    assert_eq!(pages.status(&key.get(&last)).await, 200);
}

#[tokio::test]
async fn who_has_no_password_learns_nothing_of_passkeys_and_guesses_no_faster() {
    let wait = Duration::from_secs(600);
    let pages = Pages::open_with(|sessions| {
        sessions.throttle.free_failures = 5;
        sessions.throttle.first_wait = wait;
        sessions.throttle.longest_wait = wait;
    })
    .await;
    let (mut key, _) = added(&pages.ann, "blue").await;
    let good = key.get(&pages.options().await);
    let attempt = async |user_name: &str| {
        let body = json!({ "userName": user_name, "password": "wrong", "passkey": good });
        call(&pages.stranger(), Method::POST, SESSION, body).await
    };
    let (known, unknown) = (attempt("ann").await, attempt("nobody").await);
    assert_eq!((known.status, &known.text), (unknown.status, &unknown.text));
    assert_eq!(problem(&known), (401, json!("WRONG_CREDENTIALS")));

    let mut refused = 0;
    for _ in 0..20 {
        // Asking for a challenge is no way to begin again.
        pages.sign_in(json!({})).await;
        if pages.status(&json!({})).await == 401 {
            refused += 1;
        }
    }
    assert!(refused <= 4, "{refused} guesses after one");
    assert_eq!(pages.status(&good).await, 429);
}

#[tokio::test]
async fn passkeys_are_unavailable_without_a_domain() {
    let pages =
        Pages::open_with(|config| config.relying_party = RelyingParty::of("http://127.0.0.1:8080"))
            .await;
    let refused = call(&pages.ann, Method::POST, PASSKEYS, json!({ "password": PASSWORD })).await;
    assert_eq!(problem(&refused), (409, json!("PASSKEYS_UNAVAILABLE")));
    let list = pages.ann.call(Method::GET, PASSKEYS, None).await.expect("an answer").json();
    assert!(list["unavailable"].as_str().expect("a reason").contains("domain"), "{list}");

    // A person who had one signs in by a recovery code.
    let before = Pages::open().await;
    let (_, recovery) = added(&before.ann, "blue").await;
    pages.harness.memory.passkeys.lock().clone_from(&before.harness.memory.passkeys.lock());
    pages.harness.memory.factors.lock().clone_from(&before.harness.memory.factors.lock());
    let needed = pages.sign_in(json!({})).await.json();
    assert_eq!(needed["secondFactor"], json!({ "kinds": ["PASSKEY"] }));
    assert_eq!(pages.sign_in(json!({ "code": recovery[0] })).await.status, 200);
}

#[tokio::test]
async fn factors_are_changed_within_minutes_of_a_sign_in_that_showed_one() {
    let pages = Pages::open().await;
    let age = || {
        for session in pages.harness.memory.sessions.lock().values_mut() {
            session.started_at -= Duration::from_secs(601);
        }
    };
    // Without a factor there is none that a sign-in could have shown.
    age();
    let (mut key, _) = added(&pages.ann, "blue").await;
    let passkey = listed(&pages.ann).await.remove(0);
    age();
    let password = json!({ "password": PASSWORD });
    for path in [PASSKEYS, FACTOR] {
        let refused = call(&pages.ann, Method::POST, path, password.clone()).await;
        assert_eq!(problem(&refused), (403, json!("SIGN_IN_AGAIN")), "{path}");
    }
    assert_eq!(remove(&pages.ann, &passkey, PASSWORD).await, 403);
    assert_eq!(listed(&pages.ann).await.len(), 1);

    let mut again = client(&pages.harness);
    let assertion = key.get(&pages.options().await);
    let body = json!({ "userName": "ann", "password": PASSWORD, "passkey": assertion });
    let answer = again.sign_in_with(&body).await.expect("an answer");
    assert_eq!(answer.status, 200, "{}", answer.text);
    assert_eq!(remove(&again, &passkey, PASSWORD).await, 204);
}
