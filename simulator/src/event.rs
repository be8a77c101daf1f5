//! Events and conditions that a machine shows on command.

use serde::{Deserialize, Serialize};

/// Event of a machine (OPC 10000-5 §6.4.2).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct MachineEvent {
    pub message: String,
    /// 1 to 1000.
    pub severity: u16,
}

/// State of one of a machine's conditions: an alarm (OPC 10000-9 §5.8).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct MachineCondition {
    pub message: String,
    /// 1 to 1000.
    pub severity: u16,
    pub is_active: bool,
    /// False keeps a condition that is over among those of interest.
    #[serde(default = "yes")]
    pub is_acknowledged: bool,
}

const fn yes() -> bool {
    true
}

impl MachineCondition {
    /// Returns true while people should know of the condition.
    #[must_use]
    pub const fn is_retained(&self) -> bool {
        self.is_active || !self.is_acknowledged
    }
}
