//! Foreign OPC UA stacks against the twin: asyncua and node-opcua, encrypted and with a user.

use std::{
    path::{Path, PathBuf},
    process::Stdio,
    time::Duration,
};

use opcua_stack::opcua::crypto::SecurityPolicy;
use serde_json::{Value, json};
use tokio::{
    io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader, Lines},
    process::{Child, ChildStderr, ChildStdin, ChildStdout, Command},
    sync::{Mutex, OnceCell},
    time::timeout,
};

use crate::harness::{TestTwin, document, external, field, field_id, good, message};

/// Time limit of a command: the start of an interpreter on a busy machine is slow.
const COMMAND_TIMEOUT: Duration = Duration::from_secs(90);
/// Time limit to install the peers.
const SETUP_TIMEOUT: Duration = Duration::from_secs(600);

/// The two foreign clients; both have the same commands.
#[derive(Debug, Clone, Copy)]
enum Peer {
    Asyncua,
    NodeOpcua,
}

pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Installs the peers once; fast when they are installed already.
pub async fn installed() {
    static INSTALLED: OnceCell<()> = OnceCell::const_new();
    INSTALLED
        .get_or_init(|| async {
            let setup =
                Command::new("bash").arg(repository().join("tests/foreign/setup.sh")).status();
            let status = timeout(SETUP_TIMEOUT, setup).await.expect("installing takes too long");
            assert!(
                status.unwrap().success(),
                "tests/foreign/setup.sh installs asyncua and node-opcua"
            );
        })
        .await;
}

/// A running foreign client, which executes one command after the other: its start takes seconds.
struct Process {
    peer: Peer,
    _child: Child,
    commands: ChildStdin,
    results: Lines<BufReader<ChildStdout>>,
    errors: Lines<BufReader<ChildStderr>>,
}

impl Process {
    async fn start(peer: Peer) -> Mutex<Self> {
        installed().await;
        let scripts = repository().join("tests/foreign/opcua");
        let (program, script) = match peer {
            Peer::Asyncua => {
                (repository().join("target/foreign/python/bin/python"), "asyncua_client.py")
            }
            Peer::NodeOpcua => ("node".into(), "node_client.js"),
        };
        let mut child = Command::new(program)
            .arg(scripts.join(script))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .kill_on_drop(true)
            .spawn()
            .unwrap();
        Mutex::new(Self {
            peer,
            commands: child.stdin.take().unwrap(),
            results: BufReader::new(child.stdout.take().unwrap()).lines(),
            errors: BufReader::new(child.stderr.take().unwrap()).lines(),
            _child: child,
        })
    }

    async fn begin(&mut self, arguments: &[&str]) {
        let line = json!(arguments).to_string() + "\n";
        self.commands.write_all(line.as_bytes()).await.unwrap();
    }

    async fn result(&mut self) -> Value {
        let result = timeout(COMMAND_TIMEOUT, self.results.next_line()).await.unwrap().unwrap();
        if let Some(line) = result {
            return serde_json::from_str(&line).unwrap();
        }
        let mut complaints = String::new();
        self.errors.get_mut().read_to_string(&mut complaints).await.unwrap();
        panic!("{:?} said: {complaints}", self.peer)
    }

    async fn listening(&mut self) {
        while let Some(line) = self.errors.next_line().await.unwrap() {
            if line == "ready" {
                return;
            }
        }
        panic!("{:?} ended before it listened", self.peer);
    }
}

/// One sign-in of a foreign client.
struct Foreign<'a> {
    process: &'a Mutex<Process>,
    pki: String,
    endpoint: String,
    user: &'a str,
    password: String,
}

impl<'a> Foreign<'a> {
    async fn new(process: &'a Mutex<Process>, twin: &TestTwin, user: &'a str) -> Self {
        let pki = twin.folder.path().join(format!("{:?}", process.lock().await.peer));
        let pki = pki.into_os_string().into_string().unwrap();
        Self {
            process,
            pki,
            endpoint: twin.url.to_string(),
            user,
            password: format!("{user}-secret"),
        }
    }

