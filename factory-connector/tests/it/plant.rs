//! A connector with machines and one operation network, and a client of its API.

use std::{path::PathBuf, time::Duration};

use asi_model::{FactoryId, messages::OperationNetworkMessage, pubsub::json::Encoding};
use connector_state::{
    ConnectorState, IdSource, StateConfig,
    transaction::{self, DeliveryState},
    use_cases::revise::receive_network,
};
use daemon::{
    Confidential,
    lifecycle::Lifecycle,
    sealing::{Sealer, SealingConfig},
};
use factory_connector::{
    clock::now,
    config::ConnectorConfig,
    ledger_key::{self, LEDGER_KEY_FILE},
    passwords, service,
    store::{Enrolment, SecretHolder, Store},
};
use mapping_engine::{ScriptConfig, ScriptRuntime};
use reqwest::{Method, StatusCode};
use serde_json::{Value, json};
use simulator::{MachineConfig, MachineKind, Simulator, SimulatorHandle};
use tempfile::TempDir;
use testkit::{ApiClient, Event};
use tokio::sync::mpsc;
use tokio_util::sync::{CancellationToken, DropGuard};

const FACTORY: &str = "FOR_MUC";
pub const PASSWORD: &str = "a long password for tests";
/// Address of the pages for browsers: passkeys need a domain.
pub const PAGES: &str = "http://localhost:8090";
/// Longest time that an answer, or a state that is waited for, may take.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running connector; it stops when this is dropped.
pub struct Plant {
    engineer: SignedIn,
    lifecycle: Lifecycle,
    pub machines: SimulatorHandle,
    directory: TempDir,
    _machines_stop: DropGuard,
}

impl Drop for Plant {
    fn drop(&mut self) {
        self.lifecycle.stop();
    }
}

/// Without further ado a plant's API is the engineer's.
impl std::ops::Deref for Plant {
    type Target = SignedIn;
    fn deref(&self) -> &SignedIn {
        &self.engineer
    }
}

/// A person's session.
pub struct SignedIn {
    client: ApiClient,
}

/// The network with one operation and these fields requested about it.
pub fn network(fields: Value) -> Value {
    json!({ "messageId": "m1", "factoryId": FACTORY, "collaborationId": "frame-order", "revision": 1,
        "operationNetwork": { "operationNetworkId": "frame", "operationList": [ {
            "operationId": "MakeFrame", "operationType": "PRODUCTION", "name": "Make frame", "productId": "FRAME-A",
            "equipmentRequirementList": [ { "equipmentRequirementId": "r1", "equipmentType": "MILL", "assetId": "Mill1" } ],
            "dynamicDataRequestList": [ { "dynamicDataRequestId": "Req", "requesterId": "acme",
                "recipientList": ["acme"], "purpose": "Plan the assembly", "updateFrequency": 1,
                "updateFrequencyUnit": "SECOND",
                "reportDataFormat": { "reportName": "Progress", "reportFieldList": fields } } ] } ] } })
}

/// The path of a field of [`network`].
pub fn field(name: &str) -> String {
    format!("/fields/frame/MakeFrame/Req/{name}")
}

impl Plant {
    /// A plant with a milling cell `Mill1` and a conveyor `Belt1`, both connected.
    pub async fn start(fields: Value) -> Self {
        Self::start_with(fields, MachineConfig::new("Mill1", MachineKind::MillingCell)).await
    }

    /// A plant whose milling cell is configured so.
    pub async fn start_with(fields: Value, mill: MachineConfig) -> Self {
        rustls::crypto::ring::default_provider().install_default().ok();
        let directory = tempfile::tempdir().expect("a folder");
        enrol(&directory, fields).await;
        let machines = vec![mill, MachineConfig::new("Belt1", MachineKind::Conveyor)];
        let mut config = simulator::Config::of(machines);
        config.pki_directory = directory.path().join("machines");
        config.update_interval_ms = 50;
        let (simulator, machines) = Simulator::new(config).await.expect("the machines start");
        let machines_stop = CancellationToken::new();
        tokio::spawn(simulator.run(machines_stop.clone()));

        let lifecycle = Lifecycle::new();
        let mut config = ConnectorConfig {
            data_directory: directory.path().join("data"),
            ..ConnectorConfig::default()
        };
        config.web.listen = "127.0.0.1:0".parse().expect("an address");
        config.web.public_url = Some(PAGES.to_owned());
        // One person of a test does what several do in a plant.
        config.web.share_per_person.downloads = 8.try_into().expect("not zero");
        config.twin.listen = "127.0.0.1:0".parse().expect("an address");
        script_worker(&mut config.mapping.script);
        config.admin.password = Some(Confidential::from(PASSWORD.to_owned()));
        let handle = service::start(config, &lifecycle).await.expect("the connector starts");
        let origin = format!("http://{}", handle.web_address);
        let engineer =
            SignedIn::new(origin, "engineer", PASSWORD).await.expect("the engineer comes in");
        let plant = Self {
            engineer,
            lifecycle,
            machines,
            directory,
            _machines_stop: machines_stop.drop_guard(),
        };
        for name in ["Mill1", "Belt1"] {
            let endpoint =
                plant.machines.machine(name).expect("a machine").endpoint_url().to_owned();
            let source = json!({ "sourceId": name, "endpointUrl": endpoint, "security": { "choice": "none" } });
            plant.post("/sources", source).await;
        }
        plant
            .until("both machines are connected", "/sources", |sources| {
                let items = sources["items"].as_array().expect("a page");
                items.len() == 2 && items.iter().all(|source| source["state"] == "connected")
            })
            .await;
        plant
    }

