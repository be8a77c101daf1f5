//! Configuration of the platform. `platform.example.toml` shows every key with its default; a test
//! compares the two.

mod broker_passwords;
mod plaintext;
mod web;

use std::{
    net::{Ipv4Addr, SocketAddr},
    path::PathBuf,
    time::Duration,
};

use asi_model::OrganisationId;
use broker::AddressPattern;
pub use broker_passwords::{
    BROKER_PASSWORD_CHARACTERS_MIN, BrokerPasswordError, PasswordSealing, sealed_line,
};
use daemon::{
    Confidential,
    client_certificate::ClientCertificateFiles,
    sealing::{Sealer, SealingConfig},
    telemetry::LogConfig,
};
use messaging::{BrokerProfile, BrokerUrl};
use serde::{Deserialize, Deserializer};
pub use web::WebConfig;

/// The commented example, also printed by `platform config example`.
pub const EXAMPLE: &str = include_str!("../platform.example.toml");

/// Everything the platform needs to know.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlatformConfig {
    /// Folder of the database, the broker's store and the certificate authority, on a local disk.
    pub data_directory: PathBuf,
    /// Use the folder although group or others may enter it.
    pub allow_shared_data_directory: bool,
    /// Key that seals secrets in the database.
    pub sealing: SealingConfig,
    /// Pages and API.
    pub web: WebConfig,
    /// The broker, embedded or another.
    pub broker: BrokerSettings,
    /// The first administrator.
    pub admin: AdminConfig,
    pub receipts: ReceiptConfig,
    /// Sending parts of networks.
    pub parts: PartConfig,
    /// Leases, by which one of several connectors speaks for a factory.
    pub leases: LeaseConfig,
    pub retention: RetentionConfig,
    pub log: LogConfig,
}

impl Default for PlatformConfig {
    fn default() -> Self {
        Self {
            data_directory: PathBuf::from("platform-data"),
            allow_shared_data_directory: false,
            sealing: SealingConfig::default(),
            web: WebConfig::default(),
            broker: BrokerSettings::default(),
            admin: AdminConfig::default(),
            receipts: ReceiptConfig::default(),
            parts: PartConfig::default(),
            leases: LeaseConfig::default(),
            retention: RetentionConfig::default(),
            log: LogConfig::default(),
        }
    }
}

/// Listeners and certificate of the embedded broker, and the address that connectors get.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BrokerSettings {
    /// Address of the embedded broker's TLS listener.
    pub listen: SocketAddr,
    /// Address of a listener without TLS, in addition; loopback only.
    pub plain_listen: Option<SocketAddr>,
    /// Listener for AMQP in WebSockets, in addition; with TLS and the same certificate.
    pub websocket_listen: Option<SocketAddr>,
    /// Run the embedded broker in the platform's own process, not in one that it watches.
    pub in_process: bool,
    /// URL of the broker for connectors, handed out at enrolment.
    pub public_url: Option<BrokerUrl>,
    /// Send connectors and tools to a public URL without TLS.
    pub allow_plaintext: bool,
    /// Names and addresses that the embedded broker's certificate is for, beside localhost.
    pub host_names: Vec<String>,
    /// Further users of the embedded broker, as for other programs.
    pub users: Vec<BrokerUserConfig>,
    /// Another broker instead of the embedded one.
    pub external: Option<ExternalBrokerConfig>,
}

impl Default for BrokerSettings {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 5671)),
            plain_listen: None,
            websocket_listen: None,
            in_process: false,
            public_url: None,
            allow_plaintext: false,
            host_names: Vec::new(),
            users: Vec::new(),
            external: None,
        }
    }
}

/// A user of the embedded broker beside connectors and tools.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BrokerUserConfig {
    /// The name to sign in with.
    pub user_name: String,
    /// A random secret of at least 128 bits.
    pub password: Confidential<String>,
    /// Patterns of addresses that it may receive from.
    #[serde(default, deserialize_with = "patterns")]
    pub consume: Vec<AddressPattern>,
    /// Patterns of addresses that it may send to.
    #[serde(default, deserialize_with = "patterns")]
    pub produce: Vec<AddressPattern>,
}

fn patterns<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<AddressPattern>, D::Error> {
    let texts = Vec::<String>::deserialize(deserializer)?;
    texts.iter().map(|text| text.parse().map_err(serde::de::Error::custom)).collect()
}

