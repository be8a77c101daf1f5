//! State of a link, with the evidence for it: times, backlog and reason.

use serde::Serialize;
use time::OffsetDateTime;

use crate::spool::Backlog;

/// State of a link and the evidence for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "camelCase")]
pub struct LinkState {
    pub phase: LinkPhase,
    /// Time at which the phase was entered.
    #[serde(with = "time::serde::rfc3339")]
    #[cfg_attr(feature = "openapi", schema(value_type = String, format = DateTime))]
    pub since: OffsetDateTime,
    /// Address of the broker that the phase is about.
    pub broker: String,
    /// Time at which the broker last accepted a message.
    #[serde(with = "time::serde::rfc3339::option")]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<String>, format = DateTime))]
    pub last_accepted_at: Option<OffsetDateTime>,
    /// Time at which the last receipt of the platform arrived, as the owner reported.
    #[serde(with = "time::serde::rfc3339::option")]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<String>, format = DateTime))]
    pub last_receipted_at: Option<OffsetDateTime>,
    /// Time at which the last message was received.
    #[serde(with = "time::serde::rfc3339::option")]
    #[cfg_attr(feature = "openapi", schema(value_type = Option<String>, format = DateTime))]
    pub last_received_at: Option<OffsetDateTime>,
    /// Waiting and sent rows, as last counted.
    pub backlog: Backlog,
    /// Cause for which the link is not up, or an obstacle though it is; a sentence for people.
    pub reason: Option<String>,
    /// Number of connections established so far.
    pub connects: u64,
}

/// Progress of a link towards a connection with a broker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(tag = "state", rename_all = "camelCase")]
pub enum LinkPhase {
    /// A connection is being established.
    Connecting,
    /// Connected and signed in.
    Up,
    #[serde(rename_all = "camelCase")]
    #[cfg_attr(feature = "openapi", schema(rename_all = "camelCase"))]
    Down {
        /// Time of the next attempt.
        #[serde(with = "time::serde::rfc3339")]
        #[cfg_attr(feature = "openapi", schema(value_type = String, format = DateTime))]
        retry_at: OffsetDateTime,
        /// True when a person must act (credentials, permissions, certificates) before an attempt
        /// can succeed.
        is_permanent: bool,
    },
    /// The link was shut down and stays so.
    Stopped,
}

impl LinkState {
    pub(crate) fn initial(broker: String, now: OffsetDateTime) -> Self {
        Self {
            phase: LinkPhase::Connecting,
            since: now,
            broker,
            last_accepted_at: None,
            last_receipted_at: None,
            last_received_at: None,
            backlog: Backlog::default(),
            reason: None,
            connects: 0,
        }
    }

    /// Returns whether messages can flow.
    #[must_use]
    pub const fn is_up(&self) -> bool {
        matches!(self.phase, LinkPhase::Up)
    }

    /// Enters a phase; `since` changes only when the phase is another one.
    pub(crate) fn enter(&mut self, phase: LinkPhase, reason: Option<String>, now: OffsetDateTime) {
        if std::mem::discriminant(&self.phase) != std::mem::discriminant(&phase) {
            self.since = now;
        }
        self.phase = phase;
        self.reason = reason;
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn down_lasts_since_the_first_failure() {
        let start = OffsetDateTime::from_unix_timestamp(1_555_607_910).expect("a time");
        let mut state = LinkState::initial("amqp://localhost:5672".into(), start);
        let down = |at| LinkPhase::Down { retry_at: at, is_permanent: false };
        state.enter(down(start), Some("refused".into()), start + Duration::from_secs(1));
        state.enter(down(start), Some("refused".into()), start + Duration::from_secs(2));
        assert_eq!(state.since, start + Duration::from_secs(1));
    }
}
