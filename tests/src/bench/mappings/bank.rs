//! A bank of counters in a process of its own.

use shop_floor::{SecurityChoice, SourceConfig, SourceId};
use tempfile::TempDir;

use crate::harness::{Daemon, DaemonCommand, binary};

/// The namespace of the bank's nodes.
pub(super) const NAMESPACE: &str = "urn:verbund:simulator:Bank";

/// The running bank; it ends when this is dropped.
pub(super) struct Bank {
    pub variables: u32,
    pub endpoint: String,
    _daemon: Daemon,
    _folder: TempDir,
}

/// Returns the name of a counter's node.
pub(super) fn node(index: u32) -> String {
    format!("nsu={NAMESPACE};s=Counter{index}")
}

impl Bank {
    /// Number of counters that together change so often.
    pub async fn start(variables: u32, changes_per_second: u32) -> anyhow::Result<Self> {
        let folder = tempfile::Builder::new().prefix("verbund-bank-").tempdir()?;
        let [port] = free_ports::reserve()?;
        let config = folder.path().join("machines.toml");
        let pki = folder.path().join("pki");
        std::fs::write(
            &config,
            format!(
                "host = \"127.0.0.1\"\npki_directory = {pki:?}\nupdate_interval_ms = 20\n\n[[machines]]\nname = \"Bank\"\n\
                 kind = \"bank\"\nport = {port}\nvariables = {variables}\nchanges_per_second = {changes_per_second}.0\n\
                 relay = false\n"
            ),
        )?;
        let daemon = Daemon::start(DaemonCommand {
            name: "bank".to_owned(),
            program: binary("simulator")?,
            arguments: vec!["--config".to_owned(), config.display().to_string()],
            environment: Vec::new(),
            log: folder.path().join("bank.log"),
        })?;
        Ok(Self {
            variables,
            endpoint: format!("opc.tcp://127.0.0.1:{port}"),
            _daemon: daemon,
            _folder: folder,
        })
    }

    /// Source by which a connector reads from it.
    pub fn source(&self) -> anyhow::Result<SourceConfig> {
        let mut source = SourceConfig::new(SourceId::new("bank")?, &self.endpoint);
        (source.security, source.publishing_interval_ms) = (SecurityChoice::None, 50);
        Ok(source)
    }
}
