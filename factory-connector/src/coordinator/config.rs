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
}
