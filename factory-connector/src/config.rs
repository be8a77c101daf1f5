//! Configuration of the connector. `factory-connector.example.toml` shows every key with its
//! default; a test compares the two.

mod broker;
mod limits;
mod plaintext;

use std::{
    net::{Ipv4Addr, SocketAddr},
    path::PathBuf,
    time::Duration,
};

use asi_model::pubsub::json::Encoding;
pub use broker::{BrokerSection, ProxySection};
use daemon::{
    Confidential,
    configuration::Setting,
    sealing::{Sealer, SealingConfig},
    telemetry::LogConfig,
    web::{
        address_range::AddressRange,
        client_address::{ForwardedHeader, TrustedProxies},
        page_listener::PageListener,
        server::{ListenerLimits, TlsFiles},
        shares::PersonShare,
    },
};
pub use limits::{LedgerConfig, RetentionLimits, SpoolLimits};
use mapping_engine::MappingEngineConfig;
use serde::Deserialize;
use twin::{DiscoveryConfig, SecurityConfig, TwinConfig, TwinLimits};

/// The commented example, also printed by `factory-connector config example`.
pub const EXAMPLE: &str = include_str!("../factory-connector.example.toml");

/// All sections of the configuration file, with defaults for absent keys.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ConnectorConfig {
    /// Folder of the database, keys and certificates; on a local disk.
    pub data_directory: PathBuf,
    /// Use the folder although group or others may enter it.
    pub allow_shared_data_directory: bool,
    /// Key that seals the passwords in the store.
    pub sealing: SealingConfig,
    /// Listener of pages and API.
    pub web: WebConfig,
    /// Endpoint, security and limits of the OPC UA server.
    pub twin: TwinSection,
    pub enrolment: EnrolmentSection,
    /// Route to the platform's broker.
    pub broker: BrokerSection,
    /// Encoding and pace of reports.
    pub reports: ReportConfig,
    /// Bounds of the messages that wait to leave.
    pub spool: SpoolLimits,
    /// Retention of what left, and the ledger's witness.
    pub ledger: LedgerConfig,
    /// Bounds of mappings and scripts.
    pub mapping: MappingEngineConfig,
    /// The user that the first start makes.
    pub admin: AdminConfig,
    pub log: LogConfig,
    /// Every key with its value and source, as the page shows it; secrets are blanked.
    #[serde(skip)]
    pub settings: Vec<Setting>,
}

impl Default for ConnectorConfig {
    fn default() -> Self {
        Self {
            data_directory: PathBuf::from("connector-data"),
            allow_shared_data_directory: false,
            sealing: SealingConfig::default(),
            web: WebConfig::default(),
            twin: TwinSection::default(),
            enrolment: EnrolmentSection::default(),
            broker: BrokerSection::default(),
            reports: ReportConfig::default(),
            spool: SpoolLimits::default(),
            ledger: LedgerConfig::default(),
            mapping: MappingEngineConfig::default(),
            admin: AdminConfig::default(),
            log: LogConfig::default(),
            settings: Vec::new(),
        }
    }
}

/// Listener of pages and API.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WebConfig {
    /// Address of the listener; loopback unless TLS is configured.
    pub listen: SocketAddr,
    /// Base URL for browsers, where it is another than that of the listener.
    pub public_url: Option<String>,
    /// Certificate and key; plain HTTP without them.
    pub tls: Option<TlsFiles>,
    /// Speak plain HTTP with other machines.
    pub allow_plaintext: bool,
    /// Proxies in front of the pages, whose word about their clients counts.
    pub trusted_proxies: Vec<AddressRange>,
    /// Header in which these proxies tell the address of their client.
    pub forwarded_header: ForwardedHeader,
    /// Share of a person in requests, downloads and live streams.
    pub share_per_person: PersonShare,
}

/// Enrolment at the platform.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EnrolmentSection {
    /// Send the token to a platform on another machine without TLS.
    pub allow_plaintext: bool,
}

impl Default for WebConfig {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 8090)),
            public_url: None,
            tls: None,
            allow_plaintext: false,
            trusted_proxies: Vec::new(),
            forwarded_header: ForwardedHeader::default(),
            share_per_person: PersonShare::default(),
        }
    }
}

impl WebConfig {
    /// Returns the proxies in front of the pages.
    #[must_use]
    pub fn proxies(&self) -> TrustedProxies {
        TrustedProxies { ranges: self.trusted_proxies.clone(), header: self.forwarded_header }
    }

    /// Returns true if browsers come by HTTPS: to the listener or to a proxy in front of it.
    #[must_use]
    pub fn is_secure(&self) -> bool {
        self.tls.is_some()
            || self.public_url.as_ref().is_some_and(|url| url.starts_with("https://"))
    }

    /// Returns the base URL for browsers: that of the listener where no other is set.
    #[must_use]
    pub fn public_url(&self, listener: SocketAddr) -> String {
        let scheme = if self.tls.is_some() { "https" } else { "http" };
        self.public_url.clone().unwrap_or_else(|| format!("{scheme}://{listener}"))
    }

