//! A RabbitMQ 3.10 with its AMQP 1.0 plugin in a private folder, on free ports.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use serde_json::Value;
use tempfile::TempDir;
use tokio::io::{AsyncReadExt, AsyncWriteExt};

use super::ServerCertificate;

/// File with the settings of the listener with TLS; empty where there is none.
const ENCRYPTION: &str = "encryption";

/// The broker; stopped and removed when dropped.
#[derive(Debug)]
pub struct RabbitMq {
    folder: TempDir,
    child: Child,
    ports: Ports,
}

#[derive(Debug)]
struct Ports {
    amqp: u16,
    tls: u16,
    distribution: u16,
    epmd: u16,
}

impl Ports {
    fn free() -> Self {
        let [amqp, tls, distribution, epmd] = free_ports::reserve().expect("free ports");
        Self { amqp, tls, distribution, epmd }
    }
}

fn server() -> PathBuf {
    let root = Path::new("/usr/lib/rabbitmq/lib");
    let installed = fs::read_dir(root)
        .ok()
        .into_iter()
        .flatten()
        .flatten()
        .map(|e| e.path().join("sbin/rabbitmq-server"));
    installed
        .into_iter()
        .find(|path| path.exists())
        .expect("RabbitMQ is not installed; tools/prerequisites.sh test installs it (Debian package rabbitmq-server)")
}

impl RabbitMq {
    /// Starts a broker that has loaded the definitions.
    ///
    /// # Panics
    /// Panics when RabbitMQ is not installed or does not start.
    pub async fn start(definitions: &Value) -> Self {
        Self::start_with(definitions, None).await
    }

