//! The configuration, as TOML.

use std::{
    net::{IpAddr, SocketAddr},
    path::{Path, PathBuf},
    time::Duration,
};

use serde::{Deserialize, Serialize};
use shop_floor_model::{ProfileLimit, ServerProfile};

use crate::{orders::OrdersConfig, signals::hash};

/// A commented example.
pub const EXAMPLE: &str = include_str!("../simulator.example.toml");

/// The whole simulation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Seed from which all values follow.
    #[serde(default)]
    pub seed: u64,
    /// Simulated seconds per second.
    #[serde(default = "one")]
    pub speed: f64,
    /// RFC 3339: when the simulated time was zero. Default: when the simulator starts.
    #[serde(default)]
    pub epoch: Option<String>,
    /// The address that all servers listen on.
    #[serde(default = "loopback")]
    pub host: IpAddr,
    /// Address of the HTTP control interface; none if absent. It has no access control: bind it to
    /// loopback only.
    #[serde(default)]
    pub control: Option<SocketAddr>,
    /// Directory with one folder of certificates per machine.
    #[serde(default = "pki_directory")]
    pub pki_directory: PathBuf,
    /// Interval at which values are computed, in milliseconds.
    #[serde(default = "update_interval_ms")]
    pub update_interval_ms: u64,
    #[serde(default)]
    pub machines: Vec<MachineConfig>,
}

/// One machine: one OPC UA server.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineConfig {
    /// Its name: `[A-Za-z0-9_-]{1,64}`, unique.
    pub name: String,
    pub kind: MachineKind,
    /// Its port; 0: any free one.
    #[serde(default)]
    pub port: u16,
    /// The namespace of its nodes. Default: `urn:verbund:simulator:<name>`.
    #[serde(default)]
    pub namespace_uri: Option<String>,
    /// Seconds per part; each kind has its own default.
    #[serde(default)]
    pub cycle_seconds: Option<f64>,
    /// Orders of a milling cell, a press or a conveyor; without them it produces without end.
    #[serde(default)]
    pub orders: Option<OrdersConfig>,
    /// The asset id that a robot shows. Default: its name.
    #[serde(default)]
    pub asset_id: Option<String>,
    /// Number of variables of a bank.
    #[serde(default)]
    pub variables: u32,
    /// Changes per second over all variables of a bank.
    #[serde(default)]
    pub changes_per_second: f64,
    /// False takes the relay away that network faults need: a little faster, for measurements.
    #[serde(default = "yes")]
    pub relay: bool,
    /// Family of controllers whose limits the server has, as `s7-1200`: those of `shop-floor/model/profiles.json`. Limits
    /// below go before them.
    #[serde(default)]
    pub profile: Option<String>,
    /// Most monitored items of one subscription, as small devices have it; declared to clients. 0:
    /// plenty.
    #[serde(default)]
    pub items_per_subscription_max: u32,
    /// Most subscriptions of one session. 0: plenty.
    #[serde(default)]
    pub subscriptions_per_session_max: u32,
    /// Most sessions at a time, as small devices have places. 0: plenty.
    #[serde(default)]
    pub sessions_max: u32,
    /// Least publishing interval that is granted, in milliseconds, as controllers have it. 0: any.
    #[serde(default)]
    pub publishing_interval_ms_min: u32,
    /// Least sampling interval that is granted, in milliseconds. 0: any.
    #[serde(default)]
    pub sampling_interval_ms_min: u32,
    /// Most changes that the queue of an item holds. 0: plenty.
    #[serde(default)]
    pub queue_size_max: u32,
    #[serde(default)]
    pub security: SecurityConfig,
}

/// Kinds of machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs)]
pub enum MachineKind {
    MillingCell,
    Press,
    Conveyor,
    Robot,
    /// Many counters at a steady rate, to measure with.
    Bank,
}

