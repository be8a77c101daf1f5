//! Addresses of brokers.

use std::{fmt, str::FromStr};

use crate::text_form::serde_as_text;

/// Address of a broker: `amqps://host[:port]` or `mqtts://host[:port]`, or inside a WebSocket
/// `amqp+wss://host[:port][/path]` or `mqtt+wss://host[:port][/path]`, where a firewall passes
/// nothing but HTTPS. Each scheme without its last `s` is the same without TLS.
///
/// OPC 10000-14 writes `wss://` for both protocols; with that scheme alone the protocol of an
/// address would be unknown.
///
/// The default path of a WebSocket is `/` for AMQP, as ActiveMQ, Artemis, Qpid and the embedded
/// broker expect it, and `/mqtt` for MQTT, as EMQX, HiveMQ and VerneMQ do. Mosquitto accepts any
/// path; RabbitMQ needs `/ws` for both.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct BrokerUrl {
    scheme: Scheme,
    host: String,
    port: u16,
    /// Path and query of the WebSocket; empty without one.
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

/// Fault of a text that is no address of a broker or proxy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum InvalidBrokerUrl {
    #[error(
        "a broker's address begins with amqps:// or mqtts://, in a WebSocket with amqp+wss:// or \
         mqtt+wss://, each without its last s where there is no TLS, but this is {found:?}"
    )]
    Scheme { found: String },
    /// A proxy is addressed in plain HTTP; the tunnel through it is encrypted where the broker's
    /// address says so.
    #[error("a proxy's address begins with http://, but this is {found:?}")]
    ProxyScheme { found: String },
    #[error(
        "the broker's address {found:?} has no host, or a port that is not a number up to 65535"
    )]
    Authority { found: String },
    /// A path stands in the address of a WebSocket alone.
    #[error(
        "the broker's address {found:?} has a path, but only amqp+wss:// and mqtt+wss:// have \
         one; remove it"
    )]
    Path { found: String },
    /// The path contains characters that no HTTP request line may contain.
    #[error(
        "the path of {found:?} must be written as in a URL, without blanks and #; write %20 for \
         a blank"
    )]
    PathCharacters { found: String },
    /// Credentials have settings of their own, which are not logged. The text is not repeated.
    #[error(
        "the address of a broker or proxy must not contain a user or password; they have \
         settings of their own"
    )]
    Credentials,
}

impl BrokerUrl {
    /// Returns whether the connection uses TLS.
    #[must_use]
    pub const fn is_encrypted(&self) -> bool {
        self.scheme.is_encrypted()
    }

    /// Returns whether the protocol is MQTT 5; AMQP 1.0 otherwise.
    #[must_use]
    pub const fn is_mqtt(&self) -> bool {
        self.scheme.is_mqtt()
    }

    /// Path and query of the WebSocket; none where the protocol runs directly on TCP or TLS.
    #[must_use]
    pub fn websocket_path(&self) -> Option<&str> {
        self.scheme.is_websocket().then_some(self.path.as_str())
    }

    /// Host and port as in an HTTP Host header: the port only where it is not the scheme's default,
    /// IPv6 addresses in brackets.
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

    /// The TCP port, explicit or the scheme's default.
    #[must_use]
    pub const fn port(&self) -> u16 {
        self.port
    }

    /// Returns whether the host is this machine by its name or address alone.
    #[must_use]
    pub fn is_loopback(&self) -> bool {
        is_loopback(&self.host)
    }
}

/// Returns whether a host is this machine.
pub(super) fn is_loopback(host: &str) -> bool {
    host == "localhost" || host.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
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

/// Parses `host[:port][/]`; none when the host is missing or the port is not a number.
pub(super) fn authority(text: &str) -> Option<(String, Option<u16>)> {
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

impl fmt::Display for BrokerUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scheme, host, port, path } = self;
        write!(f, "{}://{}:{port}{path}", scheme.as_str(), Bracketed(host))
    }
}

/// A host as written in a URL: IPv6 addresses in brackets.
struct Bracketed<'a>(&'a str);

impl fmt::Display for Bracketed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(host) = self;
        if host.contains(':') { write!(f, "[{host}]") } else { f.write_str(host) }
    }
}

serde_as_text!(BrokerUrl);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_ports_and_paths_are_filled_in() {
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
    }

    #[test]
    fn texts_without_scheme_host_or_port_number_are_refused() {
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
    fn the_scheme_determines_protocol_encryption_and_websocket() {
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
            assert_eq!(url.is_mqtt(), is_mqtt, "{scheme}");
            assert_eq!(url.is_encrypted(), is_encrypted, "{scheme}");
            assert_eq!(url.websocket_path(), path, "{scheme}");
            assert_eq!(url.http_authority(), "h", "{scheme}");
        }
        let other: BrokerUrl = "amqp+wss://[::1]:8443".parse().expect("an address");
        assert_eq!(other.http_authority(), "[::1]:8443");
    }

    #[test]
    fn a_password_in_an_address_is_not_repeated_in_the_error() {
        let error = "amqp+wss://user:canary@h".parse::<BrokerUrl>().expect_err("credentials");
        assert!(!error.to_string().contains("canary"), "{error}");
    }

    #[test]
    fn an_error_contains_the_form_of_an_address() {
        for (text, advice) in [
            ("amqps://h/path", "only amqp+wss:// and mqtt+wss:// have one"),
            ("amqp+wss://h/a b", "%20"),
            ("wss://h", "amqp+wss:// or mqtt+wss://"),
        ] {
            let error = text.parse::<BrokerUrl>().expect_err(text).to_string();
            assert!(error.contains(advice), "{error}");
        }
    }
}
