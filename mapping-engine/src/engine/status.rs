//! Status of a mapping and of its inputs.

use std::time::Duration;

use asi_model::{DataValue, DateTime, FieldKey};
use mapping::{FaultRecord, MappingId, TracedValue};
use serde::Serialize;
use utoipa::ToSchema;

use super::inventory::RunningMapping;

/// Status of a mapping, for its page.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MappingStatus {
    pub mapping_id: MappingId,
    /// Field that gets the candidates.
    pub target: FieldKey,
    /// Values that came.
    pub received: u64,
    /// Candidates that went out.
    pub yielded: u64,
    /// Values that were late.
    pub late: u64,
    /// Values that were repeats.
    pub repeated: u64,
    /// Number of times that a source's clock was set back.
    pub clock_steps: u64,
    /// Values that newer ones replaced because a script did not keep up.
    pub superseded: u64,
    /// Number of faults since the mapping was published.
    pub faults: u64,
    /// Newest of the faults.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_fault: Option<FaultRecord>,
    /// Time spent on it, in microseconds.
    pub spent_us: u64,
    /// Time of the last candidate by the local clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_yielded_at: Option<DateTime>,
    /// Newest of the candidates that went out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub last_candidate: Option<TracedValue>,
    /// Last value of each input, in the mapping's order.
    pub inputs: Vec<InputStatus>,
    /// State of the circuit breakers of its scripts.
    pub circuit: CircuitState,
}

/// Last value of an input.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct InputStatus {
    /// Name of the input in the mapping.
    pub name: String,
    /// The last value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<TracedValue>,
    /// Arrival time by the local clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub received_at: Option<DateTime>,
    /// Difference of the source's clock to ours, in milliseconds, transport included; positive
    /// where the source is ahead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock_ahead_ms: Option<i64>,
}

/// State of the circuit breakers of a mapping's scripts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase", tag = "state")]
pub enum CircuitState {
    /// All breakers are closed, or the mapping has no script.
    Closed,
    /// One is open: its script did not keep to its budget.
    #[serde(rename = "resting")]
    Open {
        /// Time at which it is closed for one call, by the local clock.
        until: DateTime,
    },
    /// One was let run again to see whether it works.
    Trying,
}

impl MappingStatus {
    pub(super) fn of(running: &RunningMapping) -> Self {
        let transform = &running.transform;
        let mapping = &running.mapping;
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
            received: running.counters.received,
            yielded: running.counters.yielded,
            late: transform.counters.late,
            repeated: transform.counters.repeated,
            clock_steps: transform.counters.clock_steps,
            superseded: running.counters.superseded,
            faults: running.counters.faults,
            last_fault: running.counters.last_fault.as_deref().cloned(),
            spent_us: micros(running.counters.spent),
            last_yielded_at: running.counters.last_yielded_at,
            last_candidate: running
                .counters
                .last_yielded_at
                .and_then(|_| transform.shown())
                .as_ref()
                .map(TracedValue::of),
            inputs: inputs.collect(),
            circuit: running.circuit(),
        }
    }
}

fn micros(duration: Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}

/// Returns the difference of source time and arrival time, in milliseconds.
pub(super) fn clock_ahead_ms(value: &DataValue, received_at: DateTime) -> Option<i64> {
    value.source_timestamp.map(|source| source.unix_millis() - received_at.unix_millis())
}

impl RunningMapping {
    /// State of the circuit breakers of its scripts.
    pub(super) fn circuit(&self) -> CircuitState {
        let open_until = self.scripts.iter().filter_map(|script| script.breaker.open_until()).max();
        match open_until {
            Some(until) => CircuitState::Open { until },
            None if self.scripts.iter().all(|script| script.breaker.is_closed()) => {
                CircuitState::Closed
            }
            None => CircuitState::Trying,
        }
    }
}
