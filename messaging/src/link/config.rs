//! How to reach the broker.

use std::{fmt, time::Duration};

use bytes::Bytes;
use serde::{Deserialize, Serialize};
use zeroize::Zeroizing;

use super::broker_url::{BrokerUrl, HttpProxy};
use crate::{address::LogicalAddress, profile::BrokerProfile, spool::ReplayShare};

/// Everything a [`Link`](crate::Link) needs to know. `LinkConfig::new` has sensible values for all
/// but three of it.
#[derive(Debug, Clone)]
pub struct LinkConfig {
    /// The broker's addresses; the next one is tried when one fails. Never empty.
    pub brokers: Vec<BrokerUrl>,
    /// What logical addresses are called there.
    pub profile: BrokerProfile,
    /// Who we are.
    pub login: Login,
    /// Whom we trust, where the URL asks for TLS.
    pub tls: TlsConfig,
    /// The HTTP proxy on the way, if there is one.
    pub proxy: Option<HttpProxy>,
    /// Names this process at an AMQP broker; unique per running instance. MQTT sessions go by the
    /// user's name.
    pub container_id: String,
    /// What to receive from the start; see
    /// [`LinkHandle::set_consumed`](crate::LinkHandle::set_consumed).
    pub consumed: Vec<LogicalAddress>,
    /// Bounds and times.
    pub limits: LinkLimits,
}

impl LinkConfig {
    /// A link to one embedded broker, trusting the system's roots.
    #[must_use]
    pub fn new(broker: BrokerUrl, login: Login, container_id: impl Into<String>) -> Self {
        Self {
            brokers: vec![broker],
            profile: BrokerProfile::default(),
            login,
            tls: TlsConfig::default(),
            proxy: None,
            container_id: container_id.into(),
            consumed: Vec::new(),
            limits: LinkLimits::default(),
        }
    }
}

/// A user of the broker, SASL PLAIN.
#[derive(Clone)]
pub struct Login {
    /// The user's name.
    pub user_name: String,
    /// The password; wiped from memory when dropped, never shown.
    pub password: Zeroizing<String>,
}

impl Login {
    /// A user and password.
    #[must_use]
    pub fn new(user_name: impl Into<String>, password: impl Into<String>) -> Self {
        Self { user_name: user_name.into(), password: Zeroizing::new(password.into()) }
    }
}

impl fmt::Debug for Login {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Login").field("user_name", &self.user_name).finish_non_exhaustive()
    }
}

/// Whom to trust and how to prove oneself on TLS.
#[derive(Debug, Clone, Default)]
pub struct TlsConfig {
    /// The certificate authorities that may vouch for the broker.
    pub roots: Roots,
    /// A client certificate, where the broker asks for one.
    pub identity: Option<ClientIdentity>,
    /// The name expected in the broker's certificate, where it differs from the URL's host.
    pub server_name: Option<String>,
}

/// Certificate authorities.
#[derive(Debug, Clone, Default)]
pub enum Roots {
    /// Those of the operating system.
    #[default]
    System,
    /// Only these, as PEM.
    Pem(Bytes),
}

/// A client certificate with its key.
#[derive(Clone)]
pub struct ClientIdentity {
    /// The chain, leaf first, as PEM.
    pub certificates_pem: Bytes,
    /// The private key, as PEM; wiped from memory when dropped.
    pub key_pem: Zeroizing<Vec<u8>>,
}

impl fmt::Debug for ClientIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ClientIdentity").finish_non_exhaustive()
    }
}

/// Bounds and times of a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields, default)]
pub struct LinkLimits {
    /// Messages sent whose outcome is not known yet, over all addresses.
    pub window: usize,
    /// Messages the broker may have on the way to us, per address.
    pub credit: u32,
    /// Messages handed to the inbox at once, at most.
    pub batch: usize,
    /// Largest message taken, in bytes.
    pub message_bytes_max: u64,
    /// Share of the traffic that a backlog gets while live reports wait.
    pub replay_share: ReplayShare,
    /// Time to resolve, connect and authenticate.
    #[serde(with = "millis")]
    pub connect_timeout: Duration,
    /// Time for the broker to answer an attach or a message.
    #[serde(with = "millis")]
    pub outcome_timeout: Duration,
    /// Silence after which the connection counts as dead.
    #[serde(with = "millis")]
    pub idle_timeout: Duration,
    /// Time that sent bytes may stay unacknowledged by the peer's kernel, so that a stall shows
    /// under load, too.
    #[serde(with = "millis")]
    pub stall_timeout: Duration,
    /// First pause before a new attempt; doubles up to `backoff_max`, with jitter.
    #[serde(with = "millis")]
    pub backoff_min: Duration,
    /// Longest pause after passing errors.
    #[serde(with = "millis")]
    pub backoff_max: Duration,
    /// Pause after errors that will not pass by themselves, as bad credentials.
    #[serde(with = "millis")]
    pub backoff_permanent: Duration,
    /// Pause of one address whose queue is full or which is refused.
    #[serde(with = "millis")]
    pub address_rest: Duration,
}

impl Default for LinkLimits {
    fn default() -> Self {
        Self {
            window: 500,
            credit: 500,
            batch: 100,
            message_bytes_max: 2 * 1024 * 1024,
            replay_share: ReplayShare::default(),
            connect_timeout: Duration::from_secs(10),
            outcome_timeout: Duration::from_secs(30),
            idle_timeout: Duration::from_secs(30),
            stall_timeout: Duration::from_secs(20),
            backoff_min: Duration::from_millis(200),
            backoff_max: Duration::from_secs(30),
            backoff_permanent: Duration::from_secs(120),
            address_rest: Duration::from_secs(5),
        }
    }
}

/// Durations as whole milliseconds.
mod millis {
    use std::time::Duration;

    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(value: &Duration, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(u64::try_from(value.as_millis()).unwrap_or(u64::MAX))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Duration, D::Error> {
        u64::deserialize(deserializer).map(Duration::from_millis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_is_never_shown() {
        let shown = format!("{:?}", Login::new("f1", "canary"));
        assert!(shown.contains("f1") && !shown.contains("canary"));
    }

    #[test]
    fn limits_have_defaults_and_no_other_keys() {
        let limits: LinkLimits =
            serde_json::from_str(r#"{"window": 10, "backoff_max": 5000}"#).expect("limits");
        assert_eq!(
            (limits.window, limits.backoff_max, limits.credit),
            (10, Duration::from_secs(5), 500)
        );
        assert!(serde_json::from_str::<LinkLimits>(r#"{"windows": 10}"#).is_err());
    }
}
