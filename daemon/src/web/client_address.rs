//! Address of the client of a request, also behind proxies.

use std::{
    net::{IpAddr, Ipv4Addr, SocketAddr},
    sync::Arc,
};

use axum::{
    Router,
    extract::{ConnectInfo, FromRequestParts, Request},
    http::{HeaderMap, header::FORWARDED, request::Parts},
    middleware::{self, Next},
};
use serde::Deserialize;

use super::{address_range::AddressRange, in_flight::InFlight, problem::Problem};

/// Most addresses of a header that are looked at; a chain of proxies is short.
const HOPS_MAX: usize = 16;

/// Header in which a proxy tells the address of its client.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ForwardedHeader {
    /// `X-Forwarded-For`: addresses parted by commas.
    #[default]
    XForwardedFor,
    /// `Forwarded` of RFC 7239, with the address as its parameter `for`.
    Forwarded,
}

/// Proxies whose word about their clients counts.
#[derive(Debug, Clone, Default)]
pub struct TrustedProxies {
    pub ranges: Vec<AddressRange>,
    /// The one header that these proxies write. The other one may come from anybody.
    pub header: ForwardedHeader,
}

/// Address of the client of a request; an extractor for handlers behind [`with_client_address`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClientAddress(pub IpAddr);

impl<S: Send + Sync> FromRequestParts<S> for ClientAddress {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        // Without an address all would share one; it is there wherever the server serves.
        Ok(parts.extensions.get().copied().unwrap_or(Self(IpAddr::V4(Ipv4Addr::UNSPECIFIED))))
    }
}

/// Puts the [`ClientAddress`] into each request.
pub fn with_client_address<S: Clone + Send + Sync + 'static>(
    router: Router<S>,
    proxies: TrustedProxies,
) -> Router<S> {
    let (proxies, in_flight) = (Arc::new(proxies), InFlight::default());
    router.layer(middleware::from_fn(move |mut request: Request, next: Next| {
        let (proxies, in_flight) = (Arc::clone(&proxies), in_flight.clone());
        async move {
            let peer = request.extensions().get::<ConnectInfo<SocketAddr>>();
            let Some(peer) = peer.map(|ConnectInfo(peer)| peer.ip()) else {
                return next.run(request).await;
            };
            let client = proxies.client(peer, request.headers());
            request.extensions_mut().insert(ClientAddress(client));
            if proxies.has(peer.to_canonical()) {
                in_flight.serve(AddressRange::of_client(client), request, next).await
            } else {
                next.run(request).await
            }
        }
    }))
}

impl TrustedProxies {
    /// Returns true if connections from this address are a proxy's.
    #[must_use]
    pub fn has(&self, address: IpAddr) -> bool {
        self.ranges.iter().any(|range| range.contains(address))
    }

    /// Returns the client of a request: from the peer back along the header, the first address that
    /// is no trusted proxy. What stands left of it is hearsay.
    #[must_use]
    pub fn client(&self, peer: IpAddr, headers: &HeaderMap) -> IpAddr {
        let mut client = peer.to_canonical();
        if !self.has(client) {
            return client;
        }
        for hop in self.hops(headers).into_iter().rev().take(HOPS_MAX) {
            // A proxy that hides its client, or rubbish: the last proxy known stands for it.
            let Some(address) = hop else { break };
            client = address;
            if !self.has(client) {
                break;
            }
        }
        client
    }

    /// Returns the addresses of the header from left to right; `None` for what is no address.
    fn hops(&self, headers: &HeaderMap) -> Vec<Option<IpAddr>> {
        let values = match self.header {
            ForwardedHeader::XForwardedFor => headers.get_all("x-forwarded-for"),
            ForwardedHeader::Forwarded => headers.get_all(FORWARDED),
        };
        let elements = values.iter().flat_map(|value| value.as_bytes().split(|&byte| byte == b','));
        let texts = elements.map(|element| std::str::from_utf8(element).ok().map(str::trim));
        match self.header {
            ForwardedHeader::XForwardedFor => texts.map(|text| text.and_then(address)).collect(),
            ForwardedHeader::Forwarded => {
                texts.map(|text| text.and_then(forwarded_for).and_then(address)).collect()
            }
        }
    }
}

/// Returns the value of the parameter `for` of an element of `Forwarded`.
fn forwarded_for(element: &str) -> Option<&str> {
    element.split(';').find_map(|pair| {
        let (name, value) = pair.split_once('=')?;
        name.trim().eq_ignore_ascii_case("for").then(|| value.trim().trim_matches('"'))
    })
}

