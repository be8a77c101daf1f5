//! Mosquitto in a private folder, on free ports, with a generated access control list.

use std::{
    fs,
    path::Path,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use tempfile::TempDir;

use crate::definitions::{BrokerPlan, mosquitto_acl, mosquitto_queue_limits};

/// Times at which Mosquitto writes its store to disk; it writes all of it each time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saving {
    /// Within a second of each change.
    Always,
    /// At an orderly stop of the broker; for tests with a large store.
    AtTheEnd,
}

/// The broker; stopped and removed when dropped.
#[derive(Debug)]
pub struct Mosquitto {
    folder: TempDir,
    child: Child,
    port: u16,
    accounts_port: u16,
    websocket_port: u16,
    tls_port: u16,
}

/// A certificate for `localhost`, as PEM.
#[derive(Debug, Clone, Copy)]
pub struct ServerCertificate<'a> {
    pub certificate: &'a str,
    pub key: &'a str,
    /// The authority whose certificates clients have to show over TLS; none where they need none.
    pub client_authority: Option<&'a str>,
}

impl ServerCertificate<'_> {
    /// Writes its files, and returns the options of a listener that uses them.
    fn options(&self, folder: &Path) -> String {
        let write = |name: &str, content: &str| {
            let path = folder.join(name);
            fs::write(&path, content).expect("written");
            path.display().to_string()
        };
        let own = format!(
            "certfile {}\nkeyfile {}\n",
            write("certificate.pem", self.certificate),
            write("key.pem", self.key)
        );
        let authority = self.client_authority.map(|authority| write("authority.pem", authority));
        let required = authority.map(|path| format!("cafile {path}\nrequire_certificate true\n"));
        own + required.as_deref().unwrap_or_default()
    }
}

impl Mosquitto {
    /// Starts a broker for the plan's accounts.
    ///
    /// # Panics
    /// Panics when Mosquitto is not installed or does not start.
    pub async fn start(plan: &BrokerPlan, saving: Saving) -> Self {
        Self::start_with(plan, saving, None).await
    }

