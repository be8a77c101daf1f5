//! How to reach the broker.

use std::{fmt, str::FromStr, time::Duration};

use bytes::Bytes;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use zeroize::Zeroizing;

use crate::{address::LogicalAddress, profile::BrokerProfile, spool::ReplayShare};

/// Everything a [`Link`](crate::Link) needs to know. `LinkConfig::new` has sensible values for all but three of it.
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
    /// Names this process at an AMQP broker; unique per running instance. MQTT sessions go by the user's name.
    pub container_id: String,
    /// What to receive from the start; see [`LinkHandle::set_consumed`](crate::LinkHandle::set_consumed).
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
    /// Time that sent bytes may stay unacknowledged by the peer's kernel, so that a stall shows under load, too.
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

/// Where a broker listens: `amqps://host[:port]` or `mqtts://host[:port]`, without the `s` without TLS.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct BrokerUrl {
    scheme: Scheme,
    host: String,
    port: u16,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Scheme {
    Amqp,
    Amqps,
    Mqtt,
    Mqtts,
}

impl Scheme {
    const fn as_str(self) -> &'static str {
        match self {
            Self::Amqp => "amqp",
            Self::Amqps => "amqps",
            Self::Mqtt => "mqtt",
            Self::Mqtts => "mqtts",
        }
    }

    const fn default_port(self) -> u16 {
        match self {
            Self::Amqp => 5672,
            Self::Amqps => 5671,
            Self::Mqtt => 1883,
            Self::Mqtts => 8883,
        }
    }
}

/// Why a text is not a broker's address.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum InvalidBrokerUrl {
    /// Only some schemes are spoken.
    #[error("a broker's address begins with amqps://, amqp://, mqtts:// or mqtt://, but this is {found:?}")]
    Scheme {
        /// The text.
        found: String,
    },
    /// A proxy is spoken to in plain HTTP; the tunnel through it is encrypted where the broker's address says so.
    #[error("a proxy's address begins with http://, but this is {found:?}")]
    ProxyScheme {
        /// The text.
        found: String,
    },
    /// Nobody to call.
    #[error("the broker's address {found:?} has no host, or a port that is not a number up to 65535")]
    Authority {
        /// The text.
        found: String,
    },
    /// Credentials belong into their own settings, where they are not logged.
    #[error("a broker's address must not contain a user or password; they have settings of their own")]
    Credentials,
}

impl BrokerUrl {
    /// Whether the connection is encrypted.
    #[must_use]
    pub const fn is_encrypted(&self) -> bool {
        matches!(self.scheme, Scheme::Amqps | Scheme::Mqtts)
    }

    /// Whether the broker is spoken to in MQTT 5, not in AMQP 1.0.
    #[must_use]
    pub const fn is_mqtt(&self) -> bool {
        matches!(self.scheme, Scheme::Mqtt | Scheme::Mqtts)
    }

    /// The host name or address, without brackets.
    #[must_use]
    pub fn host(&self) -> &str {
        &self.host
    }

    /// The port.
    #[must_use]
    pub const fn port(&self) -> u16 {
        self.port
    }

    /// Whether the host can only be this machine.
    #[must_use]
    pub fn is_loopback(&self) -> bool {
        self.host == "localhost" || self.host.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
    }
}

impl FromStr for BrokerUrl {
    type Err = InvalidBrokerUrl;

    fn from_str(text: &str) -> Result<Self, InvalidBrokerUrl> {
        let (scheme, rest) = [Scheme::Amqps, Scheme::Amqp, Scheme::Mqtts, Scheme::Mqtt]
            .into_iter()
            .find_map(|s| Some((s, text.strip_prefix(s.as_str())?.strip_prefix("://")?)))
            .ok_or_else(|| InvalidBrokerUrl::Scheme { found: text.to_owned() })?;
        if rest.contains('@') {
            return Err(InvalidBrokerUrl::Credentials);
        }
        let (host, port) = authority(rest).ok_or_else(|| InvalidBrokerUrl::Authority { found: text.to_owned() })?;
        Ok(Self { scheme, host, port: port.unwrap_or_else(|| scheme.default_port()) })
    }
}

/// Host and port of `host[:port][/]`; none when there is no host or the port is no number.
fn authority(text: &str) -> Option<(String, Option<u16>)> {
    let text = text.strip_suffix('/').unwrap_or(text);
    let (host, port) = match text.strip_prefix('[') {
        Some(rest) => rest.split_once(']')?,
        None => text.find(':').map_or((text, ""), |at| text.split_at(at)),
    };
    let port = match port.strip_prefix(':') {
        Some(digits) => Some(digits.parse().ok()?),
        None if port.is_empty() => None,
        None => return None,
    };
    let is_host = !host.is_empty() && !host.contains(['/', '?', '#', ' ', '@']);
    is_host.then(|| (host.to_owned(), port))
}

/// An HTTP proxy that connects through (RFC 9110 §9.3.6): `http://host[:port]`.
#[derive(Debug, Clone)]
pub struct HttpProxy {
    pub(crate) host: String,
    pub(crate) port: u16,
    /// Who we are to the proxy, where it asks.
    pub login: Option<Login>,
}

impl HttpProxy {
    /// A proxy, with the credentials it asks for.
    ///
    /// # Errors
    /// [`InvalidBrokerUrl::ProxyScheme`] or [`InvalidBrokerUrl::Authority`] when the text is no such address.
    pub fn new(url: &str, login: Option<Login>) -> Result<Self, InvalidBrokerUrl> {
        let rest =
            url.strip_prefix("http://").ok_or_else(|| InvalidBrokerUrl::ProxyScheme { found: url.to_owned() })?;
        let (host, port) = authority(rest).ok_or_else(|| InvalidBrokerUrl::Authority { found: url.to_owned() })?;
        Ok(Self { host, port: port.unwrap_or(8080), login })
    }
}

impl fmt::Display for BrokerUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scheme, host, port } = self;
        if host.contains(':') {
            write!(f, "{}://[{host}]:{port}", scheme.as_str())
        } else {
            write!(f, "{}://{host}:{port}", scheme.as_str())
        }
    }
}

impl Serialize for BrokerUrl {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for BrokerUrl {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = std::borrow::Cow::<'de, str>::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn urls_are_read() {
        for (text, expected) in [
            ("amqps://broker.example", "amqps://broker.example:5671"),
            ("amqp://localhost/", "amqp://localhost:5672"),
            ("amqp://[::1]:1234", "amqp://[::1]:1234"),
            ("amqps://10.0.0.1:443", "amqps://10.0.0.1:443"),
        ] {
            assert_eq!(text.parse::<BrokerUrl>().expect(text).to_string(), expected);
        }
        for text in [
            "",
            "broker",
            "http://x",
            "amqp://",
            "amqp://:5672",
            "amqp://h:x",
            "amqp://h:70000",
            "amqp://u:p@h",
            "amqp://h/path",
            "amqp://[::1",
        ] {
            assert!(text.parse::<BrokerUrl>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_password_is_never_shown() {
        let shown = format!("{:?}", Login::new("f1", "canary"));
        assert!(shown.contains("f1") && !shown.contains("canary"));
    }

    #[test]
    fn limits_have_defaults_and_no_other_keys() {
        let limits: LinkLimits = serde_json::from_str(r#"{"window": 10, "backoff_max": 5000}"#).expect("limits");
        assert_eq!((limits.window, limits.backoff_max, limits.credit), (10, Duration::from_secs(5), 500));
        assert!(serde_json::from_str::<LinkLimits>(r#"{"windows": 10}"#).is_err());
    }
}
