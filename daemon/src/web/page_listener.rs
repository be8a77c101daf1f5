//! Listener of pages as it is configured: the ways to it without TLS, and the clients that it serves.

use std::net::SocketAddr;

use crate::{
    plaintext::{HttpWay, PlaintextWay, http_way},
    web::address_range::AddressRange,
};

/// Remedy for a public address.
const URL_REMEDY: &str = "write https://";
/// Remedy for a listener that is open to other machines.
const LISTENER_REMEDY: &str =
    "set web.tls, or listen on 127.0.0.1 behind a proxy on this machine that speaks TLS";
/// Remedy for a proxy on another machine: its TLS ends there.
const PROXY_REMEDY: &str = "set web.tls, so that the proxy speaks TLS with this machine, too, or run it on this \
                            machine and listen on 127.0.0.1";

/// Listener of pages and API, with what is in front of it.
#[derive(Debug, Clone, Copy)]
pub struct PageListener<'a> {
    pub listen: SocketAddr,
    /// True where it has a certificate of its own.
    pub has_tls: bool,
    pub public_url: Option<&'a str>,
    pub trusted_proxies: &'a [AddressRange],
}

impl PageListener<'_> {
    /// Returns the ways to it from other machines without TLS, each with its remedy.
    #[must_use]
    pub fn plain_ways(&self) -> Vec<(PlaintextWay, &'static str)> {
        let public_url = self.public_url.filter(|url| http_way(url) == HttpWay::Plaintext);
        if let Some(url) = public_url {
            return vec![(PlaintextWay::new("web.public_url", url), URL_REMEDY)];
        }
        if !self.is_open() {
            return Vec::new();
        }
        if !self.is_behind_tls() {
            return vec![(PlaintextWay::new("web.listen", self.listen), LISTENER_REMEDY)];
        }
        let remote = self.trusted_proxies.iter().filter(|range| !range.is_loopback());
        let way =
            |range: &AddressRange| (PlaintextWay::new("web.trusted_proxies", range), PROXY_REMEDY);
        remote.map(way).collect()
    }

    /// Returns the faults of its proxies: those that are too many to be believed.
    #[must_use]
    pub fn proxy_faults(&self) -> Vec<String> {
        let wide = self.trusted_proxies.iter().filter(|range| range.is_beyond_proxies());
        let fault = |range: &AddressRange| {
            format!(
                "web.trusted_proxies: {range} is too wide, so that strangers would be believed about their address; \
                 name the proxies, or a network of at least /8 (IPv4) or /16 (IPv6)"
            )
        };
        wide.map(fault).collect()
    }

    /// Returns true where the named proxies, and this machine itself, are served alone: without TLS of its own,
    /// an open listener is for the proxy that has it. A word that allows plaintext changes nothing of that.
    #[must_use]
    pub fn serves_proxies_alone(&self) -> bool {
        self.is_open() && !self.trusted_proxies.is_empty()
    }

    /// Returns true where other machines reach it without TLS.
    const fn is_open(&self) -> bool {
        !self.has_tls && !self.listen.ip().is_loopback()
    }

    /// Returns true where a proxy that is named speaks TLS. An address with `https` alone proves none: whatever it
    /// says, passwords reach an open listener as they were sent.
    fn is_behind_tls(&self) -> bool {
        let is_https = self.public_url.is_some_and(|url| url.starts_with("https://"));
        is_https && !self.trusted_proxies.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HTTPS: Option<&str> = Some("https://verbund.example");

    fn ranges(proxies: &[&str]) -> Vec<AddressRange> {
        proxies.iter().map(|text| text.parse().expect("a range")).collect()
    }

    fn listener<'a>(
        listen: &str,
        public_url: Option<&'a str>,
        trusted_proxies: &'a [AddressRange],
    ) -> PageListener<'a> {
        let listen = listen.parse().expect("an address");
        PageListener { listen, has_tls: false, public_url, trusted_proxies }
    }

    #[test]
    fn a_proxy_on_another_machine_is_a_way_without_tls() {
        for (listen, public_url, proxies, ways) in [
            (
                "0.0.0.0:80",
                HTTPS,
                &["10.0.0.7", "127.0.0.1", "10.1.0.0/16"][..],
                &["10.0.0.7/32", "10.1.0.0/16"][..],
            ),
            ("0.0.0.0:80", HTTPS, &["127.0.0.1", "::1"], &[]),
            ("127.0.0.1:80", HTTPS, &["10.0.0.7"], &[]),
            ("0.0.0.0:80", HTTPS, &[], &["0.0.0.0:80"]),
            ("0.0.0.0:80", None, &["10.0.0.7"], &["0.0.0.0:80"]),
            ("0.0.0.0:80", Some("http://a.example"), &["10.0.0.7"], &["http://a.example"]),
            ("127.0.0.1:80", None, &[], &[]),
        ] {
            let proxies = ranges(proxies);
            let plain = listener(listen, public_url, &proxies);
            let addresses: Vec<_> =
                plain.plain_ways().into_iter().map(|(way, _)| way.address).collect();
            assert_eq!(addresses, ways, "{plain:?}");
            if public_url == HTTPS {
                let with_tls = PageListener { has_tls: true, ..plain };
                assert_eq!(with_tls.plain_ways(), [], "{with_tls:?}");
            }
        }
    }

    #[test]
    fn an_open_listener_without_tls_serves_its_proxies_alone() {
        for (listen, proxies, is_alone) in [
            ("0.0.0.0:80", &["10.0.0.7"][..], true),
            ("0.0.0.0:80", &["127.0.0.1"], true),
            ("0.0.0.0:80", &[], false),
            ("127.0.0.1:80", &["10.0.0.7"], false),
        ] {
            let proxies = ranges(proxies);
            let plain = listener(listen, HTTPS, &proxies);
            assert_eq!(plain.serves_proxies_alone(), is_alone, "{plain:?}");
            let with_tls = PageListener { has_tls: true, ..plain };
            assert!(!with_tls.serves_proxies_alone(), "{with_tls:?}");
        }
    }

    #[test]
    fn the_whole_world_is_no_proxy() {
        let proxies = ranges(&["0.0.0.0/0", "10.0.0.0/8", "::/0", "2001:db8::/32"]);
        let faults = listener("127.0.0.1:80", HTTPS, &proxies).proxy_faults();
        assert_eq!(faults.len(), 2, "{faults:?}");
        for (fault, range) in faults.iter().zip(["0.0.0.0/0", "::/0"]) {
            assert!(fault.starts_with(&format!("web.trusted_proxies: {range} ")), "{fault}");
        }
    }
}
