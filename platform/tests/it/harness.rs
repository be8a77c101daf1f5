//! A whole platform on free ports, in a folder of its own, and clients of its API.

use std::{
    future::Future,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use access_log::{AccessKind, AccessLogKey, AgentKind};
use asi_model::DateTime;
use async_trait::async_trait;
use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use daemon::lifecycle::Lifecycle;
use platform::{
    accesses::{AccessRecorder, AccessStorage, NotRecorded, Reader, Reading, Withheld},
    clock::Clock,
    config::PlatformConfig,
    service::{Platform, PlatformHandle},
};
use reqwest::Method;
use serde_json::{Value, json};
use testkit::{ApiClient, Event, EventStream};

pub const ADMIN: &str = "admin";
pub const PASSWORD: &str = "correct horse battery";
const PATIENCE: Duration = Duration::from_secs(20);
/// Longest time that an answer may take.
const ANSWER_MAX: Duration = Duration::from_secs(60);

/// A platform that can be stopped and started again on the same data.
pub struct World {
    folder: tempfile::TempDir,
    running: Option<(Lifecycle, PlatformHandle)>,
    /// True for a broker in the process of the test.
    in_process: bool,
    /// Further sections of the configuration.
    sections: &'static str,
    /// Further keys of the section for the pages.
    web_keys: &'static str,
}

/// Address of the pages for browsers in [`World::start_for_browsers`].
pub const PAGES: &str = "http://localhost:8080";

impl World {
    pub async fn start() -> Self {
        Self::start_with(true, "", "").await
    }

    /// Starts with further sections of the configuration.
    pub async fn start_configured(sections: &'static str) -> Self {
        Self::start_with(true, "", sections).await
    }

    /// Starts with a domain in the address of the pages, which passkeys need.
    pub async fn start_for_browsers() -> Self {
        Self::start_with(true, "public_url = \"http://localhost:8080\"\n", "").await
    }

    /// Starts as behind a proxy that speaks TLS.
    pub async fn start_behind_tls() -> Self {
        Self::start_with(true, "public_url = \"https://verbund.example\"\n", "").await
    }

    /// Starts with a broker in a process of its own, as the platform has it by default.
    pub async fn start_with_broker_process() -> Self {
        Self::start_with(false, "", "").await
    }

    async fn start_with(in_process: bool, web_keys: &'static str, sections: &'static str) -> Self {
        drop(rustls::crypto::ring::default_provider().install_default());
        let folder = tempfile::tempdir().expect("a folder");
        let mut world = Self { folder, running: None, in_process, web_keys, sections };
        world.open().await;
        world
    }

    async fn open(&mut self) {
        let lifecycle = Lifecycle::new();
        let program = Path::new(env!("CARGO_BIN_EXE_platform"));
        let opened = Platform::open(self.config(), Clock::system(), &lifecycle, program).await;
        let (platform, handle) = opened.expect("it opens");
        platform.start(&lifecycle);
        self.running = Some((lifecycle, handle));
    }

    fn config(&self) -> PlatformConfig {
        let text = format!(
            "data_directory = {:?}\n[web]\nlisten = \"127.0.0.1:0\"\n{}[broker]\nlisten = \"127.0.0.1:0\"\n\
             in_process = {}\n[admin]\npassword = \"{PASSWORD}\"\n[receipts]\ninterval_ms = 20\n[parts]\nresend_after_ms = 300\n\
             [leases]\nsilence_ms = 5000\n{}",
            self.folder.path().join("data"),
            self.web_keys,
            self.in_process,
            self.sections
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

    /// The platform's database, for tests that change it from outside.
    pub fn database(&self) -> PathBuf {
        self.config().database_path()
    }

    /// Bytes of the embedded broker's database, its log included.
    pub fn broker_bytes(&self) -> u64 {
        let database = |end: &str| self.folder.path().join(format!("data/broker.sqlite{end}"));
        let bytes = |end| std::fs::metadata(database(end)).map_or(0, |file| file.len());
        bytes("") + bytes("-wal")
    }

    pub fn url(&self) -> String {
        format!("http://{}", self.handle().web_address)
    }

    /// A client that nobody has signed in.
    pub fn anonymous(&self) -> Api {
        Api { client: ApiClient::new(self.url(), ANSWER_MAX).expect("a client") }
    }

    pub async fn sign_in(&self, user: &str, password: &str) -> Api {
        let mut api = self.anonymous();
        let answer = api.client.sign_in(user, password).await.expect("an answer");
        Answer::from(answer).expect_ok();
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

/// Opens withheld values without a record, which only tests do.
pub async fn opened<T>(withheld: Withheld<T>) -> T {
    let (storage, clock) = (Arc::new(NoStorage), Clock::system());
    let accesses = AccessRecorder::new(storage, AccessLogKey::from_secret(&[1; 32]), clock);
    accesses.disclose(Some(&reader("test")), AccessKind::Looked, withheld).await.expect("opened")
}

/// A person of the organisation `a`.
pub fn reader(name: &str) -> Reader {
    let organisation_id = "a".parse().expect("an id");
    Reader { organisation_id, kind: AgentKind::User, name: name.to_owned(), role: None }
}

struct NoStorage;

#[async_trait]
impl AccessStorage for NoStorage {
    async fn append(&self, _: &[Reading], _: DateTime) -> Result<(), NotRecorded> {
        Ok(())
    }

    async fn sign_checkpoints(&self, _: &AccessLogKey) -> Result<(), NotRecorded> {
        Ok(())
    }
}

/// A client of the API.
pub struct Api {
    pub client: ApiClient,
}

/// An answer: status and body.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub body: Value,
}

impl From<testkit::Answer> for Answer {
    fn from(answer: testkit::Answer) -> Self {
        Self { status: answer.status.as_u16(), body: answer.json() }
    }
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
        self.call(Method::GET, path, None).await
    }

    pub async fn post(&self, path: &str, body: Value) -> Answer {
        self.call(Method::POST, path, Some(body)).await
    }

    pub async fn put(&self, path: &str, body: Value) -> Answer {
        self.call(Method::PUT, path, Some(body)).await
    }

    pub async fn delete(&self, path: &str) -> Answer {
        self.call(Method::DELETE, path, None).await
    }

    pub async fn call(&self, method: Method, path: &str, body: Option<Value>) -> Answer {
        let answer = self.client.call(method, &format!("/api/v1{path}"), body.as_ref()).await;
        answer.expect("an answer").into()
    }

    /// The live stream, from an event on.
    pub async fn live(&self, last_event_id: Option<&str>) -> Live {
        let stream = self.client.events("/api/v1/live", last_event_id).await;
        Live { stream: stream.expect("the stream opens") }
    }
}

/// Server-sent events as they come.
pub struct Live {
    stream: EventStream,
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
            let event = self.event().await.expect("an event in time");
            if let Some(id) = event.id {
                return (id, event.name, event.data);
            }
        }
    }

    /// The next event; none where it did not come in time.
    pub async fn event(&mut self) -> Option<Event> {
        let event = tokio::time::timeout(PATIENCE, self.stream.next()).await.ok()?;
        Some(event.expect("no error").expect("the stream goes on"))
    }
}

/// Form of an id of a live event: the mark of the start, and as many characters as each id of it has.
/// What they say is sealed, and differs from id to id.
pub fn event_form(id: &Value) -> String {
    let id = id.as_str().expect("an id");
    let (mark, sealed) = id.split_once('-').expect("a mark");
    assert!(mark.len() == 16 && mark.bytes().all(|byte| byte.is_ascii_hexdigit()), "{id}");
    let sealed = URL_SAFE_NO_PAD.decode(sealed).expect("base64");
    format!("{mark}-[{} bytes]", sealed.len())
}

/// Polls until the condition yields a value.
pub async fn eventually<T, F>(what: &str, condition: impl FnMut() -> F) -> T
where
    F: Future<Output = Result<T, String>>,
{
    match testkit::wait::eventually(what, PATIENCE, condition).await {
        Ok(value) => value,
        Err(missed) => panic!("{missed}"),
    }
}
