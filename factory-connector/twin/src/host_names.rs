//! Names under which clients reach this machine.

use std::net::IpAddr;

use opcua_stack::opcua::crypto::hostname;

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
