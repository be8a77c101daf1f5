//! Configuration of the coordinator.

use std::time::Duration;

use connector_state::StateConfig;

use crate::config::{RetentionLimits, SpoolLimits};

/// Settings that do not change while the coordinator runs.
#[derive(Debug, Clone)]
pub struct CoordinatorConfig {
    /// Identity and form of the reports.
    pub state: StateConfig,
    /// The shortest time between two reports of one data set.
    pub publishing_interval: Duration,
    pub spool: SpoolLimits,
    /// Retention of what was sent.
    pub retention: RetentionLimits,
    /// Longest time after a start for which reports wait for the platform's word about the ledger;
    /// none with 0.
    pub witness_wait: Duration,
}
