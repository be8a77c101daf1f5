//! Survey of all mappings: numbers by health, the worst first.

use std::cmp::Reverse;

use asi_model::{DateTime, StatusCode};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    inventory::{Inventory, RunningMapping},
    status::{CircuitState, MappingStatus, clock_ahead_ms},
};

/// A source's clock that is further ahead of ours is worth a word: no value is measured after it
/// has come.
const CLOCK_AHEAD_MS_MAX: i64 = 60_000;

/// Health of a mapping; the worst first.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, ToSchema,
)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum MappingHealth {
    /// A script of it did not keep to its budget: its circuit is open, or was closed for one call
    /// that has yet to succeed.
    #[serde(rename = "RESTING")]
    CircuitOpen,
    /// Its last result was a fault.
    Failing,
    /// An input has had no value yet.
    Waiting,
    /// Its last value is uncertain or bad, as its inputs are.
    Doubtful,
    /// The clock of a source is more than a minute ahead.
    ClockAhead,
    /// None of the other conditions holds.
    Well,
}

/// Number of mappings by health.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct HealthCounts {
    /// Number of mappings that are `RESTING`.
    #[serde(rename = "resting")]
    pub circuit_open: usize,
    /// Number of mappings that are `FAILING`.
    pub failing: usize,
    /// Number of mappings that are `WAITING`.
    pub waiting: usize,
    /// Number of mappings that are `DOUBTFUL`.
    pub doubtful: usize,
    /// Number of mappings that are `CLOCK_AHEAD`.
    pub clock_ahead: usize,
    /// Number of mappings that are `WELL`.
    pub well: usize,
}

/// A mapping with the health that it is listed under.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SurveyedMapping {
    /// Health from which its rank follows.
    pub health: MappingHealth,
    /// Counters, inputs and last candidate.
    pub status: MappingStatus,
}

/// Health of the published mappings, without shadow mappings.
#[derive(Debug, Clone, PartialEq, Default, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MappingSurvey {
    /// Numbers of all published mappings.
    pub counts: HealthCounts,
    /// The worst of those that were asked for; of two that are doing alike, the one with more
    /// faults first.
    pub items: Vec<SurveyedMapping>,
}

impl MappingHealth {
    pub(super) fn of(running: &RunningMapping) -> Self {
        let transform = &running.transform;
        let inputs = || (0..running.mapping.inputs.len()).map(|index| transform.input(index));
        if running.circuit() != CircuitState::Closed {
            return Self::CircuitOpen;
        }
        // Values of one batch have one time: of a fault and a candidate at the same time the status
        // says which was last.
        let is_good = transform.shown_status().is_none_or(StatusCode::is_good);
        let has_come_last = |at: DateTime| {
            running
                .counters
                .last_yielded_at
                .is_none_or(|yielded| at > yielded || at == yielded && !is_good)
        };
        if running.counters.last_fault.as_ref().is_some_and(|fault| has_come_last(fault.at)) {
            return Self::Failing;
        }
        if inputs().any(|input| input.is_none()) {
            return Self::Waiting;
        }
        if !is_good {
            return Self::Doubtful;
        }
        let is_ahead =
            |(value, at)| clock_ahead_ms(value, at).is_some_and(|ahead| ahead > CLOCK_AHEAD_MS_MAX);
        if inputs().flatten().any(is_ahead) { Self::ClockAhead } else { Self::Well }
    }
}

impl HealthCounts {
    fn add(&mut self, health: MappingHealth) {
        *match health {
            MappingHealth::CircuitOpen => &mut self.circuit_open,
            MappingHealth::Failing => &mut self.failing,
            MappingHealth::Waiting => &mut self.waiting,
            MappingHealth::Doubtful => &mut self.doubtful,
            MappingHealth::ClockAhead => &mut self.clock_ahead,
            MappingHealth::Well => &mut self.well,
        } += 1;
    }
}

impl MappingSurvey {
    /// Looks at every mapping once, and copies only those it returns.
    pub(super) fn of(inventory: &Inventory, wanted: Option<MappingHealth>, most: usize) -> Self {
        let mut counts = HealthCounts::default();
        let mut found: Vec<(MappingHealth, &RunningMapping)> = Vec::new();
        for running in inventory.iter().filter(|running| !running.is_shadow) {
            let health = MappingHealth::of(running);
            counts.add(health);
            if most > 0 && wanted.is_none_or(|wanted| wanted == health) {
                found.push((health, running));
            }
        }
        let rank = |(health, running): &(MappingHealth, &RunningMapping)| {
            (*health, Reverse(running.counters.faults))
        };
        if found.len() > most {
            found.select_nth_unstable_by_key(most - 1, rank);
        }
        found.truncate(most);
        found.sort_unstable_by(|one, other| {
            let by_field = || one.1.mapping.target.cmp(&other.1.mapping.target);
            rank(one).cmp(&rank(other)).then_with(by_field)
        });
        let surveyed =
            |(health, running)| SurveyedMapping { health, status: MappingStatus::of(running) };
        Self { counts, items: found.into_iter().map(surveyed).collect() }
    }
}
