//! Other people's servers: asyncua and node-opcua, killed and restarted with other ids, protected
//! and not.

use std::{
    path::{Path, PathBuf},
    process::Stdio,
    time::{Duration, Instant},
};

use asi_model::{
    DataValue, NodeId, Scalar, StatusCode, Variant,
    values::{ExtensionBody, LocalizedText, StructureValue},
};
use shop_floor::{
    EventSelection, EventValue, Identity, InputKey, MonitorOptions, SecurityChoice, SourceConfig,
    SourceId, SourceProblemKind, TrustState,
};
use tempfile::TempDir;
use tokio::{
    io::{AsyncBufReadExt as _, AsyncWriteExt as _, BufReader},
    process::{Child, ChildStdin, Command},
    sync::OnceCell,
};

use crate::{
    events::{field, selection},
    support::{TestShopFloor, until, within},
};

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Stack {
    Asyncua,
    NodeOpcua,
}

impl Stack {
    fn namespace(self) -> &'static str {
        match self {
            Self::Asyncua => "urn:verbund:test:asyncua",
            Self::NodeOpcua => "urn:verbund:test:node-opcua",
        }
    }
}

/// A server of another stack in a process of its own, killed when dropped.
pub struct Peer {
    stack: Stack,
    pub port: u16,
    directory: TempDir,
    is_protected: bool,
    running: Option<(Child, ChildStdin)>,
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Installs the peers if they are not there.
async fn install() {
    static INSTALLED: OnceCell<()> = OnceCell::const_new();
    INSTALLED
        .get_or_init(|| async {
            let installed =
                Command::new(repository().join("tests/foreign/setup.sh")).status().await;
            assert!(
                installed.expect("the script runs").success(),
                "the foreign peers could not be installed"
            );
        })
        .await;
}

impl Peer {
    pub async fn start(stack: Stack, is_protected: bool) -> Self {
        install().await;
        let [port] = free_ports::reserve().expect("a free port");
        let directory = tempfile::tempdir().expect("a folder for certificates");
        let mut peer = Self { stack, port, directory, is_protected, running: None };
        peer.restart(0, 0).await;
        peer
    }

    /// Kills the server, if it runs, and starts it with other indexes and ids; it is ready when
    /// this returns.
    async fn restart(&mut self, before: u32, renumber: u32) {
        self.kill().await;
        let scripts = repository().join("shop-floor/tests/foreign");
        let mut command = match self.stack {
            Stack::Asyncua => {
                let mut command =
                    Command::new(repository().join("target/foreign/python/bin/python"));
                command.arg(scripts.join("asyncua_server.py"));
                if self.is_protected {
                    command.arg("--protected").arg(self.directory.path());
                }
                command
            }
            Stack::NodeOpcua => {
                let mut command = Command::new("node");
                command.env("NODE_PATH", repository().join("tests/foreign/node_modules"));
                command
                    .arg(scripts.join("node_opcua_server.js"))
                    .arg("--pki")
                    .arg(self.directory.path());
                if self.is_protected {
                    command.arg("--protected");
                }
                command
            }
        };
        command
            .args(["--port", &self.port.to_string()])
            .args(["--before", &before.to_string(), "--renumber", &renumber.to_string()])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .kill_on_drop(true);
        let mut child = command.spawn().expect("the server starts");
        let mut lines = BufReader::new(child.stdout.take().expect("piped")).lines();
        let ready = async {
            while let Some(line) = lines.next_line().await.expect("readable") {
                if line == "ready" {
                    return;
                }
            }
            panic!("the server ended before it was ready");
        };
        tokio::time::timeout(Duration::from_secs(60), ready).await.expect("ready in time");
        // Its output is read to the end: a server whose pipe is full would block.
        tokio::spawn(async move { while let Ok(Some(_)) = lines.next_line().await {} });
        let stdin = child.stdin.take().expect("piped");
        self.running = Some((child, stdin));
    }

    async fn kill(&mut self) {
        if let Some((mut child, _)) = self.running.take() {
            child.kill().await.expect("it can be killed");
        }
    }

    pub async fn set(&mut self, json: &str) {
        let (_, stdin) = self.running.as_mut().expect("running");
        stdin.write_all(format!("{json}\n").as_bytes()).await.expect("it listens");
        stdin.flush().await.expect("it listens");
    }

    /// The identity that a node had at first.
    pub fn node(&self, number: u32) -> NodeId {
        NodeId::numeric(self.stack.namespace(), 2000 + number)
    }

