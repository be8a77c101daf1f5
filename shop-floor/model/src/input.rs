//! Requests for monitored variables, and the changes that callers receive.

use asi_model::values::{DataValue, NodeId};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::{BrowsePath, EventSelection, SourceId};

/// A caller's own key of one input. The same variable may be monitored under several keys.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, ToSchema,
)]
#[serde(transparent)]
pub struct InputKey(pub u64);

/// A new value of an input, with its quality and times as the source gave them.
#[derive(Debug, Clone, PartialEq)]
pub struct InputChange {
    pub input: InputKey,
    /// The value. `BadNotConnected` without value when the source is lost; another Bad status
    /// without value when the server refuses to monitor the node.
    pub value: DataValue,
}

/// Request to monitor a variable, or the events of a notifier.
#[derive(Debug, Clone, PartialEq)]
pub struct MonitorRequest {
    /// The caller's key.
    pub input: InputKey,
    /// Source of the variable; it need not be known or connected yet.
    pub source: SourceId,
    pub node_id: NodeId,
    pub options: MonitorOptions,
}

/// Options of a monitored variable or notifier.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", default, deny_unknown_fields)]
pub struct MonitorOptions {
    /// Sampling interval of the server, in milliseconds. 0: on every change. Default: the
    /// sampling interval of the source.
    pub sampling_interval_ms: Option<f64>,
    /// Changes that the server queues between two publishings. Default: enough for the sampling and
    /// publishing interval, so that no change is lost.
    pub queue_size: Option<u32>,
    /// Path of the variable from the Objects folder, to find it again when its node id changes.
    /// Without it, the path is looked up while the node is there.
    pub browse_path: Option<BrowsePath>,
    /// Part of an array, as OPC 10000-4 §7.27 writes it: `2` or `1:3`.
    pub index_range: Option<String>,
    /// Events of the node in the place of its value.
    // Boxed, because few inputs have any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events: Option<Box<EventSelection>>,
}