    /// Returns the connector's data directory.
    pub fn data_directory(&self) -> PathBuf {
        self.directory.path().join("data")
    }

    /// A machine's variable as text.
    pub fn node(&self, machine: &str, key: &str) -> String {
        let machine = self.machines.machine(machine).expect("a machine");
        machine.node_id(key).expect("a variable").to_string()
    }
}

impl SignedIn {
    /// Signs in; the error is the body of the refusal.
    pub async fn new(origin: String, user_name: &str, password: &str) -> Result<Self, String> {
        let mut client = ApiClient::new(origin, PATIENCE).expect("a client");
        let answer = client.sign_in(user_name, password).await.expect("an answer");
        if answer.status.is_success() { Ok(Self { client }) } else { Err(answer.text) }
    }

    /// Signs another user in; the error is the body of the refusal.
    pub async fn signed_in(&self, user_name: &str, password: &str) -> Result<Self, String> {
        Self::new(self.client.origin().to_owned(), user_name, password).await
    }

    /// A client of the same API without a session.
    pub fn signed_out(&self) -> Self {
        Self { client: ApiClient::new(self.client.origin(), PATIENCE).expect("a client") }
    }

    pub async fn get(&self, path: &str) -> Value {
        self.expect(Method::GET, path, None).await
    }

    pub async fn post(&self, path: &str, body: Value) -> Value {
        self.expect(Method::POST, path, Some(body.to_string())).await
    }

    pub async fn put(&self, path: &str, body: Value) -> Value {
        self.expect(Method::PUT, path, Some(body.to_string())).await
    }

    async fn expect(&self, method: Method, path: &str, body: Option<String>) -> Value {
        let (status, text) = self.call(method.clone(), path, body).await;
        assert!(status.is_success(), "{method} {path}: {status} {text}");
        serde_json::from_str(&text).unwrap_or(Value::String(text))
    }

    /// Any call; the answer as text.
    pub async fn call(
        &self,
        method: Method,
        path: &str,
        body: Option<String>,
    ) -> (StatusCode, String) {
        Self::answer(self.request(method, path, body)).await
    }

    /// Any call; its status, and the problem where it failed. A stream of events is not awaited.
    pub async fn status(
        &self,
        method: Method,
        path: &str,
        body: Option<String>,
    ) -> (StatusCode, Value) {
        let answer = self.request(method, path, body).send().await.expect("an answer");
        let status = answer.status();
        if status.is_success() {
            return (status, Value::Null);
        }
        (status, answer.json().await.unwrap_or_default())
    }

    /// A call whose answer is not read yet.
    pub async fn unread(&self, path: &str) -> reqwest::Response {
        self.request(Method::GET, path, None).send().await.expect("the answer's beginning")
    }

    /// A call that holds for this version only.
    pub async fn call_if_match(
        &self,
        method: Method,
        path: &str,
        version: &str,
        body: Value,
    ) -> (StatusCode, String) {
        Self::answer(self.request(method, path, Some(body.to_string())).header("if-match", version))
            .await
    }

    /// Calls an operation that adds only: it is refused where there is one already.
    pub async fn call_if_new(&self, path: &str, body: Value) -> (StatusCode, String) {
        let request = self.request(Method::PUT, path, Some(body.to_string()));
        Self::answer(request.header("if-none-match", "*")).await
    }

    fn request(&self, method: Method, path: &str, body: Option<String>) -> reqwest::RequestBuilder {
        let request = self.client.request(method, &format!("/api/v1{path}"));
        match body {
            Some(body) => request.header("content-type", "application/json").body(body),
            None => request,
        }
    }

