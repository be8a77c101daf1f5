//! Events of a notifier, reduced to the value of an input.
//!
//! The server selects events by their type and source. Severity decides there for the last event, and here for conditions:
//! a condition that becomes less severe than is asked for must be heard of.

mod conditions;
mod filter;
mod reduction;

use asi_model::values::{DateTime, NodeId, Scalar, Variant};

pub(super) use filter::event_filter;
pub(super) use reduction::{EventReduction, Reaction};

/// Types of events that speak of the subscription itself (OPC 10000-9 §5.11, OPC 10000-5 §6.4.35).
const REFRESH_START: NodeId = NodeId::ua(2787);
const REFRESH_END: NodeId = NodeId::ua(2788);
const REFRESH_REQUIRED: NodeId = NodeId::ua(2789);
const QUEUE_OVERFLOW: NodeId = NodeId::ua(3035);

/// Fields that are selected of each event, in this order; the chosen field or those of a condition follow.
const COMMON_FIELDS: [&str; 2] = ["EventType", "Time"];

/// Fields of an event as they came, in the order of the select clauses.
#[derive(Debug)]
struct EventFields {
    event_type: Option<NodeId>,
    time: Option<DateTime>,
    others: std::vec::IntoIter<Variant>,
}

impl EventFields {
    /// Returns `None` where fields are missing.
    fn read(fields: Vec<Variant>, others: usize) -> Option<Self> {
        if fields.len() != COMMON_FIELDS.len() + others {
            return None;
        }
        let mut fields = fields.into_iter();
        let event_type = node_id(&fields.next()?);
        let time = match fields.next()? {
            Variant::Scalar(Scalar::DateTime(time)) => Some(time),
            _ => None,
        };
        Some(Self { event_type, time, others: fields })
    }
}

fn node_id(value: &Variant) -> Option<NodeId> {
    match value {
        Variant::Scalar(Scalar::NodeId(id)) => Some((**id).clone()),
        _ => None,
    }
}

fn boolean(value: &Variant) -> Option<bool> {
    match value {
        Variant::Scalar(Scalar::Boolean(is_true)) => Some(*is_true),
        _ => None,
    }
}
