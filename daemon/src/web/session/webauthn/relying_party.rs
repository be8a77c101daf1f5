//! Domain and origin of the pages, for which passkeys are made.

use axum::http::Uri;
use webauthn_rp::request::{AsciiDomain, RpId};

/// Domain and origin of the pages. A passkey is bound to the domain; the origin is compared as a whole.
#[derive(Debug, Clone)]
pub struct RelyingParty {
    id: RpId,
    origin: String,
}

/// Reason why browsers make no passkeys for the pages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PasskeysUnavailable {
    #[error("web.public_url is no address of a web server")]
    NoAddress,
    /// WebAuthn Level 3, 5.1.3: the id of a relying party is a domain.
    #[error(
        "passkeys need a domain name, and web.public_url has none or is not set; write it as https://verbund.example"
    )]
    NoDomain,
    /// WebAuthn is for secure contexts.
    #[error("passkeys need HTTPS, and the address of the pages begins with http://")]
    NoTls,
}

impl RelyingParty {
    /// Returns the relying party of pages at a URL.
    ///
    /// # Errors
    /// [`PasskeysUnavailable`].
    pub fn of(public_url: &str) -> Result<Self, PasskeysUnavailable> {
        let uri: Uri = public_url.parse().map_err(|_| PasskeysUnavailable::NoAddress)?;
        let (Some(scheme), Some(host)) = (uri.scheme_str(), uri.host()) else {
            return Err(PasskeysUnavailable::NoAddress);
        };
        let host = host.to_ascii_lowercase();
        if is_address(&host) {
            return Err(PasskeysUnavailable::NoDomain);
        }
        let usual_port = match scheme {
            "https" => 443,
            "http" if host == "localhost" || host.ends_with(".localhost") => 80,
            "http" => return Err(PasskeysUnavailable::NoTls),
            _ => return Err(PasskeysUnavailable::NoAddress),
        };
        let domain =
            AsciiDomain::try_from(host.clone()).map_err(|_| PasskeysUnavailable::NoDomain)?;
        // As browsers write an origin: without the port that the scheme has.
        let origin = match uri.port_u16().filter(|port| *port != usual_port) {
            Some(port) => format!("{scheme}://{host}:{port}"),
            None => format!("{scheme}://{host}"),
        };
        Ok(Self { id: RpId::Domain(domain), origin })
    }

    pub(super) fn id(&self) -> &RpId {
        &self.id
    }

    pub(super) fn origin(&self) -> &str {
        &self.origin
    }
}

/// Returns true for an IP address in any form that browsers read (URL standard, 3.5: the last label of such
/// a host is a number).
fn is_address(host: &str) -> bool {
    let last = host.trim_end_matches('.').rsplit('.').next().unwrap_or_default();
    let is_hexadecimal =
        last.strip_prefix("0x").is_some_and(|rest| rest.bytes().all(|b| b.is_ascii_hexdigit()));
    host.starts_with('[') || is_hexadecimal || last.bytes().all(|b| b.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passkeys_need_a_domain_and_a_secure_context() {
        for (url, origin) in [
            ("https://verbund.example", Ok("https://verbund.example")),
            ("https://Verbund.Example:443/", Ok("https://verbund.example")),
            ("https://verbund.example:8443/pages", Ok("https://verbund.example:8443")),
            ("http://localhost:8080", Ok("http://localhost:8080")),
            ("http://localhost:80", Ok("http://localhost")),
            ("https://localhost", Ok("https://localhost")),
            ("https://plant7", Ok("https://plant7")),
            ("http://verbund.example", Err(PasskeysUnavailable::NoTls)),
            ("http://localhost.example", Err(PasskeysUnavailable::NoTls)),
            ("http://127.0.0.1:8080", Err(PasskeysUnavailable::NoDomain)),
            ("https://192.0.2.7", Err(PasskeysUnavailable::NoDomain)),
            ("https://192.0.2.7.", Err(PasskeysUnavailable::NoDomain)),
            ("https://3221225991", Err(PasskeysUnavailable::NoDomain)),
            ("https://0xc0000207", Err(PasskeysUnavailable::NoDomain)),
            ("https://[2001:db8::1]:8443", Err(PasskeysUnavailable::NoDomain)),
            ("ftp://verbund.example", Err(PasskeysUnavailable::NoAddress)),
            ("verbund.example", Err(PasskeysUnavailable::NoAddress)),
            ("", Err(PasskeysUnavailable::NoAddress)),
        ] {
            let found = RelyingParty::of(url);
            assert_eq!(found.as_ref().map(RelyingParty::origin), origin.as_ref().copied(), "{url}");
        }
    }

    #[test]
    fn the_id_is_the_domain_without_a_port() {
        let party = RelyingParty::of("https://verbund.example:8443").expect("a domain");
        assert_eq!(party.id().as_ref(), "verbund.example");
    }
}