    /// Returns the listener with what is in front of it.
    #[must_use]
    pub fn page_listener(&self) -> PageListener<'_> {
        PageListener {
            listen: self.listen,
            has_tls: self.tls.is_some(),
            public_url: self.public_url.as_deref(),
            trusted_proxies: &self.trusted_proxies,
        }
    }

    /// Returns the bounds of their server.
    #[must_use]
    pub fn limits(&self) -> ListenerLimits {
        ListenerLimits {
            shared_addresses: self.trusted_proxies.clone(),
            only_shared: self.page_listener().serves_proxies_alone(),
            ..ListenerLimits::default()
        }
    }
}

/// Endpoint, security and limits of the OPC UA server.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TwinSection {
    /// Address of the endpoint (`opc.tcp`).
    pub listen: SocketAddr,
    /// Names for the certificate and the endpoint URLs.
    pub host_names: Vec<String>,
    /// Security modes, user tokens and trust of clients.
    pub security: SecurityConfig,
    /// Bounds on sessions, subscriptions and messages of clients.
    pub limits: TwinLimits,
    /// Registration at discovery servers.
    pub discovery: DiscoveryConfig,
}

impl Default for TwinSection {
    fn default() -> Self {
        let TwinConfig { listen, host_names, security, limits, discovery, .. } =
            TwinConfig::default();
        Self { listen, host_names, security, limits, discovery }
    }
}

/// Encoding and pace of reports.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReportConfig {
    /// JSON form of report messages.
    pub encoding: Encoding,
    /// The shortest time between two reports of one data set, in milliseconds.
    pub publishing_interval_ms: u64,
}

impl Default for ReportConfig {
    fn default() -> Self {
        Self { encoding: Encoding::default(), publishing_interval_ms: 20 }
    }
}

/// The first user, an engineer.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AdminConfig {
    /// Name to sign in with.
    pub user_name: String,
    /// Password; a random one is written to a file where absent.
    pub password: Option<Confidential<String>>,
}

impl Default for AdminConfig {
    fn default() -> Self {
        Self { user_name: "engineer".to_owned(), password: None }
    }
}

impl ConnectorConfig {
    /// Returns the faults that no single key shows: sentences that name the key and the remedy.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        faults.extend(self.plaintext_faults());
        if !(1..=60_000).contains(&self.reports.publishing_interval_ms) {
            faults.push("reports.publishing_interval_ms must lie between 1 and 60000".to_owned());
        }
        if self.admin.user_name.trim().is_empty() {
            faults.push("admin.user_name must not be empty".to_owned());
        }
        faults.extend(self.broker.faults());
        faults.extend(self.twin_config().faults().into_iter().map(|fault| format!("twin.{fault}")));
        faults
    }

    /// Returns what seals passwords in the store and opens them.
    #[must_use]
    pub fn sealer(&self) -> Sealer {
        Sealer::new(&self.sealing, &self.data_directory)
    }

    /// Returns the shortest time between two reports of one data set.
    #[must_use]
    pub fn publishing_interval(&self) -> Duration {
        Duration::from_millis(self.reports.publishing_interval_ms)
    }

    /// Returns the configuration of the twin, whose keys are in the data directory.
    #[must_use]
    pub fn twin_config(&self) -> TwinConfig {
        TwinConfig {
            listen: self.twin.listen,
            host_names: self.twin.host_names.clone(),
            pki_directory: self.data_directory.join("twin-pki"),
            security: self.twin.security.clone(),
            limits: self.twin.limits.clone(),
            discovery: self.twin.discovery.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_shows_the_defaults() {
        let example: ConnectorConfig =
            daemon::configuration::parse(None, EXAMPLE, "VERBUND", std::iter::empty())
                .expect("the example is valid");
        assert_eq!(format!("{example:?}"), format!("{:?}", ConnectorConfig::default()));
        let with_all = EXAMPLE.replace("#: ", "");
        let all: ConnectorConfig =
            daemon::configuration::parse(None, &with_all, "VERBUND", std::iter::empty())
                .expect("absent keys are valid");
        assert!(all.web.tls.is_some() && all.admin.password.is_some());
        assert!(all.broker.url.is_some() && all.broker.proxy.is_some());
        assert_eq!(all.broker.faults(), Vec::<String>::new());
    }

    #[test]
    fn cookies_are_for_tls_where_browsers_come_by_it() {
        let web = WebConfig::default();
        assert!(!web.is_secure());
        let proxied = WebConfig { public_url: Some("https://plant.example".into()), ..web.clone() };
        assert!(proxied.is_secure(), "a proxy speaks TLS");
        let files = TlsFiles { certificate: "cert.pem".into(), key: "key.pem".into() };
        let served = WebConfig { tls: Some(files), ..web };
        assert!(served.is_secure() && served.public_url(served.listen).starts_with("https://"));
    }

    #[test]
    fn an_open_page_without_tls_is_a_fault() {
        let mut config = ConnectorConfig::default();
        assert!(config.faults().is_empty());
        config.web.listen = "0.0.0.0:8090".parse().expect("an address");
        assert_eq!(config.faults().len(), 1);
    }

    #[test]
    fn the_twins_faults_are_named_with_its_section() {
        let mut config = ConnectorConfig::default();
        config.twin.discovery.local_discovery_server_url = Some("http://discovery".to_owned());
        config.twin.discovery.registration_interval_s = 1000;
        let faults = config.faults();
        assert_eq!(faults.len(), 2, "{faults:?}");
        assert!(faults.iter().all(|fault| fault.starts_with("twin.discovery.")), "{faults:?}");
    }
}
