//! Limits and timeouts of a link.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::spool::ReplayShare;

/// Limits and timeouts of a link. Durations are serialized as whole milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields, default)]
pub struct LinkLimits {
    /// Messages sent without an outcome yet, over all addresses.
    pub window: usize,
    /// Messages the broker may have in flight to this side, per address.
    pub credit: u32,
    /// Most messages handed to the inbox at once.
    pub batch: usize,
    /// Largest message accepted, in bytes.
    pub message_bytes_max: u64,
    /// Share of the messages that a backlog gets while live reports wait.
    pub replay_share: ReplayShare,
    /// Time to resolve, connect and authenticate.
    #[serde(with = "millis")]
    pub connect_timeout: Duration,
    /// Time for the broker to answer an attach or a message.
    #[serde(with = "millis")]
    pub outcome_timeout: Duration,
    /// Silence after which the connection counts as dead.
    #[serde(with = "millis")]
    pub idle_timeout: Duration,
    /// Time for which sent bytes may stay unacknowledged by the peer's kernel. Detects a dead peer
    /// under load, when no keep-alive is sent.
    #[serde(with = "millis")]
    pub stall_timeout: Duration,
    /// First pause before a new attempt; doubles up to `backoff_max`, with jitter.
    #[serde(with = "millis")]
    pub backoff_min: Duration,
    /// Longest pause after transient errors.
    #[serde(with = "millis")]
    pub backoff_max: Duration,
    /// Pause after errors that need a person, such as bad credentials.
    #[serde(with = "millis")]
    pub backoff_permanent: Duration,
    /// First pause of one address that is full or refused; doubles with each failure.
    #[serde(with = "millis")]
    pub address_backoff: Duration,
}

impl Default for LinkLimits {
    fn default() -> Self {
        Self {
            window: 500,
            credit: 500,
            batch: 100,
            // The limit of the embedded broker: a message must fit on its whole way.
            message_bytes_max: 2 * 1024 * 1024,
            replay_share: ReplayShare::default(),
            connect_timeout: Duration::from_secs(10),
            outcome_timeout: Duration::from_secs(30),
            idle_timeout: Duration::from_secs(30),
            // Below the two above: a dead peer is reported as dead, and not as a slow answer.
            stall_timeout: Duration::from_secs(20),
            backoff_min: Duration::from_millis(200),
            backoff_max: Duration::from_secs(30),
            backoff_permanent: Duration::from_secs(120),
            address_backoff: Duration::from_secs(5),
        }
    }
}

mod millis {
    use std::time::Duration;

    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(value: &Duration, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(u64::try_from(value.as_millis()).unwrap_or(u64::MAX))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Duration, D::Error> {
        u64::deserialize(deserializer).map(Duration::from_millis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_limits_have_defaults_and_unknown_ones_are_refused() {
        let json = r#"{"window": 10, "backoff_max": 5000}"#;
        let limits: LinkLimits = serde_json::from_str(json).expect("limits");
        let expected =
            LinkLimits { window: 10, backoff_max: Duration::from_secs(5), ..LinkLimits::default() };
        assert_eq!(limits, expected);
        assert!(serde_json::from_str::<LinkLimits>(r#"{"windows": 10}"#).is_err());
    }
}