    fn signed_in<'b>(&'b self, arguments: &[&'b str]) -> Vec<&'b str> {
        let mut all =
            vec![self.endpoint.as_str(), "--user", self.user, "--password", &self.password];
        all.extend(["--timeout", "60", "--pki", &self.pki]);
        all.extend(arguments);
        all
    }

    async fn run(&self, arguments: &[&str]) -> Value {
        let mut process = self.process.lock().await;
        process.begin(&self.signed_in(arguments)).await;
        process.result().await
    }

    /// Runs several commands in one session.
    async fn batch(&self, commands: &[&[&str]]) -> Vec<Value> {
        let result = self.run(&["batch", &json!(commands).to_string()]).await;
        result["results"].as_array().unwrap_or_else(|| panic!("{result}")).clone()
    }

    /// Runs a command that subscribes, and `when_ready` once it has.
    async fn listen(&self, arguments: &[&str], when_ready: impl AsyncFnOnce()) -> Value {
        let mut process = self.process.lock().await;
        process.begin(&self.signed_in(arguments)).await;
        timeout(COMMAND_TIMEOUT, process.listening()).await.unwrap();
        when_ready().await;
        process.result().await
    }
}

fn nsu(identifier: &str) -> String {
    format!("nsu=urn:verbund:cpt:FOR_MUC;s={identifier}")
}

/// Identifiers of the example's nodes that the foreign clients use.
struct Nodes {
    field: String,
    undecided: String,
    request: String,
    decide: String,
}

impl Nodes {
    fn new() -> Self {
        Self {
            field: nsu(&field_id("net", "progressStatus")),
            undecided: nsu(&field_id("net", "percent")),
            request: nsu("net/op/MakeFrame1/req/ReqResponse1"),
            decide: nsu("net/op/MakeFrame1/req/ReqResponse1#Decide"),
        }
    }
}

const REFUSAL: &str = r#"[["String", "percent"], ["Int32", 2], ["String", "not ours to tell"]]"#;

/// Checks all services that a foreign client uses, one after the other.
async fn works_with(peer: Peer) {
    let (twin, process) = tokio::join!(TestTwin::start(), Process::start(peer));
    twin.handle.apply(document(message("net", 1)));
    twin.handle.publish_decision(&field("net", "progressStatus"), external());
    let nodes = Nodes::new();
    check_writes(&Foreign::new(&process, &twin, "otto").await, &nodes).await;
    let viewer = Foreign::new(&process, &twin, "vera").await;
    check_reads(&viewer, &nodes).await;
    check_subscription(&viewer, &twin, &nodes).await;
    let engineer = Foreign::new(&process, &twin, "anna").await;
    check_decision(&engineer, &nodes).await;
    check_change_events(&viewer, &engineer, &twin).await;
    check_session_events(&viewer, &twin, peer).await;
    twin.stop().await;
}

async fn check_writes(operator: &Foreign<'_>, nodes: &Nodes) {
    let statuses = operator
        .batch(&[
            &["write", &nodes.field, "UInt64", "5"],
            &["write", &nodes.undecided, "Double", "5.0"],
            &["write", &nodes.field, "Int32", "6"],
            &["call", &nodes.request, &nodes.decide, REFUSAL],
        ])
        .await;
    let statuses: Vec<&Value> = statuses.iter().map(|result| &result["status"]).collect();
    assert_eq!(statuses, ["Good", "BadNotWritable", "BadTypeMismatch", "BadUserAccessDenied"]);
}

async fn check_reads(viewer: &Foreign<'_>, nodes: &Nodes) {
    let found = viewer
        .batch(&[
            &["browse", &nsu("net#OperationNetwork")],
            &["read", &nodes.field],
            &["read", &format!("{}#EngineeringUnits", nodes.field)],
            &["write", &nodes.field, "UInt64", "6"],
        ])
        .await;
    let children = found[0]["children"].as_array().unwrap();
    let names: Vec<&str> = children.iter().map(|c| c["browseName"].as_str().unwrap()).collect();
    for name in ["OperationNetworkId", "MakeFrame1", "InspectFrame1", "rel1"] {
        assert!(names.contains(&name), "{found:?}");
    }
    assert_eq!((&found[1]["value"], &found[1]["status"]), (&json!(5), &json!("Good")), "{found:?}");
    assert_eq!(found[2]["status"], "Good", "{found:?}");
    assert_eq!(found[3]["status"], "BadUserAccessDenied", "{found:?}");
}

async fn check_subscription(viewer: &Foreign<'_>, twin: &TestTwin, nodes: &Nodes) {
    let changes = viewer
        .listen(&["subscribe", &nodes.field, "3"], async || {
            for value in [8_u64, 9] {
                twin.handle.publish_values(vec![(field("net", "progressStatus"), good(value))]);
            }
        })
        .await;
    let values: Vec<&Value> =
        changes["changes"].as_array().unwrap().iter().map(|c| &c["value"]).collect();
    assert_eq!(values, [&json!(5), &json!(8), &json!(9)], "{changes}");
}

/// Refuses a field, and exports the interface as a NodeSet that contains the whole network.
async fn check_decision(engineer: &Foreign<'_>, nodes: &Nodes) {
    let decided = engineer
        .batch(&[
            &["call", &nodes.request, &nodes.decide, REFUSAL],
            &["read", &format!("{}#DecisionReason", nodes.undecided)],
            &["call", &nsu("net"), &nsu("net#ExportNodeSet"), "[]"],
        ])
        .await;
    assert_eq!(
        (&decided[0]["status"], &decided[1]["value"]),
        (&json!("Good"), &json!("not ours to tell"))
    );
    let exported = decided[2]["outputs"][0].as_str().unwrap_or_else(|| panic!("{:?}", decided[2]));
    let exported = asi_model::node_set::read(&hex::decode(exported).unwrap()).unwrap();
    let json = asi_model::instance::to_json(&exported, "again").unwrap();
    let again = asi_model::validation::parse_platform_message(
        json.to_string().as_bytes(),
        &"FOR_MUC".parse().unwrap(),
    );
    let Ok(asi_model::messages::PlatformMessage::OperationNetwork(again)) = again else {
        panic!("an exported network can be parsed: {again:?}")
    };
    assert_eq!(again.operation_network, message("net", 1).operation_network);
}

async fn check_change_events(viewer: &Foreign<'_>, engineer: &Foreign<'_>, twin: &TestTwin) {
    let changed = viewer
        .listen(&["events", "1", "GeneralModelChangeEvent"], async || {
            twin.handle.apply(document(message("another", 1)));
        })
        .await;
    let affected =
        changed["events"][0]["Changes"].as_array().unwrap_or_else(|| panic!("{changed}"));
    assert!(affected.len() > 10, "{changed}");
    let audited = engineer
        .listen(&["events", "1", "AuditWriteUpdateEvent"], async || {
            twin.client("otto").await.write(&field_id("net", "progressStatus"), 10_u64).await;
        })
        .await;
    assert_eq!(audited["events"][0]["ClientUserId"], "otto", "{audited}");
    assert_eq!(audited["events"][0]["Status"], true, "{audited}");
}

async fn check_session_events(viewer: &Foreign<'_>, twin: &TestTwin, peer: Peer) {
    let sign_in_wrongly = async || {
        assert!(twin.connect("otto", "wrong", SecurityPolicy::Basic256Sha256).await.is_err());
    };
    let sessions = viewer
        .listen(&["events", "4", "AuditSessionEvent"], async || {
            twin.client("otto").await.close().await;
            sign_in_wrongly().await;
        })
        .await;
    let events = sessions["events"].as_array().unwrap_or_else(|| panic!("{sessions}"));
    let reported: Vec<[&Value; 3]> =
        events.iter().map(|e| [&e["SourceName"], &e["ClientUserId"], &e["Status"]]).collect();
    let (create, activate, close) =
        ("Session/CreateSession", "Session/ActivateSession", "Session/CloseSession");
    let expected = [
        (create, "System/CreateSession", true),
        (activate, "otto", true),
        (close, "otto", true),
        (create, "System/CreateSession", true),
    ];
    for (event, (source, user, status)) in reported.iter().zip(expected) {
        assert_eq!(event, &[&json!(source), &json!(user), &json!(status)], "{peer:?}: {sessions}");
    }
    let refused =
        viewer.listen(&["events", "1", "AuditActivateSessionEvent"], sign_in_wrongly).await;
    assert_eq!(refused["events"][0]["ClientUserId"], "otto", "{refused}");
    assert_eq!(refused["events"][0]["Status"], false, "{refused}");
    let channel = viewer
        .listen(&["events", "1", "AuditOpenSecureChannelEvent"], async || {
            twin.client("otto").await.close().await;
        })
        .await;
    assert_eq!(channel["events"][0]["Status"], true, "{channel}");
}

#[tokio::test]
async fn asyncua_browses_reads_writes_subscribes_calls_and_hears_events() {
    works_with(Peer::Asyncua).await;
}

#[tokio::test]
async fn node_opcua_browses_reads_writes_subscribes_calls_and_hears_events() {
    works_with(Peer::NodeOpcua).await;
}

#[tokio::test]
async fn foreign_clients_are_refused_with_the_right_status() {
    let twin = TestTwin::start_with(|_| {}).await;
    for peer in [Peer::Asyncua, Peer::NodeOpcua] {
        let process = Process::start(peer).await;
        let mut client = Foreign::new(&process, &twin, "vera").await;
        let read = ["read", "i=2259"];
        let untrusted = client.run(&read).await;
        assert_eq!(untrusted["ok"], false, "{peer:?}: {untrusted}");
        let list = twin.handle.trust_list().list().unwrap();
        for certificate in list {
            twin.handle.trust_list().trust(&certificate.thumbprint, "anna").unwrap();
        }
        let trusted = client.run(&read).await;
        assert_eq!(trusted["ok"], true, "{peer:?}: {trusted}");
        client.password = "wrong".to_owned();
        let refused = client.run(&read).await;
        assert_eq!(refused["status"], "BadIdentityTokenRejected", "{peer:?}: {refused}");
    }
    twin.stop().await;
}
