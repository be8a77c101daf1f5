//! Addresses of brokers, and of the proxy on the way.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Login;

/// Where a broker listens: `amqps://host[:port]` or `mqtts://host[:port]`, and where nothing but
/// HTTPS gets out `amqp+wss://host[:port][/path]` or `mqtt+wss://host[:port][/path]`, inside a
/// WebSocket. Each without its last `s`: no TLS.
///
/// OPC 10000-14 writes `wss://` for both protocols, which a single address could not tell apart.
///
/// Without a path a WebSocket is asked for at `/` for AMQP, as ActiveMQ, Artemis, Qpid and the
/// embedded broker take it, and at `/mqtt` for MQTT, as EMQX, HiveMQ and VerneMQ do; Mosquitto
/// takes any. RabbitMQ wants `/ws` for both.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct BrokerUrl {
    scheme: Scheme,
    host: String,
    port: u16,
    /// Empty where there is no WebSocket.
    path: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Scheme {
    Amqp,
    Amqps,
    AmqpWs,
    AmqpWss,
    Mqtt,
    Mqtts,
    MqttWs,
    MqttWss,
}

impl Scheme {
    const ALL: [Self; 8] = [
        Self::Amqp,
        Self::Amqps,
        Self::AmqpWs,
        Self::AmqpWss,
        Self::Mqtt,
        Self::Mqtts,
        Self::MqttWs,
        Self::MqttWss,
    ];

    const fn as_str(self) -> &'static str {
        match self {
            Self::Amqp => "amqp",
            Self::Amqps => "amqps",
            Self::AmqpWs => "amqp+ws",
            Self::AmqpWss => "amqp+wss",
            Self::Mqtt => "mqtt",
            Self::Mqtts => "mqtts",
            Self::MqttWs => "mqtt+ws",
            Self::MqttWss => "mqtt+wss",
        }
    }

    const fn default_port(self) -> u16 {
        match self {
            Self::Amqp => 5672,
            Self::Amqps => 5671,
            Self::Mqtt => 1883,
            Self::Mqtts => 8883,
            Self::AmqpWs | Self::MqttWs => 80,
            Self::AmqpWss | Self::MqttWss => 443,
        }
    }

    const fn default_path(self) -> &'static str {
        match self {
            Self::AmqpWs | Self::AmqpWss => "/",
            Self::MqttWs | Self::MqttWss => "/mqtt",
            Self::Amqp | Self::Amqps | Self::Mqtt | Self::Mqtts => "",
        }
    }

    const fn is_encrypted(self) -> bool {
        matches!(self, Self::Amqps | Self::AmqpWss | Self::Mqtts | Self::MqttWss)
    }

    const fn is_mqtt(self) -> bool {
        matches!(self, Self::Mqtt | Self::Mqtts | Self::MqttWs | Self::MqttWss)
    }

    const fn is_websocket(self) -> bool {
        !self.default_path().is_empty()
    }
}

/// Why a text is not a broker's address.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum InvalidBrokerUrl {
    /// Only some schemes are spoken.
    #[error(
        "a broker's address begins with amqps:// or mqtts://, in a WebSocket with amqp+wss:// or mqtt+wss://, each without \
         its last s where there is no TLS, but this is {found:?}"
    )]
    Scheme {
        /// The text.
        found: String,
    },
    /// A proxy is spoken to in plain HTTP; the tunnel through it is encrypted where the broker's
    /// address says so.
    #[error("a proxy's address begins with http://, but this is {found:?}")]
    ProxyScheme {
        /// The text.
        found: String,
    },
    /// Nobody to call.
    #[error(
        "the broker's address {found:?} has no host, or a port that is not a number up to 65535"
    )]
    Authority {
        /// The text.
        found: String,
    },
    /// Only a WebSocket has a path.
    #[error(
        "the broker's address {found:?} has a path, but only amqp+wss:// and mqtt+wss:// have one; remove it"
    )]
    Path {
        /// The text.
        found: String,
    },
    /// No HTTP server could be asked for this.
    #[error(
        "the path of {found:?} must be written as in a URL, without blanks and #; write %20 for a blank"
    )]
    PathCharacters {
        /// The text.
        found: String,
    },
    /// Credentials belong into their own settings, where they are not logged.
    #[error(
        "the address of a broker or proxy must not contain a user or password; they have settings of their own"
    )]
    Credentials,
}

impl BrokerUrl {
    /// Whether the connection is encrypted.
    #[must_use]
    pub const fn is_encrypted(&self) -> bool {
        self.scheme.is_encrypted()
    }

    /// Whether the broker is spoken to in MQTT 5, not in AMQP 1.0.
    #[must_use]
    pub const fn is_mqtt(&self) -> bool {
        self.scheme.is_mqtt()
    }

    /// Path and query of the WebSocket that the broker is spoken to in, where it is.
    #[must_use]
    pub fn websocket_path(&self) -> Option<&str> {
        self.scheme.is_websocket().then_some(self.path.as_str())
    }

    /// Host and port as HTTP names them: the port only where it is not the usual one, IPv6
    /// addresses in brackets.
    pub(crate) fn http_authority(&self) -> String {
        let host = Bracketed(&self.host);
        if self.port == self.scheme.default_port() {
            host.to_string()
        } else {
            format!("{host}:{}", self.port)
        }
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
        self.host == "localhost"
            || self.host.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
    }
}

impl FromStr for BrokerUrl {
    type Err = InvalidBrokerUrl;

