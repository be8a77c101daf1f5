//! Servers of other people's stacks, each in a process of its own that tests kill, freeze and move.

use std::{
    path::{Path, PathBuf},
    process::Stdio,
    sync::Arc,
    time::Duration,
};

use asi_model::NodeId;
use parking_lot::Mutex;
use shop_floor::{Identity, SecurityChoice, SourceConfig, SourceId};
use tempfile::TempDir;
use tokio::{
    io::{AsyncBufReadExt as _, AsyncWriteExt as _, BufReader},
    process::{Child, ChildStdin, Command},
    sync::OnceCell,
};

/// Number of variables of a machine with the limits of a small controller.
pub const SMALL_VARIABLES: u64 = 27;
/// Number of the first variable that only such a machine has, beside counter (1), temperature (2) and text (3).
const SMALL_FIRST: u64 = 5;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stack {
    Asyncua,
    NodeOpcua,
    /// Has the limits of a small controller always.
    Open62541,
}

impl Stack {
    fn namespace(self) -> &'static str {
        match self {
            Self::Asyncua => "urn:verbund:test:asyncua",
            Self::NodeOpcua => "urn:verbund:test:node-opcua",
            Self::Open62541 => "urn:verbund:test:open62541",
        }
    }

    fn program(self) -> Command {
        let scripts = repository().join("shop-floor/tests/foreign");
        match self {
            Self::Asyncua => {
                let mut command =
                    Command::new(repository().join("target/foreign/python/bin/python"));
                command.env("PYTHONDONTWRITEBYTECODE", "1").arg(scripts.join("asyncua_server.py"));
                command
            }
            Self::NodeOpcua => {
                let mut command = Command::new("node");
                command.env("NODE_PATH", repository().join("tests/foreign/node_modules"));
                command.arg(scripts.join("node_opcua_server.js"));
                command
            }
            Self::Open62541 => Command::new(repository().join("target/foreign/open62541/machine")),
        }
    }
}

/// A server of another stack in a process of its own, killed when dropped.
pub struct Peer {
    stack: Stack,
    address: String,
    pub port: u16,
    directory: TempDir,
    options: Vec<String>,
    identity: Identity,
    security: SecurityChoice,
    /// Values of the counter that left the server in messages, by its own word; of a small controller only.
    kept: Arc<Mutex<Vec<i32>>>,
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
        let mut peer = Self::new(stack).await;
        if is_protected {
            peer.identity =
                Identity::UserName { user_name: "connector".into(), password: "machine".into() };
            peer.security = SecurityChoice::Strongest;
            peer.options.push("--protected".into());
            if stack == Stack::Asyncua {
                peer.options.push(peer.directory.path().display().to_string());
            }
        }
        peer.restart(0, 0).await;
        peer
    }

    /// Starts a server with the limits of a small controller: it publishes no faster than this, looks at values every
    /// 250 ms, and has queues of 1, 10 operations in a request, 20 items in a subscription, 2 subscriptions in a session
    /// and 3 sessions.
    pub async fn small(stack: Stack, publishing_ms: u32) -> Self {
        let mut peer = Self::new(stack).await;
        peer.options.extend(["--small".into(), publishing_ms.to_string()]);
        peer.restart(0, 0).await;
        peer
    }

    async fn new(stack: Stack) -> Self {
        install().await;
        let [port] = free_ports::reserve().expect("a free port");
        let directory = tempfile::tempdir().expect("a folder for certificates");
        let mut options = Vec::new();
        if stack == Stack::NodeOpcua {
            options.extend(["--pki".into(), directory.path().display().to_string()]);
        }
        Self {
            stack,
            address: "127.0.0.1".into(),
            port,
            directory,
            options,
            identity: Identity::Anonymous,
            security: SecurityChoice::None,
            kept: Arc::default(),
            running: None,
        }
    }

    /// Kills the server, if it runs, and starts it with other indexes and ids; it is ready when
    /// this returns.
    pub async fn restart(&mut self, before: u32, renumber: u32) {
        self.kill().await;
        let mut command = self.stack.program();
        command
            .args(["--port", &self.port.to_string(), "--address", &self.address])
            .args(["--before", &before.to_string(), "--renumber", &renumber.to_string()])
            .args(&self.options)
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
        let kept = Arc::clone(&self.kept);
        tokio::spawn(async move {
            while let Ok(Some(line)) = lines.next_line().await {
                if let Some(Ok(value)) = line.strip_prefix("kept ").map(str::parse) {
                    kept.lock().push(value);
                }
            }
        });
        let stdin = child.stdin.take().expect("piped");
        self.running = Some((child, stdin));
    }

    /// Kills the server and starts it at another address, with other indexes and ids.
    pub async fn move_to(&mut self, address: &str, port: u16, before: u32, renumber: u32) {
        self.kill().await;
        self.address = address.into();
        self.port = port;
        self.restart(before, renumber).await;
    }

    pub async fn kill(&mut self) {
        if let Some((mut child, _)) = self.running.take() {
            child.kill().await.expect("it can be killed");
        }
    }

    /// Freezes the server: it keeps its connections and does nothing.
    pub async fn freeze(&self) {
        self.signal("-STOP").await;
    }

    pub async fn thaw(&self) {
        self.signal("-CONT").await;
    }

    async fn signal(&self, signal: &str) {
        let (child, _) = self.running.as_ref().expect("running");
        let process = child.id().expect("it was not waited for");
        let sent = Command::new("sh").args(["-c", &format!("kill {signal} {process}")]).status();
        assert!(sent.await.expect("a shell runs").success(), "{signal} to {process}");
    }

    pub async fn set(&mut self, json: &str) {
        let (_, stdin) = self.running.as_mut().expect("running");
        stdin.write_all(format!("{json}\n").as_bytes()).await.expect("it listens");
        stdin.flush().await.expect("it listens");
    }

    /// Returns the values of the counter that left the server in messages so far.
    pub fn kept(&self) -> Vec<i32> {
        self.kept.lock().clone()
    }

    /// The identity that a node had at first.
    pub fn node(&self, number: u32) -> NodeId {
        NodeId::numeric(self.stack.namespace(), 2000 + number)
    }

    /// Returns the numbers of all variables of a small controller.
    pub fn small_numbers() -> impl Iterator<Item = u64> {
        (1..=3).chain(SMALL_FIRST..SMALL_FIRST + SMALL_VARIABLES - 3)
    }

    /// Returns the source at the present address.
    pub fn source(&self) -> SourceConfig {
        let id = SourceId::new("machine").expect("valid");
        let url = format!("opc.tcp://{}:{}/machine", self.address, self.port);
        let mut source = SourceConfig::new(id, &url);
        source.identity = self.identity.clone();
        source.security = self.security;
        source
    }
}
