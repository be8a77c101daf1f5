//! The twin's section of the configuration file.

use std::{
    net::{Ipv4Addr, SocketAddr},
    path::PathBuf,
    time::Duration,
};

use serde::{Deserialize, Serialize};

/// The port registered for OPC UA.
pub const DEFAULT_PORT: u16 = 4840;

/// Configuration of the twin: address, certificates, access, limits and discovery.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TwinConfig {
    /// Address and port to listen on. Port 0 is any free one, which the endpoint URL then contains.
    pub listen: SocketAddr,
    /// Host names and addresses under which clients reach this machine, for the certificate; the
    /// first one is also used in the endpoint URLs. When empty, the machine's name, or the listening
    /// address if that is a specific one.
    pub host_names: Vec<String>,
    /// Folder of the twin's certificate and key, and of the trusted and rejected certificates of
    /// clients.
    pub pki_directory: PathBuf,
    /// Encryption, certificates and sign-in.
    pub security: SecurityConfig,
    /// Bounds on the resources of clients.
    pub limits: TwinLimits,
    pub discovery: DiscoveryConfig,
}

impl Default for TwinConfig {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::UNSPECIFIED, DEFAULT_PORT)),
            host_names: Vec::new(),
            pki_directory: PathBuf::from("pki"),
            security: SecurityConfig::default(),
            limits: TwinLimits::default(),
            discovery: DiscoveryConfig::default(),
        }
    }
}

/// Encryption, certificates and sign-in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SecurityConfig {
    /// Development only: also offers an endpoint without encryption and without a user, in the
    /// viewer role.
    pub allow_anonymous_unencrypted: bool,
    /// Also offers endpoints that sign and do not encrypt, for clients that can do no more: everybody on the
    /// way reads values and writes.
    pub allow_signed_unencrypted: bool,
    /// Development only: trusts every client certificate instead of waiting for an approval, as long as
    /// this is set. Nothing of that trust is stored.
    pub trust_unknown_certificates: bool,
    /// Wrong passwords of a user from one address within [`Self::login_window_s`] after which further
    /// attempts are refused without a check of the password; ten times as many for all users of an
    /// address, and for a user from all addresses.
    pub login_failures_max: u32,
    /// Window of [`Self::login_failures_max`], and time for which attempts are refused, in seconds.
    pub login_window_s: u32,
    /// Time before its expiry at which a self-made certificate is renewed, in days.
    pub certificate_renewal_days: u32,
    /// Validity of a self-made certificate, in days.
    pub certificate_validity_days: u32,
}

impl Default for SecurityConfig {
    fn default() -> Self {
        Self {
            allow_anonymous_unencrypted: false,
            allow_signed_unencrypted: false,
            trust_unknown_certificates: false,
            login_failures_max: 10,
            login_window_s: 60,
            certificate_renewal_days: 60,
            certificate_validity_days: 5 * 365,
        }
    }
}

impl SecurityConfig {
    /// Returns [`Self::login_window_s`] as a duration.
    #[must_use]
    pub fn login_window(&self) -> Duration {
        Duration::from_secs(self.login_window_s.into())
    }
}

/// Bounds on the resources of clients. All other limits are those of the `opcua-stack` crate for every
/// server.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TwinLimits {
    /// Sessions at the same time.
    pub sessions_max: usize,
    /// Sessions at the same time of one client: a user, with whatever certificates and from whatever addresses. One more
    /// takes the place of a session whose connection is gone, or is refused.
    pub sessions_per_client_max: usize,
    /// TCP connections at the same time, those without a session included.
    pub connections_max: usize,
    /// TCP connections at the same time from one address.
    pub connections_per_address_max: usize,
    /// Subscriptions of one client in all its sessions.
    pub subscriptions_per_client_max: usize,
    /// Monitored items of one client in all its subscriptions.
    pub monitored_items_per_client_max: usize,
    /// Monitored items in one subscription.
    pub monitored_items_per_subscription_max: usize,
    /// Shortest publishing interval granted, in milliseconds.
    pub publishing_interval_ms_min: u64,
    /// Interval at which due subscriptions are searched, in milliseconds: the resolution of all
    /// publishing intervals.
    pub publishing_tick_ms: u64,
}

impl Default for TwinLimits {
    fn default() -> Self {
        Self {
            sessions_max: 100,
            sessions_per_client_max: 20,
            connections_max: 1000,
            connections_per_address_max: 50,
            subscriptions_per_client_max: 200,
            monitored_items_per_client_max: 200_000,
            monitored_items_per_subscription_max: 100_000,
            publishing_interval_ms_min: 10,
            publishing_tick_ms: 5,
        }
    }
}

