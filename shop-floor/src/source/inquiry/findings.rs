//! Findings on what a server offers. Pure: names are looked up and certificates are read before.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr};

use asi_model::values::DateTime;

use crate::{OfferedCertificate, ServerFinding};

/// Shortest key of the policies that are not outdated, in bits.
const KEY_BITS_MIN: usize = 2048;
/// Difference of the clocks that is not worth saying.
const CLOCK_DIFFERENCE_MS_MAX: i64 = 5_000;
/// Most names of a certificate that are shown.
const NAMES_MAX: usize = 20;

/// Address that a person gave, and its host.
pub(super) struct Asked<'a> {
    pub(super) url: &'a str,
    pub(super) host: &'a str,
}

/// Returns the host of an address, an IPv6 one in its brackets; empty without one.
pub(super) fn host_of(url: &str) -> &str {
    let rest = url.split_once("://").map_or(url, |(_, rest)| rest);
    let authority = rest.split('/').next().unwrap_or_default();
    match authority.rfind(']') {
        Some(end) if authority.starts_with('[') => &authority[..=end],
        _ => authority.split(':').next().unwrap_or_default(),
    }
}

/// Returns the text of an IP address in a certificate.
pub(super) fn address_text(bytes: &[u8]) -> Option<String> {
    let address = match bytes.len() {
        4 => IpAddr::from(Ipv4Addr::from(<[u8; 4]>::try_from(bytes).ok()?)),
        16 => IpAddr::from(Ipv6Addr::from(<[u8; 16]>::try_from(bytes).ok()?)),
        _ => return None,
    };
    Some(address.to_string())
}

/// Returns true for two spellings of one host; addresses are compared as such, in brackets or not.
fn is_same_host(one: &str, other: &str) -> bool {
    let [one, other] = [one, other].map(|host| host.trim_matches(['[', ']']));
    let address = |host: &str| {
        let without_interface = host.split('%').next().unwrap_or_default();
        without_interface.parse::<IpAddr>().ok().map(|address| address.to_canonical())
    };
    match (address(one), address(other)) {
        (Some(one), Some(other)) => one == other,
        _ => one.eq_ignore_ascii_case(other),
    }
}

/// Returns the finding on a host by which the server calls itself.
pub(super) fn of_hosts(
    asked: &Asked<'_>,
    host: String,
    used_url: String,
    is_known: bool,
) -> Option<ServerFinding> {
    if is_same_host(&host, asked.host) {
        return None;
    }
    Some(if is_known {
        ServerFinding::HostNameDiffers { host, used_url }
    } else {
        ServerFinding::HostNameUnknown { host, used_url }
    })
}

/// Returns the findings on certificates, and takes the names off that are too many to be shown: each of them counts.
pub(super) fn of_certificates(
    certificates: &mut [OfferedCertificate],
    asked: &Asked<'_>,
    application_uri: Option<&str>,
    now: DateTime,
) -> Vec<ServerFinding> {
    let mut found = Vec::new();
    for certificate in certificates {
        found.extend(of_certificate(certificate, asked, application_uri, now));
        certificate.host_names.truncate(NAMES_MAX);
    }
    found
}

/// Returns the findings on a certificate. None of them is a matter of trust, which is by the certificate itself.
fn of_certificate(
    certificate: &OfferedCertificate,
    asked: &Asked<'_>,
    application_uri: Option<&str>,
    now: DateTime,
) -> Vec<ServerFinding> {
    let fingerprint = || certificate.fingerprint.clone();
    let mut found = Vec::new();
    if let Some(valid_to) = certificate.valid_to.filter(|end| *end < now) {
        found.push(ServerFinding::CertificateExpired { fingerprint: fingerprint(), valid_to });
    }
    if let Some(valid_from) = certificate.valid_from.filter(|begin| now < *begin) {
        found
            .push(ServerFinding::CertificateNotYetValid { fingerprint: fingerprint(), valid_from });
    }
    if let Some(key_bits) = certificate.key_bits.filter(|bits| *bits < KEY_BITS_MIN) {
        found.push(ServerFinding::KeyTooShort { fingerprint: fingerprint(), key_bits });
    }
    if certificate.is_signed_with_sha1 {
        found.push(ServerFinding::SignedWithSha1 { fingerprint: fingerprint() });
    }
    let host = asked.host.trim_matches(['[', ']']);
    if !certificate.host_names.iter().any(|name| is_same_host(name, host)) {
        found.push(ServerFinding::CertificateOfOtherHost {
            fingerprint: fingerprint(),
            host: host.to_owned(),
            host_names: certificate.host_names.iter().take(NAMES_MAX).cloned().collect(),
        });
    }
    if let (Some(said), Some(named)) = (application_uri, certificate.application_uri.as_deref())
        && said != named
    {
        found.push(ServerFinding::CertificateOfOtherApplication {
            fingerprint: fingerprint(),
            application_uri: named.to_owned(),
        });
    }
    found
}

