//! Ways to other machines without TLS: refused unless a section of the configuration allows them by name,
//! and then told at each start and on the page of the status.

use std::net::IpAddr;

use axum::http::Uri;
use serde::Serialize;
use utoipa::ToSchema;

/// An address of the configuration by which passwords and values leave this machine without TLS.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct PlaintextWay {
    /// Key with the address, as `web.listen`.
    pub key: String,
    pub address: String,
}

impl PlaintextWay {
    /// Names a way.
    #[must_use]
    pub fn new(key: impl Into<String>, address: impl ToString) -> Self {
        Self { key: key.into(), address: address.to_string() }
    }

    /// Returns the fault of a configuration that does not allow the way; `section` has the key that does.
    #[must_use]
    pub fn fault(&self, section: &str, remedy: &str) -> String {
        let Self { key, address } = self;
        format!(
            "{key}: {address} leads to other machines without TLS, where others read passwords and values; {remedy}, or set \
             {section}.allow_plaintext = true"
        )
    }
}

/// Warns of each way that is allowed, at the start of a daemon, and returns them.
#[must_use]
pub fn warned(ways: Vec<PlaintextWay>) -> Vec<PlaintextWay> {
    for PlaintextWay { key, address } in &ways {
        tracing::warn!(
            key,
            address,
            "Passwords and values go to other machines WITHOUT TLS here, as allow_plaintext allows. Anybody on the way reads \
             and changes them."
        );
    }
    ways
}

/// Use of an HTTP address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HttpWay {
    /// With TLS, or on this machine.
    Safe,
    /// Plain HTTP to another machine.
    Plaintext,
    /// No address of an HTTP server.
    Invalid,
}

/// Returns whether an address of an HTTP server is safe for secrets.
#[must_use]
pub fn http_way(address: &str) -> HttpWay {
    let Ok(uri) = address.parse::<Uri>() else { return HttpWay::Invalid };
    match (uri.scheme_str(), uri.host()) {
        (Some("https"), Some(_)) => HttpWay::Safe,
        (Some("http"), Some(host)) if is_loopback(host) => HttpWay::Safe,
        (Some("http"), Some(_)) => HttpWay::Plaintext,
        _ => HttpWay::Invalid,
    }
}

fn is_loopback(host: &str) -> bool {
    let address = host.trim_start_matches('[').trim_end_matches(']');
    host.eq_ignore_ascii_case("localhost")
        || address.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_http_is_safe_on_this_machine_alone() {
        for (address, way) in [
            ("https://verbund.example", HttpWay::Safe),
            ("https://verbund.example:8443/path", HttpWay::Safe),
            ("http://127.0.0.1:8080", HttpWay::Safe),
            ("http://[::1]:8080", HttpWay::Safe),
            ("http://localhost", HttpWay::Safe),
            ("http://verbund.example", HttpWay::Plaintext),
            ("HTTP://verbund.example", HttpWay::Plaintext),
            ("http://10.0.0.1:80", HttpWay::Plaintext),
            ("http://localhost.example", HttpWay::Plaintext),
            ("http://127.0.0.1.example", HttpWay::Plaintext),
            ("http://127.0.0.1@verbund.example", HttpWay::Plaintext),
            ("http://[2001:db8::1]", HttpWay::Plaintext),
            ("ftp://verbund.example", HttpWay::Invalid),
            ("verbund.example", HttpWay::Invalid),
            ("", HttpWay::Invalid),
        ] {
            assert_eq!(http_way(address), way, "{address}");
        }
    }
}