    /// Starts a broker; with a certificate its WebSockets are encrypted, and it takes TLS on a port of its own.
    ///
    /// # Panics
    /// Panics when Mosquitto is not installed or does not start.
    pub async fn start_with(
        plan: &BrokerPlan,
        saving: Saving,
        certificate: Option<ServerCertificate<'_>>,
    ) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name).display().to_string();
        let [port, accounts_port, websocket_port, tls_port] =
            free_ports::reserve().expect("free ports");
        let encryption = certificate.map(|certificate| certificate.options(folder.path()));
        let encryption = encryption.unwrap_or_default();
        let tls_listener = if encryption.is_empty() {
            String::new()
        } else {
            format!("listener {tls_port} 127.0.0.1\n{encryption}")
        };
        fs::write(path("acl"), mosquitto_acl(plan)).expect("written");
        fs::write(path("passwords"), "").expect("written");
        let tools = plan.tools.iter().map(|(_, account)| account);
        let accounts = plan.factories.iter().map(|(_, account)| account);
        let accounts = accounts.chain(tools).chain([&plan.platform]);
        for account in accounts {
            change_passwords(&["-b", &path("passwords"), &account.user_name, &account.password]);
        }
        let configuration = format!(
            "user root\nlistener {port} 127.0.0.1\n{tls_listener}\
             listener {accounts_port} 127.0.0.1\nuse_username_as_clientid true\n\
             listener {websocket_port} 127.0.0.1\nprotocol websockets\n\
             {encryption}allow_anonymous false\npassword_file {}\nacl_file {}\n\
             persistence true\npersistence_location {}/\n{}\n\
             {}log_dest file {}\n",
            path("passwords"),
            path("acl"),
            folder.path().display(),
            match saving {
                Saving::Always => "autosave_interval 1\nautosave_on_changes true",
                Saving::AtTheEnd => "autosave_interval 0",
            },
            mosquitto_queue_limits(plan),
            path("log"),
        );
        fs::write(path("mosquitto.conf"), configuration).expect("written");
        let child = spawn(folder.path());
        let broker = Self { folder, child, port, accounts_port, websocket_port, tls_port };
        broker.ready().await;
        broker
    }

    /// Returns its address, for [`LinkConfig`](crate::LinkConfig).
    #[must_use]
    pub fn url(&self) -> String {
        format!("mqtt://127.0.0.1:{}", self.port)
    }

    /// Returns the address for factories and tools, as the definitions say that they have one of their own.
    #[must_use]
    pub fn url_of_accounts(&self) -> String {
        format!("mqtt://127.0.0.1:{}", self.accounts_port)
    }

    /// Returns its address with TLS, if it has a certificate.
    #[must_use]
    pub fn tls_url(&self) -> String {
        format!("mqtts://localhost:{}", self.tls_port)
    }

    /// Returns the port of its WebSockets.
    #[must_use]
    pub const fn websocket_port(&self) -> u16 {
        self.websocket_port
    }

    /// Returns the bytes of its store on the disk, as of the last storing.
    #[must_use]
    pub fn bytes_stored(&self) -> u64 {
        fs::metadata(self.folder.path().join("mosquitto.db")).map_or(0, |file| file.len())
    }

    async fn ready(&self) {
        let deadline = Instant::now() + Duration::from_secs(30);
        // The WebSockets are opened last.
        while tokio::net::TcpStream::connect(("127.0.0.1", self.websocket_port)).await.is_err() {
            let log = || fs::read_to_string(self.folder.path().join("log")).unwrap_or_default();
            assert!(Instant::now() < deadline, "Mosquitto did not start in time: {}", log());
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    }

    /// Sets an account's password, and ends connections with another one.
    ///
    /// # Panics
    /// Panics when the broker cannot be asked to read it.
    pub fn set_password(&self, user_name: &str, password: &str) {
        change_passwords(&["-b", &self.passwords(), user_name, password]);
        self.signal("-HUP");
    }

    /// Removes an account, and ends its connections.
    ///
    /// # Panics
    /// Panics when there is none, or the broker cannot be asked to forget it.
    pub fn remove_account(&self, user_name: &str) {
        change_passwords(&["-D", &self.passwords(), user_name]);
        self.signal("-HUP");
    }

    fn passwords(&self) -> String {
        self.folder.path().join("passwords").display().to_string()
    }

    fn signal(&self, signal: &str) {
        let pid = self.child.id().to_string();
        let asked = Command::new("kill").args([signal, &pid]).status().expect("kill runs");
        assert!(asked.success());
    }

    /// Stops it in order, so that its store is written, and starts it again.
    ///
    /// # Panics
    /// Panics when it does not stop or start again.
    pub async fn restart(&mut self) {
        self.signal("-TERM");
        self.child.wait().expect("reaped");
        self.child = spawn(self.folder.path());
        self.ready().await;
    }

    /// Kills it, as a crash does, and starts it again.
    ///
    /// # Panics
    /// Panics when it does not run or does not start again.
    pub async fn kill_and_restart(&mut self) {
        self.child.kill().expect("it runs");
        self.child.wait().expect("reaped");
        self.child = spawn(self.folder.path());
        self.ready().await;
    }
}

impl Drop for Mosquitto {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Changes the file of passwords.
fn change_passwords(arguments: &[&str]) {
    let changed = Command::new("mosquitto_passwd").args(arguments).stderr(Stdio::null()).status();
    let changed =
        changed.expect("mosquitto_passwd runs; tools/prerequisites.sh test installs mosquitto");
    assert!(changed.success(), "mosquitto_passwd failed");
}

fn spawn(folder: &Path) -> Child {
    Command::new("mosquitto")
        .arg("-c")
        .arg(folder.join("mosquitto.conf"))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("mosquitto starts; tools/prerequisites.sh test installs it")
}