    async fn answer(request: reqwest::RequestBuilder) -> (StatusCode, String) {
        let answer = request.send().await.expect("an answer");
        (answer.status(), answer.text().await.expect("a text"))
    }

    /// The live events after that with an id, or from now on, as they come.
    pub async fn events(&self, last_event_id: Option<&str>) -> mpsc::UnboundedReceiver<Event> {
        let stream = self.client.events("/api/v1/events", last_event_id).await;
        let mut stream = stream.expect("the stream opens");
        let (sender, receiver) = mpsc::unbounded_channel();
        tokio::spawn(async move {
            while let Ok(Some(event)) = stream.next().await {
                if sender.send(event).is_err() {
                    return;
                }
            }
        });
        receiver
    }

    /// Imports a file or a table; the outcome or the problem.
    pub async fn import(&self, form: &str, text: &str, is_dry_run: bool) -> Result<Value, Value> {
        let kind = if form == "csv" { "text/csv" } else { "application/json" };
        let answer = self
            .client
            .request(Method::POST, &format!("/api/v1/mappings/import?dryRun={is_dry_run}"))
            .header("content-type", kind)
            .body(text.to_owned())
            .send()
            .await
            .expect("an answer");
        let is_taken = answer.status().is_success();
        let json: Value = answer.json().await.expect("JSON");
        if is_taken { Ok(json) } else { Err(json) }
    }

    /// Decides a field with the source MAPPING.
    pub async fn map(&self, name: &str, mapping: Value) -> Value {
        let body = json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "mapping": mapping,
            "disclosure": {} });
        self.put(&format!("{}/decision", field(name)), body).await
    }

    /// Asks until the answer is as wanted.
    pub async fn until(&self, what: &str, path: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        let look = || async {
            let answer = self.get(path).await;
            if is_so(&answer) { Ok(answer) } else { Err(answer.to_string()) }
        };
        match testkit::wait::eventually(what, PATIENCE, look).await {
            Ok(answer) => answer,
            Err(missed) => panic!("{missed}"),
        }
    }
}

/// Sets the worker under test, as the workspace builds it: `script-deno` with the Deno that `SCRIPT_DENO` names, or
/// `script-quickjs`.
fn script_worker(config: &mut ScriptConfig) {
    if let Some(deno) = std::env::var_os("SCRIPT_DENO") {
        config.engine = ScriptRuntime::Deno;
        config.deno_path = Some(deno.into());
    }
    let program = std::env::current_exe().expect("a program");
    let name = config.engine.file_name();
    let path = program.ancestors().nth(2).expect("tests lie below the binaries").join(name);
    assert!(path.exists(), "build the worker first: cargo build -p {name}");
    config.worker_path = Some(path);
}

/// Fills the store as an enrolled connector's that has received the network.
pub async fn enrol(directory: &TempDir, fields: Value) {
    let data = directory.path().join("data");
    daemon::data_directory::create(&data, false).expect("a folder");
    let factory_id: FactoryId = FACTORY.parse().expect("an id");
    let mut session = Store::connect(&data).await.expect("a store");
    let sealer = Sealer::new(&SealingConfig::default(), &data);
    let sealed = passwords::seal(&sealer, &SecretHolder::Broker, "none").expect("sealed");
    let enrolment = Enrolment {
        factory_id: FACTORY.to_owned(),
        broker_url: "amqp://127.0.0.1:1".to_owned(),
        profile: r#""embedded""#.to_owned(),
        user_name: FACTORY.to_owned(),
        sealed_password: Some(sealed),
        root_certificate_pem: None,
    };
    session.enrolments().put(&enrolment, now()).await.expect("enrolled");
    drop(session);
    let mut store = Store::open(&data, &factory_id, now()).await.expect("opened");
    let config = StateConfig { factory_id, encoding: Encoding::Digicor };
    let snapshot = store.load().await.expect("loaded");
    let ids = IdSource::new([0; 32]);
    let (mut state, mut pending) =
        ConnectorState::load(config, snapshot, ids, false, now()).expect("loaded");
    let message: OperationNetworkMessage =
        serde_json::from_value(network(fields)).expect("a network");
    let raw = serde_json::to_string(&message).expect("serialises");
    pending.merge(receive_network(&mut state, message, raw, now()));
    let key = ledger_key::open(&data.join(LEDGER_KEY_FILE)).expect("a key");
    let (writes, _) = transaction::refresh(&mut state, pending)
        .take_back(&mut state, DeliveryState::default(), &key, now())
        .report(&mut state, now(), || [0; ledger::SALT_BYTES])
        .sign(&mut state, &key);
    store.commit(writes).await.expect("stored");
    store.close().await;
}
