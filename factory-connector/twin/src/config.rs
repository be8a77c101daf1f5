//! What the twin's section of the configuration file says.

use std::{
    net::{Ipv4Addr, SocketAddr},
    path::PathBuf,
    time::Duration,
};

use serde::{Deserialize, Serialize};

/// The port registered for OPC UA.
pub const DEFAULT_PORT: u16 = 4840;

/// How the twin presents itself on the factory's network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TwinConfig {
    /// Address and port to listen on. Port 0 takes any free one; the endpoint URL tells which.
    pub listen: SocketAddr,
    /// Host names and addresses under which clients reach this machine, for the certificate; the first one also stands
    /// in the endpoint URLs. Where empty, the machine's own name, or the listening address where that is a specific one.
    pub host_names: Vec<String>,
    /// Folder of the own certificate and key, and of the trusted and rejected certificates of clients.
    pub pki_directory: PathBuf,
    /// Who may connect, and how.
    pub security: SecurityConfig,
    /// Bounds on what clients may take.
    pub limits: TwinLimits,
    /// How clients find the twin.
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

/// Who may connect, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SecurityConfig {
    /// Development only: also offers an endpoint without encryption and without a user, in the viewer role.
    pub allow_anonymous_unencrypted: bool,
    /// Development only: trusts every client certificate instead of waiting for an approval.
    pub trust_unknown_certificates: bool,
    /// How many wrong passwords a user or the whole server may see within [`Self::login_window_s`] before further
    /// attempts are refused without looking at the password.
    pub login_failures_max: u32,
    /// The window of [`Self::login_failures_max`], and how long attempts are refused, in seconds.
    pub login_window_s: u32,
    /// How long before its expiry the own certificate is renewed at a start, in days.
    pub certificate_renewal_days: u32,
    /// How long a newly made own certificate is valid, in days.
    pub certificate_validity_days: u32,
}

impl Default for SecurityConfig {
    fn default() -> Self {
        Self {
            allow_anonymous_unencrypted: false,
            trust_unknown_certificates: false,
            login_failures_max: 10,
            login_window_s: 60,
            certificate_renewal_days: 60,
            certificate_validity_days: 5 * 365,
        }
    }
}

impl SecurityConfig {
    /// [`Self::login_window_s`] as a duration.
    #[must_use]
    pub fn login_window(&self) -> Duration {
        Duration::from_secs(self.login_window_s.into())
    }
}

/// Bounds on what clients may take. The defaults suit a factory with some hundred clients' items; what is not listed
/// here follows the limits that the OPC UA stack room sets for every server of ours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TwinLimits {
    /// Sessions at the same time.
    pub sessions_max: usize,
    /// TCP connections at the same time, those without a session included.
    pub connections_max: usize,
    /// TCP connections at the same time from one address.
    pub connections_per_address_max: usize,
    /// Monitored items in one subscription.
    pub monitored_items_per_subscription_max: usize,
    /// Shortest publishing interval granted, in milliseconds.
    pub publishing_interval_ms_min: u64,
    /// How often due subscriptions are looked for, in milliseconds: the grain of every publishing interval.
    pub publishing_tick_ms: u64,
}

impl Default for TwinLimits {
    fn default() -> Self {
        Self {
            sessions_max: 100,
            connections_max: 200,
            connections_per_address_max: 50,
            monitored_items_per_subscription_max: 100_000,
            publishing_interval_ms_min: 10,
            publishing_tick_ms: 5,
        }
    }
}

/// How clients find the twin.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DiscoveryConfig {
    /// Endpoint URL of a local discovery server to register with; none where absent.
    pub local_discovery_server_url: Option<String>,
    /// Whether the twin announces itself on the local network by multicast DNS (`_opcua-tcp._tcp`).
    pub announce_by_multicast_dns: bool,
}
