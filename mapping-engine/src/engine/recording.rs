//! Recorded values of a variable as they outlast a restart.

use asi_model::{DataValue, DateTime, NodeId};
use shop_floor::{MonitorOptions, SourceId};

/// Last values of a variable that mappings use, for dry runs after the next start.
#[derive(Debug, Clone, PartialEq)]
pub struct VariableRecording {
    pub source_id: SourceId,
    pub node_id: NodeId,
    pub monitor: MonitorOptions,
    /// Oldest first, each with the time it came by the local clock.
    pub values: Vec<(DateTime, DataValue)>,
}
