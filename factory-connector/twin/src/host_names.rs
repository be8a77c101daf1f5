//! Names under which clients reach this machine, and those in a certificate.

use std::net::IpAddr;

use opcua_stack::opcua::crypto::hostname;
use x509_parser::{certificate::X509Certificate, extensions::GeneralName};

use crate::config::TwinConfig;

/// Longest label of a name, in bytes (RFC 1035 §2.3.4), less the number that multicast DNS appends
/// when the name is taken.
const LABEL_BYTES_MAX: usize = 63 - " (100)".len();

/// Returns the names and addresses under which clients reach the twin, the advertised one first.
pub(crate) fn host_names(config: &TwinConfig) -> Vec<String> {
    if !config.host_names.is_empty() {
        return config.host_names.clone();
    }
    let ip: IpAddr = config.listen.ip();
    if !ip.is_unspecified() {
        return vec![ip.to_string()];
    }
    vec![machine_name().unwrap_or_else(|| "localhost".to_owned())]
}

/// Returns the names that the certificate has to contain.
pub(crate) fn certified_names(config: &TwinConfig) -> Vec<String> {
    let mut names = host_names(config);
    if config.discovery.announce_by_multicast_dns {
        names.push(local_host_name());
    }
    names
}

/// Returns the host names and addresses in a certificate.
pub(crate) fn names_in(certificate: &X509Certificate<'_>) -> Vec<String> {
    let Ok(Some(names)) = certificate.subject_alternative_name() else { return Vec::new() };
    let text = |name: &GeneralName<'_>| match name {
        GeneralName::DNSName(name) => Some((*name).to_owned()),
        GeneralName::IPAddress(bytes) => match *bytes {
            [a, b, c, d] => Some(IpAddr::from([*a, *b, *c, *d]).to_string()),
            bytes => <[u8; 16]>::try_from(bytes).ok().map(|bytes| IpAddr::from(bytes).to_string()),
        },
        _ => None,
    };
    names.value.general_names.iter().filter_map(text).collect()
}

/// Returns whether a certificate contains a host name or address.
pub(crate) fn names_host(certificate: &X509Certificate<'_>, host: &str) -> bool {
    let canonical =
        host.parse::<IpAddr>().map_or_else(|_| host.to_owned(), |address| address.to_string());
    names_in(certificate).iter().any(|name| name.eq_ignore_ascii_case(&canonical))
}

/// Returns the name of this machine in multicast DNS.
pub(crate) fn local_host_name() -> String {
    let name = machine_name().unwrap_or_else(|| "verbund-twin".to_owned());
    format!("{}.local", cut_to_label(name.split('.').next().unwrap_or_default()))
}

/// Cuts a text to the length of a label, between characters.
pub(crate) fn cut_to_label(text: &str) -> &str {
    &text[..text.floor_char_boundary(LABEL_BYTES_MAX)]
}

fn machine_name() -> Option<String> {
    hostname().ok().filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_name_is_cut_between_characters() {
        assert_eq!(cut_to_label("Verbund"), "Verbund");
        let long = "ä".repeat(40);
        assert_eq!(cut_to_label(&long), "ä".repeat(28));
    }
}
