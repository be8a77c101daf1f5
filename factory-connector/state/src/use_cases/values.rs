//! Values: through the gate. This is the only way by which a value can get into a report.

use asi_model::{DataValue, DateTime, FieldKey, StatusCode, messages::ValueSource};
use disclosure::GateOutcome;
use mapping::TransformState;

use crate::{ConnectorState, Field, dependencies, gates::through_gate, queries::write_refusal};

/// A candidate for the gate of a field.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldCandidate {
    /// Number of the field.
    pub field: i64,
    pub source: ValueSource,
    /// Number of the mapping's version; none for people and OPC UA clients.
    pub mapping_version: Option<u32>,
    pub value: DataValue,
    /// State of the mapping's functions after this value.
    pub transform: Option<TransformState>,
}

/// A candidate with what its gate made of it.
#[derive(Debug, Clone, PartialEq)]
pub struct TakenCandidate {
    candidate: FieldCandidate,
    outcome: Option<GateOutcome>,
}

impl TakenCandidate {
    /// Joins candidates with the outcomes of [`receive_candidates`].
    pub fn all_of(
        candidates: Vec<FieldCandidate>,
        outcomes: Vec<Option<GateOutcome>>,
    ) -> Vec<Self> {
        let joined = candidates.into_iter().zip(outcomes);
        joined.map(|(candidate, outcome)| Self { candidate, outcome }).collect()
    }
}

/// Offers candidates that came together to their fields. States in which other fields are withheld
/// are judged first, wherever they stand among the candidates: no value of the same batch is
/// released. `None` where a field accepts no candidate from its source, or none now.
pub fn receive_candidates(
    state: &mut ConnectorState,
    candidates: Vec<FieldCandidate>,
    now: DateTime,
) -> Vec<Option<GateOutcome>> {
    // True for states that withhold some field, at any place of the batch.
    let mut states: Vec<(FieldKey, bool)> = Vec::new();
    for candidate in &candidates {
        let Some(key) = state.fields.key_with_dependents(candidate.field) else { continue };
        if !is_accepted(state, candidate, now) {
            continue;
        }
        let is_withholding = dependencies::is_withholding(state, &key, &candidate.value);
        match states.iter_mut().find(|(known, _)| *known == key) {
            Some((_, is_any)) => *is_any |= is_withholding,
            None => states.push((key, is_withholding)),
        }
    }
    for candidate in candidates.iter().filter(|_| !states.is_empty()) {
        let key = state.fields.key_with_dependents(candidate.field);
        let known = key.and_then(|key| states.iter().find(|(state, _)| *state == key));
        if let Some((key, is_withholding)) = known.filter(|_| is_accepted(state, candidate, now)) {
            dependencies::announce(state, key, &candidate.value, *is_withholding, now);
        }
    }
    let outcomes = candidates.into_iter().map(|candidate| {
        let id = candidate.field;
        let outcome = take(state, candidate, now);
        if !states.is_empty()
            && let Some(key) = state.fields.key_with_dependents(id)
            && states.contains(&(key.clone(), false))
        {
            dependencies::notify(state, &key, now);
        }
        outcome
    });
    let outcomes = outcomes.collect();
    for (key, _) in states {
        dependencies::notify(state, &key, now);
    }
    outcomes
}

/// Offers one candidate to its field, as [`receive_candidates`] does.
pub fn receive_candidate(
    state: &mut ConnectorState,
    id: i64,
    source: ValueSource,
    value: DataValue,
    transform: Option<TransformState>,
    now: DateTime,
) -> Option<GateOutcome> {
    let mapping_version = None;
    let candidate = FieldCandidate { field: id, source, mapping_version, value, transform };
    receive_candidates(state, vec![candidate], now).pop().flatten()
}

fn is_accepted(state: &ConnectorState, candidate: &FieldCandidate, now: DateTime) -> bool {
    let FieldCandidate { field, source, mapping_version, .. } = candidate;
    let field = state.fields.by_id(*field);
    field.is_some_and(|field| {
        // States count before the request begins, too: what comes meanwhile may be kept until then.
        is_open_for(field, *source, *mapping_version) && !field.validity().has_ended(now)
    })
}

/// Returns true while values flow from this source. Candidates of a former mapping may still be on
/// their way.
fn is_open_for(field: &Field, source: ValueSource, mapping_version: Option<u32>) -> bool {
    field.decision().is_open_for(source)
        && mapping_version.is_none_or(|version| version == field.versions().of_decision())
}