/// A broker of another make.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExternalBrokerConfig {
    /// Its addresses; the next one is tried when one fails.
    pub urls: Vec<BrokerUrl>,
    /// Speak with a broker on another machine without TLS.
    #[serde(default)]
    pub allow_plaintext: bool,
    /// Names of logical addresses there: `rabbitmq-3`, `mqtt`, `rabbitmq-4` (untested), `activemq` (untested) or own
    /// templates.
    pub profile: BrokerProfile,
    /// The platform's user there.
    pub user_name: String,
    /// File with a line `user_name password` for each account there, the platform's included, readable for the
    /// platform's user alone. It is read again for each use; the platform seals what is in plain text there.
    #[serde(default)]
    pub password_file: Option<PathBuf>,
    /// The platform's password, where the file has none.
    #[serde(default)]
    pub password: Option<Confidential<String>>,
    /// PEM file with the authorities that may vouch for it; the system's where absent.
    #[serde(default)]
    pub root_certificates: Option<PathBuf>,
    /// Certificate and key by which the platform is known there, beside user name and password.
    #[serde(default)]
    pub client_certificate: Option<ClientCertificateFiles>,
    /// The accounts of connectors and tools there that the file does not have; enrolment hands them out.
    #[serde(default)]
    pub accounts: Vec<ExternalAccountConfig>,
}

/// An account of a connector or tool on a broker of another make.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExternalAccountConfig {
    /// `factory.<factoryId>` or `tool.<toolId>`; also the name to sign in with.
    pub user_name: String,
    /// A random secret of at least 128 bits.
    pub password: Confidential<String>,
}

/// The first administrator.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AdminConfig {
    /// The name to sign in with.
    pub user_name: String,
    /// The password. Where it is absent and there is no user yet, one is made up and written to a
    /// file in the data directory that only the platform's user can read.
    pub password: Option<Confidential<String>>,
    /// The organisation the administrator also looks for, if any.
    pub organisation_id: Option<OrganisationId>,
}

impl Default for AdminConfig {
    fn default() -> Self {
        Self { user_name: "admin".to_owned(), password: None, organisation_id: None }
    }
}

/// Frequency of the receipts that connectors get.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReceiptConfig {
    /// Time between two receipts to a factory while there are new reports, in milliseconds.
    pub interval_ms: u64,
}

impl Default for ReceiptConfig {
    fn default() -> Self {
        Self { interval_ms: 10_000 }
    }
}

/// Sending parts of networks.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PartConfig {
    /// Time after which an unanswered part is sent again, in milliseconds; doubles with each time,
    /// up to an hour.
    pub resend_after_ms: u64,
}

impl Default for PartConfig {
    fn default() -> Self {
        Self { resend_after_ms: 60_000 }
    }
}

/// Leases, by which one of several connectors speaks for a factory.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LeaseConfig {
    /// Time without a sign of a connector after which its successor on another machine gets its
    /// lease, in milliseconds. Connectors renew in a third of it.
    pub silence_ms: u64,
}

impl Default for LeaseConfig {
    fn default() -> Self {
        Self { silence_ms: 30_000 }
    }
}

/// Retention periods.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RetentionConfig {
    /// Retention of messages as they came, in days. Reports themselves are retained.
    pub inbox_days: u32,
    /// Most MiB of messages and reports kept of one factory. Beyond, its messages wait at the broker.
    pub kept_mib_per_factory: u32,
    /// Most MiB of messages kept of one tool, likewise.
    pub kept_mib_per_tool: u32,
    /// Lifetime of an enrolment token, in hours.
    pub enrolment_token_hours: u32,
    /// Retention of the record of who read a factory's values, in days.
    pub access_days: u32,
    /// Retention of the record of who changed what, in days.
    pub audit_days: u32,
}

impl Default for RetentionConfig {
    fn default() -> Self {
        Self {
            inbox_days: 14,
            kept_mib_per_factory: 200_000,
            kept_mib_per_tool: 4_000,
            enrolment_token_hours: 24,
            access_days: 1_095,
            audit_days: 1_095,
        }
    }
}

