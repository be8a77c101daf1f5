//! Candidates of mappings: on their way to the gates.

use asi_model::{DateTime, messages::ValueSource};
use connector_state::use_cases::values::{self, FieldCandidate};
use disclosure::GateOutcome;
use mapping_engine::{Candidate, TargetKey};

use super::unit_of_work::UnitOfWork;

/// Returns the candidates of mappings as those of fields.
pub(super) fn of_fields(candidates: impl Iterator<Item = Candidate>) -> Vec<FieldCandidate> {
    let of_field = |candidate| {
        let Candidate { target: TargetKey { field, version }, value, state: transform } = candidate;
        let (source, mapping_version) = (ValueSource::Mapping, Some(version));
        FieldCandidate { field, source, mapping_version, value, transform }
    };
    candidates.map(of_field).collect()
}

/// Offers candidates that came together to their fields. Metrics do not count those that a
/// withheld state keeps: their number would tell the state.
pub(super) fn receive(
    work: &mut UnitOfWork,
    candidates: Vec<FieldCandidate>,
    now: DateTime,
) -> Vec<Option<GateOutcome>> {
    let outcomes = values::receive_candidates(&mut work.state, candidates, now);
    let is_counted =
        |outcome: &&Option<GateOutcome>| !matches!(outcome, None | Some(GateOutcome::Suppressed));
    let count = outcomes.iter().filter(is_counted).count();
    if count > 0 {
        metrics::counter!("verbund_candidates_total").increment(count as u64);
    }
    outcomes
}