/// Reads an address with or without port and brackets.
fn address(text: &str) -> Option<IpAddr> {
    let plain = text.parse().or_else(|_| text.parse().map(|socket: SocketAddr| socket.ip()));
    let bare = text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    plain.ok().or_else(|| bare?.parse().ok()).map(|address| address.to_canonical())
}

#[cfg(test)]
mod tests {
    use tower::ServiceExt as _;

    use super::*;

    fn proxies(header: ForwardedHeader) -> TrustedProxies {
        let ranges =
            ["10.0.0.0/8", "2001:db8:ffff::/48"].map(|range| range.parse().expect("valid"));
        TrustedProxies { ranges: ranges.into(), header }
    }

    fn client(peer: &str, header: ForwardedHeader, lines: &[(&'static str, &str)]) -> String {
        let mut headers = HeaderMap::new();
        for (name, line) in lines {
            headers.append(*name, line.parse().expect("a value"));
        }
        proxies(header).client(peer.parse().expect("an address"), &headers).to_string()
    }

    #[test]
    fn the_rightmost_address_that_is_no_trusted_proxy_counts() {
        const NAME: &str = "x-forwarded-for";
        for (peer, lines, expected) in [
            ("192.0.2.1", vec![(NAME, "198.51.100.1")], "192.0.2.1"),
            ("10.0.0.1", vec![], "10.0.0.1"),
            ("10.0.0.1", vec![(NAME, "198.51.100.1")], "198.51.100.1"),
            ("::ffff:10.0.0.1", vec![(NAME, "198.51.100.1")], "198.51.100.1"),
            ("10.0.0.1", vec![(NAME, "1.1.1.1, 198.51.100.1, 10.0.0.2")], "198.51.100.1"),
            ("10.0.0.1", vec![(NAME, "1.1.1.1"), (NAME, "198.51.100.1")], "198.51.100.1"),
            ("10.0.0.1", vec![(NAME, "1.1.1.1, unknown")], "10.0.0.1"),
            ("10.0.0.1", vec![(NAME, "1.1.1.1, rubbish, 10.0.0.2")], "10.0.0.2"),
            ("10.0.0.1", vec![(NAME, "198.51.100.1:4711")], "198.51.100.1"),
            ("10.0.0.1", vec![(NAME, "[2001:db8::1]:4711")], "2001:db8::1"),
            ("10.0.0.1", vec![("forwarded", "for=1.1.1.1")], "10.0.0.1"),
        ] {
            assert_eq!(client(peer, ForwardedHeader::XForwardedFor, &lines), expected, "{lines:?}");
        }
    }

    /// A client of a proxy with answers that it does not read to their end.
    #[tokio::test]
    async fn a_client_behind_a_proxy_has_a_bounded_number_of_requests_under_way() {
        let router = Router::new().route("/", axum::routing::get(async || "an answer"));
        let router: Router = with_client_address(router, proxies(ForwardedHeader::XForwardedFor));
        let ask = async |peer: &str, client: &str| {
            let peer: SocketAddr = format!("{peer}:80").parse().expect("an address");
            let request = Request::builder().uri("/").header("x-forwarded-for", client);
            let mut request = request.body(axum::body::Body::empty()).expect("a request");
            request.extensions_mut().insert(ConnectInfo(peer));
            router.clone().oneshot(request).await.expect("an answer")
        };
        let mut held = Vec::new();
        let refused = loop {
            let answer = ask("10.0.0.1", "198.51.100.1").await;
            if answer.status() != 200 {
                break answer.status();
            }
            held.push(answer);
            assert!(held.len() < 1_000, "requests have no end");
        };
        assert_eq!((refused.as_u16(), held.len()), (429, 256));
        assert_eq!(ask("10.0.0.1", "198.51.100.2").await.status(), 200, "another client");
        assert_eq!(ask("198.51.100.1", "").await.status(), 200, "its own connections are counted");
        held.pop();
        assert_eq!(ask("10.0.0.1", "198.51.100.1").await.status(), 200);
    }

    #[test]
    fn the_standard_header_is_read_where_it_is_configured() {
        for (line, expected) in [
            ("for=198.51.100.1;proto=https", "198.51.100.1"),
            ("proto=https; For=\"[2001:db8::1]:4711\"", "2001:db8::1"),
            ("for=\"[2001:db8::1]\", for=10.1.1.1", "2001:db8::1"),
            ("for=1.1.1.1, for=_hidden", "10.0.0.1"),
        ] {
            let lines = [("forwarded", line), ("x-forwarded-for", "1.1.1.1")];
            assert_eq!(client("10.0.0.1", ForwardedHeader::Forwarded, &lines), expected, "{line}");
        }
    }
}
