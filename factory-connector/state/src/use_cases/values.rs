//! Values: through the gate. This is the only way by which a value can get into a report.

use asi_model::{DataValue, DateTime, FieldKey, StatusCode, messages::ValueSource};
use disclosure::GateOutcome;
use mapping::TransformState;

use crate::{ConnectorState, Field, dependencies, gates::through_gate, queries::write_refusal};

/// Offers a candidate to the field with this number. `None` where the field accepts none from this
/// source, or none now.
pub fn receive_candidate(
    state: &mut ConnectorState,
    id: i64,
    source: ValueSource,
    value: DataValue,
    transform: Option<TransformState>,
    now: DateTime,
) -> Option<GateOutcome> {
    let mut field =
        state.fields.by_id_mut(id).filter(|field| field.decision().is_open_for(source))?;
    if !field.validity().contains(now) {
        if let Some(from) = field.validity().from.filter(|from| *from > now) {
            field.keep_until(value, from);
        }
        return None;
    }
    field.receive(value.clone(), transform, now);
    // Dependent gates learn a new state before anything of theirs is released.
    if let Some(key) = state.fields.key_with_dependents(id) {
        dependencies::notify(state, &key, now);
    }
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
}
