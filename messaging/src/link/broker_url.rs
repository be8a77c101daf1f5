//! Addresses of brokers, and of the proxy on the way.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Login;

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
}
