//! Limits of the spool, and settings of the ledger.

use std::time::Duration;

use messaging::spool::{OverduePolicy, ReplayShare};

/// Settings of the ledger and of its witness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LedgerConfig {
    /// Days after which values are emptied; their hashes stay. For ever where 0.
    pub value_days: u32,
    /// Days after which entries are removed; a signed anchor stays. For ever where 0.
    pub entry_days: u32,
    /// Seconds after a start for which reports wait at most for the platform's word about the ledger,
    /// counted from the first that could leave; none where 0.
    pub witness_wait_s: u32,
}

impl Default for LedgerConfig {
    fn default() -> Self {
        Self { value_days: 0, entry_days: 0, witness_wait_s: 10 }
    }
}

impl LedgerConfig {
    /// Returns the limits of retention.
    pub(crate) const fn retention(&self) -> RetentionLimits {
        RetentionLimits { value_days: self.value_days, entry_days: self.entry_days }
    }

    /// Returns the longest wait for the platform's word.
    pub(crate) const fn witness_wait(&self) -> Duration {
        Duration::from_secs(self.witness_wait_s as u64)
    }
}

/// Retention of what was sent. The ledger stays provable in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RetentionLimits {
    /// Days after which values are emptied; their hashes stay. For ever where 0.
    pub value_days: u32,
    /// Days after which entries are removed; a signed anchor stays. For ever where 0.
    pub entry_days: u32,
}

/// Bounds of waiting reports, and when they are sent again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SpoolLimits {
    /// Bytes of reports above which older ones are dropped for newer ones.
    pub bytes_max: u64,
    /// Age above which reports are dropped, in hours.
    pub age_hours_max: u32,
    /// Seconds without a receipt after which a report is sent again; doubles with each time, up to
    /// an hour.
    pub resend_after_s: u32,
    /// Share of the reports that a backlog gets while new ones wait, in percent.
    pub replay_share_percent: ReplayShare,
}

impl Default for SpoolLimits {
    fn default() -> Self {
        Self {
            bytes_max: 2 << 30,
            age_hours_max: 30 * 24,
            resend_after_s: 60,
            replay_share_percent: ReplayShare::default(),
        }
    }
}

impl SpoolLimits {
    /// Returns the times after which reports without a receipt are sent again.
    pub(crate) const fn overdue(&self) -> OverduePolicy {
        OverduePolicy {
            receipt_timeout: Duration::from_secs(self.resend_after_s as u64),
            // Each repeat costs the plant's uplink; a platform that is away for long needs none.
            receipt_timeout_max: Duration::from_secs(3600),
        }
    }
}