    pub fn source(&self) -> SourceConfig {
        let id = SourceId::new("machine").expect("valid");
        let mut source =
            SourceConfig::new(id, &format!("opc.tcp://127.0.0.1:{}/machine", self.port));
        if self.is_protected {
            source.identity =
                Identity::UserName { user_name: "connector".into(), password: "machine".into() };
        } else {
            source.security = SecurityChoice::None;
        }
        source
    }
}

const COUNTER: u64 = 1;
const TEMPERATURE: u64 = 2;
const TEXT: u64 = 3;
const POWER: u64 = 4;

fn structure(value: Option<DataValue>) -> Option<StructureValue> {
    match value?.value {
        Variant::Scalar(Scalar::ExtensionObject(object)) => match object.body {
            ExtensionBody::Structure(structure) => Some(structure),
            _ => None,
        },
        _ => None,
    }
}

fn monitor_all(floor: &TestShopFloor, source: &SourceId, peer: &Peer) {
    for input in [COUNTER, TEMPERATURE, TEXT, POWER] {
        floor.monitor(input, source, peer.node(u32::try_from(input).expect("small")));
    }
}

/// Returns the number of kills: that in `FOREIGN_KILLS` (`make foreign-kills`), else the usual one.
fn kills(usual: u32) -> u32 {
    std::env::var("FOREIGN_KILLS")
        .map_or(usual, |kills| kills.parse().expect("FOREIGN_KILLS is a number"))
}

/// Values, structures and types arrive, and after each of some kills all is live again within 5 s.
async fn is_a_good_source(stack: Stack, restarts: u32) {
    let mut peer = Peer::start(stack, false).await;
    let floor = TestShopFloor::start();
    let source = peer.source();
    let id = source.source_id.clone();
    floor.handle.put_source(source).expect("valid");
    floor.until_connected(&id).await;
    monitor_all(&floor, &id, &peer);
    until("all are live", || floor.status(&id).live == 4).await;
    peer.set(r#"{"counter": 7, "temperature": 21.25, "text": "running"}"#).await;
    let counter = floor.until_value(COUNTER, 7_i32).await;
    assert!(counter.source_timestamp.is_some());
    floor.until_value(TEMPERATURE, 21.25).await;
    floor.until_value(TEXT, "running").await;
    until("a decoded structure", || structure(floor.newest(POWER)).is_some()).await;
    let power = structure(floor.newest(POWER)).expect("it was just there");
    assert_eq!(power.fields["Watts"], Variant::from(812.5));

    let found = floor.handle.search(&id, "temper", 10).await.expect("search");
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].node_id, peer.node(2));
    assert_eq!(
        found[0].browse_path.as_ref().map(ToString::to_string).as_deref(),
        Some("Machine/Temperature")
    );
    until("all paths are learned", || floor.status(&id).findable == 4).await;

