//! A whole platform on free ports, in a folder of its own, and clients of its API.

use std::{
    future::Future,
    time::{Duration, Instant},
};

use daemon::lifecycle::Lifecycle;
use platform::{
    clock::Clock,
    config::PlatformConfig,
    service::{Platform, PlatformHandle},
};
use serde_json::{Value, json};

pub const ADMIN: &str = "admin";
pub const PASSWORD: &str = "correct horse battery";
const PATIENCE: Duration = Duration::from_secs(20);

/// A platform that can be stopped and started again on the same data.
pub struct World {
    folder: tempfile::TempDir,
    running: Option<(Lifecycle, PlatformHandle)>,
}

impl World {
    pub async fn start() -> Self {
        drop(rustls::crypto::ring::default_provider().install_default());
        let mut world = Self { folder: tempfile::tempdir().expect("a folder"), running: None };
        world.open().await;
        world
    }

    async fn open(&mut self) {
        let lifecycle = Lifecycle::new();
        let (platform, handle) =
            Platform::open(self.config(), Clock::system(), &lifecycle).await.expect("it opens");
        platform.start(&lifecycle);
        self.running = Some((lifecycle, handle));
    }

    fn config(&self) -> PlatformConfig {
        let text = format!(
            "data_directory = {:?}\n[web]\nlisten = \"127.0.0.1:0\"\n[broker]\nlisten = \"127.0.0.1:0\"\n\
             [admin]\npassword = \"{PASSWORD}\"\n[receipts]\ninterval_ms = 20\n[parts]\nresend_after_ms = 300\n\
             [leases]\nsilence_ms = 5000\n",
            self.folder.path()
        );
        daemon::configuration::parse(None, &text, "NOTHING", []).expect("valid")
    }

    /// Stops in order and starts again on the same data.
    pub async fn restart(&mut self) {
        self.stop().await;
        self.open().await;
    }

    pub async fn stop(&mut self) {
        if let Some((lifecycle, handle)) = self.running.take() {
            lifecycle.stop();
            tokio::time::timeout(PATIENCE, lifecycle.finished()).await.expect("all tasks end");
            handle.application.store.close().await;
        }
    }

    pub fn handle(&self) -> &PlatformHandle {
        &self.running.as_ref().expect("it runs").1
    }

    pub fn url(&self) -> String {
        format!("http://{}", self.handle().web_address)
    }

    /// A client that nobody has signed in.
    pub fn anonymous(&self) -> Api {
        let client = reqwest::Client::builder().cookie_store(true).build().expect("a client");
        Api { client, base: self.url(), csrf: None }
    }

    pub async fn sign_in(&self, user: &str, password: &str) -> Api {
        let mut api = self.anonymous();
        let session = api
            .post("/session", json!({ "userName": user, "password": password }))
            .await
            .expect_ok();
        api.csrf = session["csrfToken"].as_str().map(str::to_owned);
        api
    }

    pub async fn admin(&self) -> Api {
        self.sign_in(ADMIN, PASSWORD).await
    }
}

impl Drop for World {
    fn drop(&mut self) {
        if let Some((lifecycle, _)) = &self.running {
            lifecycle.stop();
        }
    }
}

/// A client of the API.
pub struct Api {
    pub client: reqwest::Client,
    base: String,
    csrf: Option<String>,
}

/// An answer: status and body.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub body: Value,
}

impl Answer {
    #[track_caller]
    pub fn expect_ok(self) -> Value {
        assert!((200..300).contains(&self.status), "{self:?}");
        self.body
    }

    #[track_caller]
    pub fn expect_problem(self, status: u16, code: &str) -> Value {
        assert_eq!((self.status, &self.body["code"]), (status, &json!(code)), "{self:?}");
        self.body
    }
}

impl Api {
    pub async fn get(&self, path: &str) -> Answer {
        self.call(reqwest::Method::GET, path, None).await
    }

    pub async fn post(&self, path: &str, body: Value) -> Answer {
        self.call(reqwest::Method::POST, path, Some(body)).await
    }

    pub async fn put(&self, path: &str, body: Value) -> Answer {
        self.call(reqwest::Method::PUT, path, Some(body)).await
    }

    pub async fn delete(&self, path: &str) -> Answer {
        self.call(reqwest::Method::DELETE, path, None).await
    }

    pub async fn call(&self, method: reqwest::Method, path: &str, body: Option<Value>) -> Answer {
        let mut request = self.client.request(method, format!("{}/api/v1{path}", self.base));
        if let Some(token) = &self.csrf {
            request = request.header("x-csrf-token", token);
        }
        if let Some(body) = body {
            request = request.json(&body);
        }
        let response = request.send().await.expect("an answer");
        let status = response.status().as_u16();
        let bytes = response.bytes().await.expect("a body");
        Answer { status, body: serde_json::from_slice(&bytes).unwrap_or(Value::Null) }
    }

    /// The live stream, from an event on.
    pub async fn live(&self, last_event_id: Option<&str>) -> Live {
        let mut request = self.client.get(format!("{}/api/v1/live", self.base));
        if let Some(id) = last_event_id {
            request = request.header("last-event-id", id);
        }
        let response = request.send().await.expect("an answer");
        assert_eq!(response.status(), 200);
        Live { response, text: String::new() }
    }
}

/// Server-sent events as they come.
pub struct Live {
    response: reqwest::Response,
    text: String,
}

impl Live {
    /// The next event with this name: its id and data.
    pub async fn next(&mut self, name: &str) -> (String, Value) {
        loop {
            let (id, found, data) = self.any().await;
            if found == name {
                return (id, data);
            }
        }
    }

    /// The next event: id, name and data.
    pub async fn any(&mut self) -> (String, String, Value) {
        loop {
            if let Some(end) = self.text.find("\n\n") {
                let event: String = self.text.drain(..end + 2).collect();
                let line = |key: &str| {
                    event
                        .lines()
                        .find_map(|line| line.strip_prefix(key))
                        .map(|rest| rest.trim().to_owned())
                };
                if let (Some(id), Some(name), Some(data)) =
                    (line("id:"), line("event:"), line("data:"))
                {
                    return (id, name, serde_json::from_str(&data).expect("JSON"));
                }
                continue;
            }
            let chunk = tokio::time::timeout(PATIENCE, self.response.chunk())
                .await
                .expect("an event in time");
            let chunk = chunk.expect("no error").expect("the stream goes on");
            self.text.push_str(std::str::from_utf8(&chunk).expect("UTF-8"));
        }
    }
}

/// Polls until the condition yields a value.
pub async fn eventually<T, F>(what: &str, mut condition: impl FnMut() -> F) -> T
where
    F: Future<Output = Result<T, String>>,
{
    let deadline = Instant::now() + PATIENCE;
    loop {
        let seen = match condition().await {
            Ok(value) => return value,
            Err(seen) => seen,
        };
        assert!(Instant::now() < deadline, "{what}: last seen {seen}");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}