/// Endpoints and users that a server accepts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SecurityConfig {
    /// Offers an endpoint without protection.
    #[serde(default = "yes")]
    pub unprotected: bool,
    /// Offers Basic256Sha256 and Aes256Sha256RsaPss, signed and encrypted.
    #[serde(default)]
    pub protected: bool,
    /// Lets in users without a name.
    #[serde(default = "yes")]
    pub anonymous: bool,
    /// Users with passwords.
    #[serde(default)]
    pub users: Vec<UserConfig>,
    /// Trusts every client's certificate. Else they wait in the `rejected` folder.
    #[serde(default = "yes")]
    pub trusts_all_clients: bool,
}

/// Account that may sign in to the simulated servers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UserConfig {
    pub name: String,
    pub password: String,
}

/// A configuration cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("{} cannot be read", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// The text is no such configuration.
    #[error("{} is not a simulator configuration: {message}", path.display())]
    Parse { path: PathBuf, message: String },
    /// A value is out of range.
    #[error("{key}: {reason}")]
    Invalid { key: String, reason: String },
}

fn one() -> f64 {
    1.0
}

fn yes() -> bool {
    true
}

fn loopback() -> IpAddr {
    IpAddr::from([127, 0, 0, 1])
}

fn pki_directory() -> PathBuf {
    PathBuf::from("simulator-pki")
}

fn update_interval_ms() -> u64 {
    50
}

impl Default for SecurityConfig {
    fn default() -> Self {
        Self {
            unprotected: true,
            protected: false,
            anonymous: true,
            users: Vec::new(),
            trusts_all_clients: true,
        }
    }
}

impl Default for Config {
    fn default() -> Self {
        Self {
            seed: 0,
            speed: one(),
            epoch: None,
            host: loopback(),
            control: None,
            pki_directory: pki_directory(),
            update_interval_ms: update_interval_ms(),
            machines: Vec::new(),
        }
    }
}

impl MachineConfig {
    /// A machine on any free port, open to everyone.
    #[must_use]
    pub fn new(name: &str, kind: MachineKind) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            port: 0,
            namespace_uri: None,
            cycle_seconds: None,
            orders: None,
            asset_id: None,
            variables: 0,
            changes_per_second: 0.0,
            relay: true,
            profile: None,
            items_per_subscription_max: 0,
            subscriptions_per_session_max: 0,
            sessions_max: 0,
            publishing_interval_ms_min: 0,
            sampling_interval_ms_min: 0,
            queue_size_max: 0,
            security: SecurityConfig::default(),
        }
    }

    /// The namespace of its nodes.
    #[must_use]
    pub fn namespace_uri(&self) -> String {
        self.namespace_uri.clone().unwrap_or_else(|| format!("urn:verbund:simulator:{}", self.name))
    }

    /// Returns the profile whose limits the server has.
    pub(crate) fn profile(&self) -> Option<&'static ServerProfile> {
        self.profile.as_deref().and_then(ServerProfile::of_family)
    }

    /// Returns the machine's own limit, or else that of its profile.
    pub(crate) fn limit(&self, own: u32, limit: ProfileLimit) -> Option<u32> {
        if own > 0 { Some(own) } else { self.profile()?.limit(limit) }
    }

    pub(crate) fn asset_id(&self) -> &str {
        self.asset_id.as_deref().unwrap_or(&self.name)
    }

    pub(crate) fn serial_number(&self) -> String {
        format!("SN-{:06}", self.name_hash() % 1_000_000)
    }

    /// The seed of this machine under the simulation's.
    pub(crate) fn seed(&self, seed: u64) -> u64 {
        hash(seed, self.name_hash(), 0)
    }

    fn name_hash(&self) -> u64 {
        self.name.bytes().fold(0, |sum, byte| hash(sum, 0, u64::from(byte)))
    }
}