    for round in 1..=restarts {
        peer.kill().await;
        floor.until_status(COUNTER, StatusCode::BAD_NOT_CONNECTED).await;
        peer.restart(round % 3, round).await;
        let returned = Instant::now();
        let number = i32::try_from(round).expect("few rounds");
        peer.set(&format!(r#"{{"counter": {number}, "text": "round {round}"}}"#)).await;
        within(Duration::from_secs(5), "all are live again", || floor.status(&id).live == 4).await;
        floor.until_value(COUNTER, number).await;
        floor.until_value(TEXT, format!("round {round}").as_str()).await;
        assert!(returned.elapsed() < Duration::from_secs(5), "{:?}", returned.elapsed());
    }
    // No value of another node was ever taken for the counter's.
    let is_counter = |value: &DataValue| {
        value.value.is_null() || matches!(value.value, Variant::Scalar(Scalar::Int32(_)))
    };
    assert!(floor.heard(COUNTER).iter().all(is_counter));
}

/// While nobody was connected the server got other indexes and ids; what was kept with the mapping
/// finds the variable.
async fn is_found_by_the_path_that_was_kept(stack: Stack) {
    let mut peer = Peer::start(stack, false).await;
    let id = peer.source().source_id;
    let path = {
        let floor = TestShopFloor::start();
        floor.handle.put_source(peer.source()).expect("valid");
        floor.until_connected(&id).await;
        floor.handle.browse_path(&id, &peer.node(1)).await.expect("a path")
    };
    peer.restart(2, 5).await;
    let floor = TestShopFloor::start();
    floor.handle.put_source(peer.source()).expect("valid");
    let options = MonitorOptions { browse_path: Some(path), ..MonitorOptions::default() };
    floor
        .handle
        .monitor(InputKey(COUNTER), id.clone(), peer.node(1), options)
        .expect("a valid request");
    peer.set(r#"{"counter": 41}"#).await;
    floor.until_value(COUNTER, 41_i32).await;
    assert!(floor.heard(COUNTER).iter().all(|value| {
        value.value.is_null() || matches!(value.value, Variant::Scalar(Scalar::Int32(_)))
    }));
}

#[tokio::test]
async fn asyncua_variables_are_found_by_paths_kept_from_before() {
    is_found_by_the_path_that_was_kept(Stack::Asyncua).await;
}

#[tokio::test]
async fn node_opcua_variables_are_found_by_paths_kept_from_before() {
    is_found_by_the_path_that_was_kept(Stack::NodeOpcua).await;
}

async fn is_a_good_protected_source(stack: Stack) {
    let mut peer = Peer::start(stack, true).await;
    let floor = TestShopFloor::start();
    let source = peer.source();
    let id = source.source_id.clone();
    floor.handle.put_source(source).expect("valid");
    let kind = SourceProblemKind::ServerCertificateUntrusted;
    until("the certificate is shown", || {
        floor.status(&id).problem.is_some_and(|problem| problem.kind == kind)
    })
    .await;
    let shown = floor.handle.certificates().await.expect("certificates");
    floor.handle.set_trust(&shown[0].thumbprint, TrustState::Trusted).await.expect("approved");
    floor.until_connected(&id).await;
    monitor_all(&floor, &id, &peer);
    peer.set(r#"{"counter": 12}"#).await;
    floor.until_value(COUNTER, 12_i32).await;
    until("a decoded structure", || structure(floor.newest(POWER)).is_some()).await;
}

#[tokio::test]
async fn asyncua_is_a_good_source_through_kills_and_renumbering() {
    is_a_good_source(Stack::Asyncua, kills(4)).await;
}

#[tokio::test]
async fn node_opcua_is_a_good_source_through_kills_and_renumbering() {
    is_a_good_source(Stack::NodeOpcua, kills(3)).await;
}

#[tokio::test]
async fn asyncua_is_a_good_source_with_protection_and_a_user() {
    is_a_good_protected_source(Stack::Asyncua).await;
}

#[tokio::test]
async fn node_opcua_is_a_good_source_with_protection_and_a_user() {
    is_a_good_protected_source(Stack::NodeOpcua).await;
}

/// The Server object, which all events of a server come to.
const SERVER: NodeId = NodeId::ua(2253);
/// Inputs that take events.
const MESSAGE: u64 = 11;
const CONDITIONS: u64 = 12;
const SEVERITY: u64 = 13;

#[tokio::test]
async fn asyncua_events_make_values_and_its_conditions_are_uncertain() {
    let mut peer = Peer::start(Stack::Asyncua, false).await;
    let floor = TestShopFloor::start();
    let id = floor.connect_to(peer.source()).await;
    let severe = EventSelection { severity_min: Some(500), ..selection(field("Message")) };
    floor.monitor_events(MESSAGE, &id, SERVER, severe);
    floor.until_status(MESSAGE, StatusCode::BAD_WAITING_FOR_INITIAL_DATA).await;
    peer.set(r#"{"event": {"message": "a part is done", "severity": 100}}"#).await;
    peer.set(r#"{"event": {"message": "the door is open", "severity": 700}}"#).await;
    let message = |text: &str| {
        let text = LocalizedText { locale: None, text: Some(text.into()) };
        Variant::Scalar(Scalar::LocalizedText(Box::new(text)))
    };
    let arrived = floor.until_value(MESSAGE, message("the door is open")).await;
    assert!(arrived.status.is_good() && arrived.source_timestamp.is_some());
    assert!(floor.heard(MESSAGE).iter().all(|value| value.value != message("a part is done")));

    // It cannot name conditions that were active before.
    floor.monitor_events(CONDITIONS, &id, SERVER, selection(EventValue::ActiveConditions));
    floor.until_status(CONDITIONS, StatusCode::UNCERTAIN_INITIAL_VALUE).await;
    assert_eq!(floor.newest(CONDITIONS).map(|value| value.value), Some(0_u32.into()));
}

#[tokio::test]
async fn node_opcua_conditions_are_right_after_each_connection() {
    let mut peer = Peer::start(Stack::NodeOpcua, false).await;
    let floor = TestShopFloor::start();
    let id = floor.connect_to(peer.source()).await;
    floor.monitor(TEMPERATURE, &id, peer.node(2));
    peer.set(r#"{"temperature": 95}"#).await;
    floor.until_value(TEMPERATURE, 95.0).await;
    // Active before anything listened to it.
    floor.monitor_events(CONDITIONS, &id, SERVER, selection(EventValue::ActiveConditions));
    floor.monitor_events(SEVERITY, &id, SERVER, selection(EventValue::ActiveSeverity));
    assert_eq!(floor.until_value(CONDITIONS, 1_u32).await.status, StatusCode::GOOD);
    until("a severity", || {
        let severity = floor.newest(SEVERITY).and_then(|value| value.value.as_f64());
        severity.is_some_and(|severity| severity > 0.0)
    })
    .await;
    peer.set(r#"{"temperature": 20}"#).await;
    floor.until_value(CONDITIONS, 0_u32).await;
    floor.until_value(SEVERITY, 0_u16).await;
    peer.set(r#"{"temperature": 5}"#).await;
    floor.until_value(CONDITIONS, 1_u32).await;

    // A field that no event of this server has.
    floor.monitor_events(MESSAGE, &id, SERVER, selection(field("NoSuchField")));
    until("the field is said to be unknown", || {
        let problems = floor.status(&id).not_live;
        problems.iter().any(|one| one.reason.contains("does not know a field of the events"))
    })
    .await;

    // Begun again, it has no alarm.
    peer.kill().await;
    floor.until_status(CONDITIONS, StatusCode::BAD_NOT_CONNECTED).await;
    peer.restart(1, 0).await;
    assert_eq!(floor.until_value(CONDITIONS, 0_u32).await.status, StatusCode::GOOD);
}