/// Returns the finding on a clock that is so many milliseconds ahead.
pub(super) fn clock_finding(ahead_ms: i64) -> Option<ServerFinding> {
    let is_wrong = ahead_ms.unsigned_abs() > CLOCK_DIFFERENCE_MS_MAX.unsigned_abs();
    is_wrong.then_some(ServerFinding::ClockDiffers { ahead_ms })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASKED: Asked<'_> = Asked { url: "opc.tcp://10.0.0.7:4840", host: "10.0.0.7" };

    fn certificate(year: i64) -> OfferedCertificate {
        let at = |years: i64| Some(DateTime::from_unix_micros(years * 31_557_600_000_000));
        OfferedCertificate {
            thumbprint: "ab".into(),
            fingerprint: "fe".into(),
            subject: "CN=plc-1".into(),
            application_uri: Some("urn:plc-1:server".into()),
            host_names: vec!["plc-1".into(), "10.0.0.7".into()],
            valid_from: at(year - 1970),
            valid_to: at(year - 1960),
            key_bits: Some(2048),
            is_signed_with_sha1: false,
            is_trusted: false,
        }
    }

    fn now() -> DateTime {
        "2026-03-01T00:00:00Z".parse().expect("a time")
    }

    #[test]
    fn a_certificate_that_fits_has_no_finding() {
        let uri = Some("urn:plc-1:server");
        assert!(of_certificate(&certificate(2020), &ASKED, uri, now()).is_empty());
    }

    #[test]
    fn each_oddity_of_a_certificate_is_said() {
        let (mut odd, fingerprint) = (certificate(2010), || "fe".to_owned());
        odd.key_bits = Some(1024);
        odd.is_signed_with_sha1 = true;
        odd.host_names = vec!["old-plc".into()];
        let valid_to = odd.valid_to.expect("an end");
        let expected = [
            ServerFinding::CertificateExpired { fingerprint: fingerprint(), valid_to },
            ServerFinding::KeyTooShort { fingerprint: fingerprint(), key_bits: 1024 },
            ServerFinding::SignedWithSha1 { fingerprint: fingerprint() },
            ServerFinding::CertificateOfOtherHost {
                fingerprint: fingerprint(),
                host: "10.0.0.7".into(),
                host_names: vec!["old-plc".into()],
            },
            ServerFinding::CertificateOfOtherApplication {
                fingerprint: fingerprint(),
                application_uri: "urn:plc-1:server".into(),
            },
        ];
        assert_eq!(of_certificate(&odd, &ASKED, Some("urn:plc-2:server"), now()), expected);
        let early = certificate(2030);
        let valid_from = early.valid_from.expect("a beginning");
        assert_eq!(
            of_certificate(&early, &ASKED, None, now()),
            [ServerFinding::CertificateNotYetValid { fingerprint: fingerprint(), valid_from }]
        );
    }

    #[test]
    fn a_host_name_that_nothing_knows_is_said_with_the_address_that_is_used() {
        let used_url = || "opc.tcp://10.0.0.7:4840/UA".to_owned();
        let of = |host: &str, is_known| of_hosts(&ASKED, host.into(), used_url(), is_known);
        assert_eq!(of("10.0.0.7", true), None);
        let host = || "plc-1".to_owned();
        let unknown = ServerFinding::HostNameUnknown { host: host(), used_url: used_url() };
        assert_eq!(of("plc-1", false), Some(unknown));
        let other = ServerFinding::HostNameDiffers { host: host(), used_url: used_url() };
        assert_eq!(of("plc-1", true), Some(other));
    }

    #[test]
    fn the_host_of_an_address_is_found() {
        for (url, host) in [
            ("opc.tcp://plc-1.hall:4840/UA", "plc-1.hall"),
            ("opc.tcp://10.0.0.7", "10.0.0.7"),
            ("opc.tcp://[fe80::1]:4841", "[fe80::1]"),
            ("opc.tcp://", ""),
            ("plc", "plc"),
        ] {
            assert_eq!(host_of(url), host);
        }
        assert_eq!(address_text(&[10, 0, 0, 7]).as_deref(), Some("10.0.0.7"));
        assert_eq!(address_text(&[10]), None);
    }

    #[test]
    fn an_address_is_the_same_however_it_is_written() {
        for (one, other, is_same) in [
            ("[fe80::1]", "fe80:0:0:0:0:0:0:1", true),
            ("[FE80::1%eth0]", "fe80::1", true),
            ("[::ffff:10.0.0.7]", "10.0.0.7", true),
            ("[fe80::1]", "[fe80::2]", false),
            ("PLC-1.hall", "plc-1.hall", true),
            ("plc-1", "10.0.0.7", false),
            // Other programs may take it for 127.0.0.1, this one does not.
            ("127.1", "127.0.0.1", false),
        ] {
            assert_eq!(is_same_host(one, other), is_same, "{one} {other}");
        }
    }

    #[test]
    fn clocks_that_differ_by_little_have_no_finding() {
        assert_eq!(clock_finding(4_999), None);
        let behind = Some(ServerFinding::ClockDiffers { ahead_ms: -7_200_000 });
        assert_eq!(clock_finding(-7_200_000), behind);
    }
}
