//! How the link stands: evidence, not a green dot.

use serde::Serialize;
use time::OffsetDateTime;

use crate::spool::Backlog;

/// How the link stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct LinkState {
    /// The state.
    pub phase: LinkPhase,
    /// Since when.
    #[serde(with = "time::serde::rfc3339")]
    pub since: OffsetDateTime,
    /// Which broker address it concerns.
    pub broker: String,
    /// When the broker accepted a message last.
    #[serde(with = "time::serde::rfc3339::option")]
    pub last_accepted_at: Option<OffsetDateTime>,
    /// When a receipt of the platform arrived last, as the owner told.
    #[serde(with = "time::serde::rfc3339::option")]
    pub last_receipted_at: Option<OffsetDateTime>,
    /// When a message was received last.
    #[serde(with = "time::serde::rfc3339::option")]
    pub last_received_at: Option<OffsetDateTime>,
    /// What waits, as of the last look into the store.
    pub backlog: Backlog,
    /// Why the link is not up, or what hinders it though it is; a sentence for people.
    pub reason: Option<String>,
    /// How often the connection was established.
    pub connects: u64,
}

/// The state of a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(tag = "state", rename_all = "camelCase")]
pub enum LinkPhase {
    /// A connection is being established.
    Connecting,
    /// Connected and signed in.
    Up,
    /// Not connected.
    #[serde(rename_all = "camelCase")]
    Down {
        /// When the next attempt is made.
        #[serde(with = "time::serde::rfc3339")]
        retry_at: OffsetDateTime,
        /// Whether somebody must act (credentials, permissions, certificates) before an attempt can
        /// succeed.
        is_permanent: bool,
    },
    /// Shut down.
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

    /// Whether messages can flow.
    #[must_use]
    pub const fn is_up(&self) -> bool {
        matches!(self.phase, LinkPhase::Up)
    }

    /// Enters a phase; `since` moves only when the phase is another one.
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