/// Registration and announcement of the twin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DiscoveryConfig {
    /// Endpoint URL of a local discovery server to register with. Its certificate needs an approval
    /// like that of a client.
    pub local_discovery_server_url: Option<String>,
    /// Interval of the registration, in seconds. Discovery servers drop registrations after ten
    /// minutes.
    pub registration_interval_s: u32,
    /// Announces the twin on the local network by multicast DNS (`_opcua-tcp._tcp`).
    pub announce_by_multicast_dns: bool,
}

impl Default for DiscoveryConfig {
    fn default() -> Self {
        Self {
            local_discovery_server_url: None,
            registration_interval_s: 300,
            announce_by_multicast_dns: false,
        }
    }
}

impl DiscoveryConfig {
    /// Returns [`Self::registration_interval_s`] as a duration.
    #[must_use]
    pub fn registration_interval(&self) -> Duration {
        Duration::from_secs(self.registration_interval_s.into())
    }
}

impl TwinConfig {
    /// Returns the faults that the types of the keys do not exclude: sentences with the key, below
    /// `twin`, and the remedy.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        if let Some(url) = &self.discovery.local_discovery_server_url
            && !is_endpoint_url(url)
        {
            faults.push(format!(
                "discovery.local_discovery_server_url is {url:?}, but a discovery server is named like \
                 opc.tcp://discovery.plant:4840"
            ));
        }
        if !(1..=600).contains(&self.discovery.registration_interval_s) {
            faults.push("discovery.registration_interval_s must lie between 1 and 600".to_owned());
        }
        let SecurityConfig {
            certificate_renewal_days: renewal,
            certificate_validity_days: validity,
            ..
        } = self.security;
        if renewal >= validity {
            faults.push(format!(
                "security.certificate_renewal_days is {renewal}, but must be less than \
                 security.certificate_validity_days, which is {validity}: a new certificate would be due at once"
            ));
        }
        if self.security.login_failures_max == 0 || self.security.login_window_s == 0 {
            faults.push(
                "security.login_failures_max and security.login_window_s must be at least 1"
                    .to_owned(),
            );
        }
        let limits = &self.limits;
        for (key, value) in [
            ("sessions_max", limits.sessions_max),
            ("sessions_per_client_max", limits.sessions_per_client_max),
            ("connections_max", limits.connections_max),
            ("connections_per_address_max", limits.connections_per_address_max),
            ("subscriptions_per_client_max", limits.subscriptions_per_client_max),
            ("monitored_items_per_client_max", limits.monitored_items_per_client_max),
            ("monitored_items_per_subscription_max", limits.monitored_items_per_subscription_max),
        ] {
            if value == 0 {
                faults.push(format!(
                    "limits.{key} is 0, so that nobody could use the twin; give at least 1"
                ));
            }
        }
        faults
    }
}

fn is_endpoint_url(url: &str) -> bool {
    let Some(rest) = url.strip_prefix("opc.tcp://") else { return false };
    let authority = rest.split('/').next().unwrap_or_default();
    let host = match authority.rsplit_once(':') {
        Some((host, port)) if !authority.ends_with(']') => {
            if port.parse::<u16>().is_err() {
                return false;
            }
            host
        }
        _ => authority,
    };
    !host.is_empty() && !host.contains(char::is_whitespace)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discovery_servers_are_named_by_endpoint_urls() {
        for (url, expected) in [
            ("opc.tcp://discovery.plant:4840", true),
            ("opc.tcp://discovery.plant:4840/UADiscovery", true),
            ("opc.tcp://[::1]:4840", true),
            ("opc.tcp://[::1]", true),
            ("opc.tcp://host", true),
            ("opc.tcp://", false),
            ("opc.tcp://:4840", false),
            ("opc.tcp://host:port", false),
            ("opc.tcp://two hosts", false),
            ("http://discovery.plant:4840", false),
        ] {
            assert_eq!(is_endpoint_url(url), expected, "{url}");
        }
    }

    #[test]
    fn all_faults_are_named_at_once() {
        let mut config = TwinConfig::default();
        assert_eq!(config.faults(), [""; 0]);
        config.discovery.local_discovery_server_url = Some("discovery".to_owned());
        config.discovery.registration_interval_s = 0;
        config.security.certificate_renewal_days = 4000;
        config.limits.sessions_max = 0;
        assert_eq!(config.faults().len(), 4, "{:?}", config.faults());
    }
}