fn take(
    state: &mut ConnectorState,
    candidate: FieldCandidate,
    now: DateTime,
) -> Option<GateOutcome> {
    let FieldCandidate { field: id, source, mapping_version, value, transform } = candidate;
    let field =
        state.fields.by_id(id).filter(|field| is_open_for(field, source, mapping_version))?;
    let validity = field.validity();
    if validity.has_ended(now) {
        return None;
    }
    if let Some(from) = validity.from.filter(|from| *from > now) {
        let is_withheld = through_gate(state, id, now, |gate| gate.withholds(now, &value))?;
        state.fields.by_id_mut(id)?.keep_until(value, is_withheld, from);
        return None;
    }
    let mut field = state.fields.by_id_mut(id)?;
    field.receive(value.clone(), transform, now);
    through_gate(state, id, now, |gate| gate.on(now, value))
}

/// Offers a value of a person or an OPC UA client to a field.
///
/// # Errors
/// The status code that says why the field does not accept it.
pub fn write_value(
    state: &mut ConnectorState,
    key: &FieldKey,
    source: ValueSource,
    value: DataValue,
    now: DateTime,
) -> Result<GateOutcome, StatusCode> {
    let refusal = write_refusal(state, key, source, now);
    let id = state.field(key).map(Field::id);
    id.and_then(|id| receive_candidate(state, id, source, value, None, now))
        .ok_or(refusal.unwrap_or(StatusCode::BAD_NOT_WRITABLE))
}

/// Lets a state that was read again after a failed transaction know what the former one knew of machines: the newest
/// values, which say whether they withhold others, and those that are kept until their requests begin.
pub fn know_again(state: &mut ConnectorState, former: &ConnectorState, now: DateTime) {
    let is_mapped = |field: &Field| field.decision().is_open_for(ValueSource::Mapping);
    let mut known = Vec::new();
    for field in state.fields.iter().filter(|field| is_mapped(field)) {
        let before = former.fields.by_id(field.id()).filter(|before| is_mapped(before));
        let before = before.filter(|before| before.target_key() == field.target_key());
        known.extend(before.and_then(|before| {
            let newest = before.newest()?.clone();
            Some((field.id(), field.validity().from, newest, before.kept().cloned()))
        }));
    }
    for (id, from, newest, kept) in known {
        if let Some(mut field) = state.fields.by_id_mut(id) {
            if let Some((kept, from)) = kept.zip(from) {
                field.keep_until(kept, false, from);
            }
            field.know(newest);
        }
        if let Some(key) = state.fields.key_with_dependents(id) {
            dependencies::notify(state, &key, now);
        }
    }
}

/// Takes candidates of a failed transaction again, each once. What a state withheld stays withheld, though the state may
/// have ended meanwhile.
pub fn take_again(
    state: &mut ConnectorState,
    taken: Vec<TakenCandidate>,
    now: DateTime,
) -> Vec<TakenCandidate> {
    let again = taken.into_iter().map(|TakenCandidate { candidate, outcome }| {
        let outcome = match outcome {
            Some(GateOutcome::Suppressed) => {
                withhold(state, candidate.clone(), now);
                outcome
            }
            _ => take(state, candidate.clone(), now),
        };
        TakenCandidate { candidate, outcome }
    });
    again.collect()
}

/// Notes a candidate that is not to be released, with the state that it has itself.
fn withhold(state: &mut ConnectorState, candidate: FieldCandidate, now: DateTime) {
    if !is_accepted(state, &candidate, now) {
        return;
    }
    let FieldCandidate { field: id, value, transform, .. } = candidate;
    if let Some(mut field) = state.fields.by_id_mut(id) {
        field.receive(value.clone(), transform, now);
    }
    through_gate(state, id, now, |gate| {
        // Its own state may have begun with it, and a mean pauses then.
        gate.withholds(now, &value).then(|| gate.on(now, value))
    });
}

/// Asks every gate whose deadline is over.
pub fn release_due(state: &mut ConnectorState, now: DateTime) {
    while let Some(id) = state.fields.pop_release(now) {
        through_gate(state, id, now, |gate| gate.on_time(now));
    }
}

/// Follows the machine's clock where it was set back to `now`: nothing waits for a time that was
/// meant by the old clock.
pub fn set_clock_back(state: &mut ConnectorState, now: DateTime) {
    state.writers.set_clock_back(now);
    state.fields.set_clock_back(now);
    state.former.set_clock_back(now);
}
