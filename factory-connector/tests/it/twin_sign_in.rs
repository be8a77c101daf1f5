//! Sign-in at the OPC UA server: with the second factor of the pages, and in the same count of attempts.

use std::{path::PathBuf, time::SystemTime};

use daemon::web::session::StoredPasskey;
use factory_connector::store::Store;
use opcua_stack::opcua::types::StatusCode;
use reqwest::Method;
use serde_json::{Value, json};
use tempfile::TempDir;
use testkit::authenticator::code;

use crate::{
    plant::{PASSWORD, Plant, SignedIn},
    trust::{endpoint, read_state, sign_in},
};

const SECOND_FACTOR: &str = "/session/second-factor";
const REFUSED: StatusCode = StatusCode::BadIdentityTokenRejected;

/// A plant whose OPC UA server trusts the certificate of the tests' client.
struct Fixture {
    plant: Plant,
    url: String,
    folder: TempDir,
}

impl Fixture {
    /// Starts a plant with operators of these names.
    async fn start(users: &[&str]) -> Self {
        let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
        for user in users {
            let body = json!({ "role": "OPERATOR", "password": password(user) });
            plant.put(&format!("/users/{user}"), body).await;
        }
        let (url, folder) = (endpoint(&plant).await, tempfile::tempdir().expect("a folder"));
        let fixture = Self { plant, url, folder };
        let refused = sign_in(&fixture.url, fixture.pki(), "engineer", PASSWORD).await.err();
        assert_eq!(refused, Some(StatusCode::BadSecurityChecksFailed), "it waits for approval");
        let waiting = fixture.plant.get("/client-certificates").await["items"][0].clone();
        let thumbprint = waiting["thumbprint"].as_str().expect("a thumbprint");
        let path = format!("/client-certificates/{thumbprint}");
        fixture.plant.put(&path, json!({ "isTrusted": true })).await;
        fixture
    }

    fn pki(&self) -> PathBuf {
        self.folder.path().join("client")
    }

    /// Signs a user in at the twin with this text in the field of the password.
    async fn at_twin(&self, user: &str, field: &str) -> Result<(), StatusCode> {
        let session = sign_in(&self.url, self.pki(), user, field).await?;
        read_state(&session).await?;
        session.disconnect().await.map_err(|error| error.status())
    }

    /// Signs a user in at the pages; status and problem of the answer.
    async fn at_pages(&self, user: &str, password: &str, code: Option<&str>) -> (u16, Value) {
        let mut body = json!({ "userName": user, "password": password });
        if let Some(code) = code {
            body["code"] = code.into();
        }
        let pages = self.plant.signed_out();
        let (status, problem) =
            pages.status(Method::POST, "/session", Some(body.to_string())).await;
        (status.as_u16(), problem)
    }

    /// Turns codes of an app on for a user; their secret. The present code is used up.
    async fn turn_codes_on(&self, user: &str) -> String {
        let password = password(user);
        let own: SignedIn = self.plant.signed_in(user, &password).await.expect("a session");
        let offer = own.post(SECOND_FACTOR, json!({ "password": password })).await;
        let secret = offer["secret"].as_str().expect("a secret").to_owned();
        own.put(SECOND_FACTOR, json!({ "code": code(&secret, 0) })).await;
        secret
    }
}

fn password(user: &str) -> String {
    format!("{user} at machine 7")
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_code_of_the_app_follows_the_password_at_the_twin_and_is_good_once_everywhere() {
    let fixture = Fixture::start(&["otto", "eva", "pia"]).await;
    let with = |user: &str, code: &str| format!("{}{code}", password(user));
    assert_eq!(fixture.at_twin("otto", &password("otto")).await, Ok(()), "no second factor yet");

    let secret = fixture.turn_codes_on("otto").await;
    assert_eq!(fixture.at_twin("otto", &password("otto")).await, Err(REFUSED), "without a code");
    assert_eq!(fixture.at_twin("otto", &with("otto", "000000")).await, Err(REFUSED));
    let next = code(&secret, 1);
    assert_eq!(fixture.at_twin("otto", &with("otto", &next)).await, Ok(()));
    assert_eq!(fixture.at_twin("otto", &with("otto", &next)).await, Err(REFUSED), "a replay");
    let (status, _) = fixture.at_pages("otto", &password("otto"), Some(&next)).await;
    assert_eq!(status, 401, "nor is it good at the pages");

    let secret = fixture.turn_codes_on("eva").await;
    let next = code(&secret, 1);
    assert_eq!(fixture.at_pages("eva", &password("eva"), Some(&next)).await.0, 200);
    assert_eq!(
        fixture.at_twin("eva", &with("eva", &next)).await,
        Err(REFUSED),
        "used at the pages"
    );

    let passkey = StoredPasskey {
        passkey_id: "1".to_owned(),
        name: "a key".to_owned(),
        credential_id: vec![1; 16],
        user_handle: [1; 16],
        transports: 0,
        static_state: Vec::new(),
        dynamic_state: [0; 7],
        created_at: SystemTime::UNIX_EPOCH,
        last_used_at: None,
    };
    let mut store = Store::connect(&fixture.plant.data_directory()).await.expect("a store");
    assert!(store.passkeys().add("pia", &passkey, None).await.expect("stored"));
    for field in [password("pia"), with("pia", "000000")] {
        assert_eq!(fixture.at_twin("pia", &field).await, Err(REFUSED), "a passkey alone");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn guesses_at_the_twin_and_at_the_pages_count_together() {
    let fixture = Fixture::start(&["otto", "eva"]).await;
    for attempt in 0..5 {
        assert_eq!(fixture.at_twin("otto", "a guess").await, Err(REFUSED), "{attempt}");
    }
    let mut guesses = 0;
    while fixture.at_pages("otto", "a guess", None).await.0 != 429 {
        guesses += 1;
        assert!(guesses < 4, "the guesses at the twin were the free ones");
    }
    assert_eq!(fixture.at_pages("eva", &password("eva"), None).await.0, 200, "others may");

    // Guesses at the pages, until the next wait is longer than a sign-in takes.
    let mut retry_after = 0;
    while retry_after < 8 {
        let (status, problem) = fixture.at_pages("otto", "a guess", None).await;
        assert!([401, 429].contains(&status), "{status} {problem}");
        retry_after = problem["retryAfterSeconds"].as_u64().unwrap_or(0);
        tokio::time::sleep(std::time::Duration::from_millis(50)).await;
    }
    assert_eq!(fixture.at_twin("otto", &password("otto")).await, Err(REFUSED), "it has to wait");
    assert_eq!(fixture.at_twin("eva", &password("eva")).await, Ok(()));
}