impl PlatformConfig {
    /// Returns faults beyond the form, as sentences that name key and remedy.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        if self.broker.plain_listen.is_some_and(|address| !address.ip().is_loopback()) {
            faults.push(
                "broker.plain_listen: only a loopback address may go without TLS; use 127.0.0.1 or remove the key"
                    .to_owned(),
            );
        }
        if let (None, Some(url)) = (&self.broker.external, &self.broker.public_url) {
            if url.is_mqtt() {
                faults.push(
                    "broker.public_url: the embedded broker speaks AMQP; write amqps:// or amqp+wss://, or set \
                     broker.external"
                        .to_owned(),
                );
            } else if url.websocket_path().is_some() && self.broker.websocket_listen.is_none() {
                faults.push(
                    "broker.public_url: nobody takes WebSockets there; set broker.websocket_listen, too".to_owned(),
                );
            }
        }
        faults.extend(self.address_faults());
        let external = self.broker.external.as_ref();
        faults.extend(external.map(ExternalBrokerConfig::password_faults).unwrap_or_default());
        for user in &self.broker.users {
            if user.password.expose().len() < 16 {
                faults.push(format!(
                    "broker.users: the password of {} needs at least 16 characters",
                    user.user_name
                ));
            }
        }
        if self.broker.external.as_ref().is_some_and(|external| external.urls.is_empty()) {
            faults.push("broker.external.urls: name at least one address".to_owned());
        }
        if self.receipts.interval_ms == 0 {
            faults.push("receipts.interval_ms: must be at least 1".to_owned());
        }
        let RetentionConfig { kept_mib_per_factory, kept_mib_per_tool, .. } = self.retention;
        if kept_mib_per_factory == 0 || kept_mib_per_tool == 0 {
            faults.push(
                "retention.kept_mib_per_factory and kept_mib_per_tool: must be at least 1"
                    .to_owned(),
            );
        }
        if self.leases.silence_ms < 300 {
            faults.push("leases.silence_ms: must be at least 300".to_owned());
        }
        faults
    }

    /// Returns what to say of a broker with which nothing was tried.
    #[must_use]
    pub fn untested_broker(&self) -> Option<String> {
        let profile = &self.broker.external.as_ref()?.profile;
        (!profile.is_tested()).then(|| {
            format!(
                "broker.external.profile {}: untested. Verbund is tested with its own broker, RabbitMQ 3 (rabbitmq-3) and \
                 Mosquitto (mqtt); try loss, redelivery and rights before you rely on this one.",
                profile.name()
            )
        })
    }

    /// Returns what to say of a broker that may drop messages.
    #[must_use]
    pub fn dropping_broker(&self) -> Option<String> {
        let external = self.broker.external.as_ref()?;
        external.urls.iter().any(BrokerUrl::is_mqtt).then(|| {
            "broker.external.urls: an MQTT broker drops messages beyond its bound of queued bytes without a word. Reports are \
             asked for again; decisions, revocations and comments are not. Give it room for the longest outage, and let it \
             store each change at once, as `platform definitions mosquitto` says."
                .to_owned()
        })
    }

    /// Returns what to say of a configuration that is valid, before the start and at it.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let notes = [self.untested_broker(), self.dropping_broker(), self.web.unpinned_tokens()];
        notes.into_iter().flatten().collect()
    }

    /// Time between receipts.
    #[must_use]
    pub const fn receipt_interval(&self) -> Duration {
        Duration::from_millis(self.receipts.interval_ms)
    }

    /// Returns the time after which a silent connector may lose its lease.
    #[must_use]
    pub const fn lease_silence(&self) -> Duration {
        Duration::from_millis(self.leases.silence_ms)
    }

    /// Returns what seals secrets in the database and opens them.
    #[must_use]
    pub fn sealer(&self) -> Sealer {
        Sealer::new(&self.sealing, &self.data_directory)
    }

    /// Returns the path of the database.
    #[must_use]
    pub fn database_path(&self) -> PathBuf {
        self.data_directory.join("platform.sqlite")
    }

    /// Returns the path of the embedded broker's database.
    #[must_use]
    pub fn broker_database_path(&self) -> PathBuf {
        self.data_directory.join("broker.sqlite")
    }

    /// Returns the certificate authority's folder.
    #[must_use]
    pub fn authority_directory(&self) -> PathBuf {
        self.data_directory.join("certificates")
    }
}

#[cfg(test)]
mod tests;
