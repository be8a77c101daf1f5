//! How a mapping is doing.

use std::time::Duration;

use asi_model::{DataValue, DateTime, FieldKey};
use mapping::{FaultRecord, FieldKeySchema, MappingId, TracedValue};
use serde::Serialize;
use utoipa::ToSchema;

use super::inventory::Entry;

/// How a mapping is doing, for its page.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MappingStatus {
    /// The mapping.
    #[schema(value_type = String)]
    pub mapping_id: MappingId,
    /// Its field.
    #[schema(value_type = FieldKeySchema)]
    pub target: FieldKey,
    /// Values that came.
    pub received: u64,
    /// Candidates that went out.
    pub yielded: u64,
    /// Values that were late.
    pub late: u64,
    /// Values that were repeats.
    pub repeated: u64,
    /// How often a source's clock was set back.
    pub clock_steps: u64,
    /// Values that a script could not keep up with, so that newer ones took their place.
    pub superseded: u64,
    /// Faults.
    pub faults: u64,
    /// The last fault.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_fault: Option<FaultRecord>,
    /// Time spent on it, in microseconds.
    pub spent_us: u64,
    /// When the last candidate went out, by the local clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, format = DateTime)]
    pub last_yielded_at: Option<DateTime>,
    /// The last candidate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_candidate: Option<TracedValue>,
    /// Its inputs.
    pub inputs: Vec<InputStatus>,
    /// Whether its scripts are run.
    pub circuit: CircuitState,
}

/// How an input is doing.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct InputStatus {
    /// Its name.
    pub name: String,
    /// The last value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<TracedValue>,
    /// When it came, by the local clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, format = DateTime)]
    pub received_at: Option<DateTime>,
    /// How far the source's clock is ahead of ours, in milliseconds, as seen at that value
    /// (transport included).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock_ahead_ms: Option<i64>,
}

/// Whether a mapping's scripts are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase", tag = "state")]
pub enum CircuitState {
    /// They are, or there are none.
    Closed,
    /// One rests because it did not keep to its budget.
    Resting {
        /// Until when, by the local clock.
        #[schema(value_type = String, format = DateTime)]
        until: DateTime,
    },
    /// One was let run again to see whether it works.
    Trying,
}

impl MappingStatus {
    pub(super) fn of(entry: &Entry) -> Self {
        let transform = &entry.transform;
        let mapping = &entry.mapping;
        let inputs = mapping.inputs.iter().enumerate().map(|(index, input)| {
            let last = transform.input(index);
            InputStatus {
                name: input.name.clone(),
                value: last.map(|(value, _)| TracedValue::of(value)),
                received_at: last.map(|(_, at)| at),
                clock_ahead_ms: last.and_then(|(value, at)| clock_ahead_ms(value, at)),
            }
        });
        Self {
            mapping_id: mapping.mapping_id.clone(),
            target: mapping.target.clone(),
            received: entry.received,
            yielded: entry.yielded,
            late: transform.counters.late,
            repeated: transform.counters.repeated,
            clock_steps: transform.counters.clock_steps,
            superseded: entry.superseded,
            faults: entry.faults,
            last_fault: entry.last_fault.as_deref().cloned(),
            spent_us: micros(entry.spent),
            last_yielded_at: entry.last_yielded_at,
            last_candidate: entry
                .last_yielded_at
                .and_then(|_| transform.shown())
                .as_ref()
                .map(TracedValue::of),
            inputs: inputs.collect(),
            circuit: entry.circuit(),
        }
    }
}

fn micros(duration: Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}

/// How far a source's clock is ahead of ours, as seen at a value that came then.
pub(super) fn clock_ahead_ms(value: &DataValue, received_at: DateTime) -> Option<i64> {
    value.source_timestamp.map(|source| source.unix_millis() - received_at.unix_millis())
}

impl Entry {
    /// Whether its scripts are run.
    pub(super) fn circuit(&self) -> CircuitState {
        let resting = self.scripts.iter().filter_map(|script| script.breaker.resting_until()).max();
        match resting {
            Some(until) => CircuitState::Resting { until },
            None if self.scripts.iter().all(|script| script.breaker.is_closed()) => {
                CircuitState::Closed
            }
            None => CircuitState::Trying,
        }
    }
}