impl Config {
    /// A simulation of these machines, each on any free port.
    #[must_use]
    pub fn of(machines: Vec<MachineConfig>) -> Self {
        Self { machines, ..Self::default() }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`ConfigError`] that names file and place.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ConfigError::Read { path: path.to_owned(), source })?;
        let config: Self = toml::from_str(&text).map_err(|error| ConfigError::Parse {
            path: path.to_owned(),
            message: error.to_string(),
        })?;
        config.check()?;
        Ok(config)
    }

    /// Checks what the types do not.
    ///
    /// # Errors
    /// [`ConfigError::Invalid`] for the first fault.
    pub fn check(&self) -> Result<(), ConfigError> {
        let invalid = |key: String, reason: &str| {
            Err(ConfigError::Invalid { key, reason: reason.to_owned() })
        };
        if !(0.0..=10_000.0).contains(&self.speed) {
            return invalid("speed".into(), "must be between 0 and 10000");
        }
        if !(1..=60_000).contains(&self.update_interval_ms) {
            return invalid("update_interval_ms".into(), "must be between 1 and 60000");
        }
        if self.epoch().is_err() {
            return invalid("epoch".into(), "must be an RFC 3339 time, as 2026-01-01T00:00:00Z");
        }
        let mut names = std::collections::HashSet::new();
        for machine in &self.machines {
            let key = |key: &str| format!("machines.{}.{key}", machine.name);
            let is_name = (1..=64).contains(&machine.name.len())
                && machine
                    .name
                    .bytes()
                    .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'-');
            if !is_name {
                return invalid(key("name"), "must match ^[A-Za-z0-9_-]{1,64}$");
            }
            if !names.insert(&machine.name) {
                return invalid(key("name"), "is used twice");
            }
            if machine.cycle_seconds.is_some_and(|cycle| !(0.05..=3600.0).contains(&cycle)) {
                return invalid(key("cycle_seconds"), "must be between 0.05 and 3600");
            }
            if let Some(reason) = machine.orders.as_ref().and_then(OrdersConfig::fault) {
                return invalid(key("orders"), reason);
            }
            if machine.variables > 200_000
                || !(0.0..=10_000_000.0).contains(&machine.changes_per_second)
            {
                return invalid(
                    key("variables"),
                    "at most 200000, with at most 10000000 changes per second",
                );
            }
            if machine.profile.is_some() && machine.profile().is_none() {
                let known: Vec<&str> =
                    ServerProfile::all().iter().map(|profile| profile.family.as_str()).collect();
                return invalid(key("profile"), &format!("must be one of {}", known.join(", ")));
            }
            let security = &machine.security;
            if !security.unprotected && !security.protected {
                return invalid(
                    key("security"),
                    "at least one of unprotected and protected must be true",
                );
            }
            if !security.anonymous && security.users.is_empty() {
                return invalid(
                    key("security"),
                    "without anonymous there must be at least one user",
                );
            }
        }
        Ok(())
    }

    pub(crate) fn epoch(
        &self,
    ) -> Result<Option<asi_model::DateTime>, asi_model::values::InvalidDateTime> {
        self.epoch.as_deref().map(str::parse).transpose()
    }

    pub(crate) fn update_interval(&self) -> Duration {
        Duration::from_millis(self.update_interval_ms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_is_valid() {
        let config: Config = toml::from_str(EXAMPLE).expect("the example parses");
        config.check().expect("the example is valid");
        assert!(config.machines.len() >= 4);
    }

    #[test]
    fn faults_are_named() {
        let check = |text: &str, expected: &str| {
            let error = match toml::from_str::<Config>(text) {
                Ok(config) => config.check().expect_err("must be refused").to_string(),
                Err(error) => error.to_string(),
            };
            assert!(error.contains(expected), "{error}");
        };
        check("speeed = 1", "unknown field `speeed`");
        check("speed = -1", "speed: must be between");
        check("[[machines]]\nname = 'a b'\nkind = 'press'", "machines.a b.name: must match");
        check("[[machines]]\nname = 'a'\nkind = 'lathe'", "unknown variant `lathe`");
        let unknown = "[[machines]]\nname = 'a'\nkind = 'press'\nprofile = 'plc'";
        check(unknown, "machines.a.profile: must be one of s7-1500, s7-1200");
    }
}
