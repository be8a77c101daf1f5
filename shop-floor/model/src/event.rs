//! Events as inputs: which of them, and the value that they make.

use asi_model::values::NodeId;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::BrowsePath;

/// Highest severity of an event (OPC 10000-5 §6.4.2).
pub const SEVERITY_MAX: u16 = 1000;

/// Events of a notifier that an input takes (OPC 10000-4 §7.22.3), and the value that they make. The notifier is the node
/// of the input: the Server object (`i=2253`), or another object that may be subscribed to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct EventSelection {
    pub value: EventValue,
    /// Events of this type and its subtypes. Absent: of any type; for conditions, of any type of conditions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub event_type: Option<NodeId>,
    /// Node that the events are about. Absent: any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source_node: Option<NodeId>,
    /// Least severity, 1 to 1000. Absent: any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub severity_min: Option<u16>,
}

/// Value that events make of an input.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(
    rename_all = "camelCase",
    rename_all_fields = "camelCase",
    tag = "kind",
    deny_unknown_fields
)]
pub enum EventValue {
    /// A field of the last event that has it.
    #[schema(rename_all = "camelCase")]
    Field {
        /// Browse names from the event to the field: `["Message"]`.
        path: BrowsePath,
    },
    /// Number of active conditions (UInt32).
    ActiveConditions,
    /// Highest severity of the active conditions (UInt16), 0 while there is none.
    ActiveSeverity,
    /// Message of the most severe active condition, of several the newest (LocalizedText); an empty text while there is
    /// none.
    ActiveMessage,
}

impl EventValue {
    /// Returns true where the value follows from the conditions that are active, and not from the last event.
    #[must_use]
    pub const fn is_of_conditions(&self) -> bool {
        !matches!(self, Self::Field { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn selections_survive_json() {
        for json in [
            r#"{"value":{"kind":"field","path":["Message"]}}"#,
            r#"{"value":{"kind":"activeConditions"},"eventType":"i=2915","sourceNode":"nsu=urn:press;s=Ram","severityMin":500}"#,
            r#"{"value":{"kind":"activeSeverity"}}"#,
            r#"{"value":{"kind":"activeMessage"},"severityMin":1}"#,
        ] {
            let selection: EventSelection = serde_json::from_str(json).expect("valid");
            assert_eq!(serde_json::to_string(&selection).expect("serialises"), json);
        }
        for wrong in [r#"{"value":{"kind":"last"}}"#, r#"{"eventType":"i=2915"}"#] {
            assert!(serde_json::from_str::<EventSelection>(wrong).is_err(), "{wrong}");
        }
    }
}