    fn from_str(text: &str) -> Result<Self, InvalidBrokerUrl> {
        let found = || text.to_owned();
        let (scheme, rest) = Scheme::ALL
            .into_iter()
            .find_map(|s| Some((s, text.strip_prefix(s.as_str())?.strip_prefix("://")?)))
            .ok_or_else(|| InvalidBrokerUrl::Scheme { found: found() })?;
        let (server, path) = rest.find('/').map_or((rest, ""), |at| rest.split_at(at));
        if server.contains('@') {
            return Err(InvalidBrokerUrl::Credentials);
        }
        let (host, port) =
            authority(server).ok_or_else(|| InvalidBrokerUrl::Authority { found: found() })?;
        if !scheme.is_websocket() && !matches!(path, "" | "/") {
            return Err(InvalidBrokerUrl::Path { found: found() });
        }
        if !path.bytes().all(|byte| byte.is_ascii_graphic() && !b"#\"<>\\^`{|}".contains(&byte)) {
            return Err(InvalidBrokerUrl::PathCharacters { found: found() });
        }
        let path =
            if !scheme.is_websocket() || path.is_empty() { scheme.default_path() } else { path };
        Ok(Self {
            scheme,
            host,
            port: port.unwrap_or_else(|| scheme.default_port()),
            path: path.to_owned(),
        })
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
    /// [`InvalidBrokerUrl::ProxyScheme`], [`InvalidBrokerUrl::Credentials`] or
    /// [`InvalidBrokerUrl::Authority`] when the text is no such address.
    pub fn new(url: &str, login: Option<Login>) -> Result<Self, InvalidBrokerUrl> {
        let rest = url
            .strip_prefix("http://")
            .ok_or_else(|| InvalidBrokerUrl::ProxyScheme { found: url.to_owned() })?;
        if rest.contains('@') {
            return Err(InvalidBrokerUrl::Credentials);
        }
        let (host, port) =
            authority(rest).ok_or_else(|| InvalidBrokerUrl::Authority { found: url.to_owned() })?;
        Ok(Self { host, port: port.unwrap_or(8080), login })
    }
}

impl fmt::Display for BrokerUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scheme, host, port, path } = self;
        write!(f, "{}://{}:{port}{path}", scheme.as_str(), Bracketed(host))
    }
}

/// A host as it stands in a URL.
struct Bracketed<'a>(&'a str);

impl fmt::Display for Bracketed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(host) = self;
        if host.contains(':') { write!(f, "[{host}]") } else { f.write_str(host) }
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
            ("mqtts://broker.example/", "mqtts://broker.example:8883"),
            ("amqp+wss://broker.example", "amqp+wss://broker.example:443/"),
            ("amqp+ws://[::1]/ws", "amqp+ws://[::1]:80/ws"),
            ("mqtt+wss://broker.example", "mqtt+wss://broker.example:443/mqtt"),
            ("mqtt+ws://localhost:9001/", "mqtt+ws://localhost:9001/"),
            ("amqp+wss://b:8443/a/b%20c?tenant=x@y", "amqp+wss://b:8443/a/b%20c?tenant=x@y"),
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
            "wss://h",
            "amqps+wss://h",
            "amqp+wss://",
            "amqp+wss:///path",
            "amqp+wss://u:p@h/",
            "amqp+wss://h?query",
            "amqp+wss://h/a b",
            "amqp+wss://h/a\r\nX-Evil: 1",
            "amqp+wss://h/a#b",
        ] {
            assert!(text.parse::<BrokerUrl>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_scheme_says_protocol_encryption_and_websocket() {
        for (scheme, is_mqtt, is_encrypted, path) in [
            ("amqp", false, false, None),
            ("amqps", false, true, None),
            ("amqp+ws", false, false, Some("/")),
            ("amqp+wss", false, true, Some("/")),
            ("mqtt", true, false, None),
            ("mqtts", true, true, None),
            ("mqtt+ws", true, false, Some("/mqtt")),
            ("mqtt+wss", true, true, Some("/mqtt")),
        ] {
            let url: BrokerUrl = format!("{scheme}://h").parse().expect(scheme);
            assert_eq!(
                (url.is_mqtt(), url.is_encrypted(), url.websocket_path()),
                (is_mqtt, is_encrypted, path),
                "{scheme}"
            );
            assert_eq!(url.http_authority(), "h", "{scheme}");
        }
        let other: BrokerUrl = "amqp+wss://[::1]:8443".parse().expect("an address");
        assert_eq!(other.http_authority(), "[::1]:8443");
    }

    #[test]
    fn a_password_in_an_address_is_not_repeated() {
        let broker =
            "amqp+wss://user:canary@h".parse::<BrokerUrl>().expect_err("credentials").to_string();
        let proxy =
            HttpProxy::new("http://user:canary@h:3128", None).expect_err("credentials").to_string();
        assert!(!broker.contains("canary") && !proxy.contains("canary"), "{broker} {proxy}");
    }

    #[test]
    fn what_is_wrong_with_a_path_is_told() {
        let told = |text: &str| text.parse::<BrokerUrl>().expect_err(text).to_string();
        assert!(told("amqps://h/path").contains("only amqp+wss:// and mqtt+wss:// have one"));
        assert!(told("amqp+wss://h/a b").contains("%20"));
        assert!(told("wss://h").contains("amqp+wss:// or mqtt+wss://"));
    }
}