    /// Starts a broker; with a certificate it takes TLS on a port of its own.
    ///
    /// # Panics
    /// Panics when RabbitMQ is not installed or does not start.
    pub async fn start_with(
        definitions: &Value,
        certificate: Option<ServerCertificate<'_>>,
    ) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("definitions.json"), definitions.to_string())
            .expect("written");
        let ports = Ports::free();
        let settings =
            certificate.map(|certificate| encryption(certificate, folder.path(), ports.tls));
        fs::write(folder.path().join(ENCRYPTION), settings.unwrap_or_default()).expect("written");
        let child = spawn(folder.path(), &ports);
        let mut broker = Self { folder, child, ports };
        broker.ready().await;
        broker
    }

    /// Returns its address, for [`LinkConfig`](crate::LinkConfig).
    #[must_use]
    pub fn url(&self) -> String {
        format!("amqp://127.0.0.1:{}", self.ports.amqp)
    }

    /// Returns its address with TLS, if it has a certificate.
    #[must_use]
    pub fn tls_url(&self) -> String {
        format!("amqps://localhost:{}", self.ports.tls)
    }

    /// Takes accounts, rights and queues of definitions into the running broker. What they do not name stays.
    ///
    /// # Panics
    /// Panics when the broker refuses them.
    pub fn import(&self, definitions: &Value) {
        let path = self.folder.path().join("definitions.json");
        // A restart loads them again.
        fs::write(&path, definitions.to_string()).expect("written");
        self.control(&["import_definitions", &path.display().to_string()]);
    }

    /// Removes an account, and cuts its connections.
    ///
    /// # Panics
    /// Panics when there is none.
    pub fn remove_account(&self, user_name: &str) {
        self.control(&["delete_user", user_name]);
        self.control(&["close_all_user_connections", user_name, "removed"]);
    }

    /// Returns how many messages a queue holds.
    ///
    /// # Panics
    /// Panics when the broker does not know the queue.
    #[must_use]
    pub fn messages_in(&self, queue: &str) -> u64 {
        let listed = self.control(&["-q", "list_queues", "--no-table-headers", "name", "messages"]);
        let mut lines = listed.lines().filter_map(|line| line.split_once('\t'));
        let found = lines.find(|(name, _)| *name == queue);
        found
            .and_then(|(_, messages)| messages.trim().parse().ok())
            .expect("a queue and its number")
    }

    fn control(&self, arguments: &[&str]) -> String {
        let mut command = Command::new(server().with_file_name("rabbitmqctl"));
        let output = environment(&mut command, self.folder.path(), &self.ports)
            .args(arguments)
            .output()
            .expect("rabbitmqctl runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "rabbitmqctl {arguments:?}: {said}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Returns whether its log has these words.
    ///
    /// # Panics
    /// Panics when the log cannot be read.
    #[must_use]
    pub fn has_said(&self, words: &str) -> bool {
        let log = fs::read(self.folder.path().join("out")).expect("a log");
        String::from_utf8_lossy(&log).contains(words)
    }

    /// Returns the bytes of its stores on the disk.
    ///
    /// # Panics
    /// Panics when its folder cannot be read.
    #[must_use]
    pub fn bytes_stored(&self) -> u64 {
        let counted = Command::new("du")
            .args(["-s", "--block-size=1"])
            .arg(self.folder.path().join("mnesia"))
            .output()
            .expect("du runs");
        // Files vanish while they are counted, which du complains about and leaves out.
        let text = String::from_utf8_lossy(&counted.stdout).into_owned();
        text.split_whitespace().next().and_then(|bytes| bytes.parse().ok()).expect("a number")
    }

    /// Kills it without warning and starts it again on the same store.
    ///
    /// # Panics
    /// Panics when it does not start again.
    pub async fn kill_and_restart(&mut self) {
        self.kill();
        self.child = spawn(self.folder.path(), &self.ports);
        self.ready().await;
    }

    async fn ready(&mut self) {
        let deadline = Instant::now() + Duration::from_secs(90);
        loop {
            if let Ok(mut stream) =
                tokio::net::TcpStream::connect(("127.0.0.1", self.ports.amqp)).await
            {
                let mut answer = [0; 4];
                let hello = stream.write_all(b"AMQP\x03\x01\x00\x00").await;
                if hello.is_ok()
                    && stream.read_exact(&mut answer).await.is_ok()
                    && &answer == b"AMQP"
                {
                    return;
                }
            }
            let log = || fs::read_to_string(self.folder.path().join("out")).unwrap_or_default();
            assert!(
                self.child.try_wait().expect("a status").is_none(),
                "RabbitMQ ended: {}",
                log()
            );
            assert!(Instant::now() < deadline, "RabbitMQ did not start in time: {}", log());
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
    }

    /// Kills the process of the Erlang VM, a child of the script's shell.
    fn kill(&mut self) {
        if let Ok(pid) = fs::read_to_string(self.folder.path().join("pid")) {
            let _ = Command::new("kill").args(["-9", pid.trim()]).status();
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for RabbitMq {
    fn drop(&mut self) {
        self.kill();
        // The port mapper outlives the node; it is private, so it is stopped, too.
        let _ = Command::new("epmd")
            .args(["-port", &self.ports.epmd.to_string(), "-kill"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
    }
}

/// Writes the files of a certificate, and returns the settings of a listener that uses them.
fn encryption(certificate: ServerCertificate<'_>, folder: &Path, port: u16) -> String {
    let write = |name: &str, content: &str| {
        let path = folder.join(name);
        fs::write(&path, content).expect("written");
        path.display().to_string()
    };
    let own = format!(
        "listeners.ssl.1 = 127.0.0.1:{port}\nssl_options.certfile = {}\nssl_options.keyfile = {}\n",
        write("certificate.pem", certificate.certificate),
        write("key.pem", certificate.key)
    );
    let authority = certificate.client_authority.map(|pem| write("authority.pem", pem));
    let required = authority.map(|path| {
        format!(
            "ssl_options.cacertfile = {path}\nssl_options.verify = verify_peer\n\
             ssl_options.fail_if_no_peer_cert = true\n"
        )
    });
    own + required.as_deref().unwrap_or_default()
}

fn spawn(folder: &Path, ports: &Ports) -> Child {
    let path = |name: &str| folder.join(name);
    let configuration = format!(
        "listeners.tcp.1 = 127.0.0.1:{}\nload_definitions = {}\nlog.console = true\nlog.file = false\n\
         vm_memory_high_watermark.absolute = 512MB\ndisk_free_limit.absolute = 50MB\nnum_acceptors.tcp = 2\n\
         raft.wal_max_size_bytes = 2097152\nraft.segment_max_entries = 32\n{}",
        ports.amqp,
        path("definitions.json").display(),
        fs::read_to_string(path(ENCRYPTION)).expect("written"),
    );
    fs::write(path("rabbitmq.conf"), configuration).expect("written");
    fs::write(path("enabled_plugins"), "[rabbitmq_amqp1_0].").expect("written");
    let out = fs::File::create(path("out")).expect("a log");
    environment(&mut Command::new(server()), folder, ports)
        .stdin(Stdio::null())
        .stdout(out.try_clone().expect("a log"))
        .stderr(out)
        .spawn()
        .expect("RabbitMQ starts")
}

/// Sets folders and ports of one broker for its server and its control.
fn environment<'c>(command: &'c mut Command, folder: &Path, ports: &Ports) -> &'c mut Command {
    let path = |name: &str| folder.join(name);
    command
        .env("HOME", folder)
        .env("ERL_EPMD_PORT", ports.epmd.to_string())
        .env("ERL_EPMD_ADDRESS", "127.0.0.1")
        .env("RABBITMQ_NODENAME", format!("t{}@localhost", ports.amqp))
        .env("RABBITMQ_DIST_PORT", ports.distribution.to_string())
        .env("RABBITMQ_CONFIG_FILE", path("rabbitmq.conf"))
        .env("RABBITMQ_ENABLED_PLUGINS_FILE", path("enabled_plugins"))
        .env("RABBITMQ_MNESIA_BASE", path("mnesia"))
        .env("RABBITMQ_LOG_BASE", path("log"))
        .env("RABBITMQ_LOGS", "-")
        .env("RABBITMQ_PID_FILE", path("pid"))
        .env("RABBITMQ_GENERATED_CONFIG_DIR", path("gen"))
        .env("RABBITMQ_SCHEMA_DIR", path("schema"))
        .env("RABBITMQ_FEATURE_FLAGS_FILE", path("feature_flags"))
        .env("RABBITMQ_PLUGINS_EXPAND_DIR", path("plugins"))
        .env("RABBITMQ_CONF_ENV_FILE", "/dev/null")
        .env(
            "RABBITMQ_SERVER_ADDITIONAL_ERL_ARGS",
            "+S 1:1 +sbwt none -kernel inet_dist_use_interface {127,0,0,1}",
        )
}
