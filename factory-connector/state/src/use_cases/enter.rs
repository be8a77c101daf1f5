//! Entries of operators: into the operation's journal, and from there through the gates of its
//! fields.

use std::time::Duration;

use asi_model::{DataValue, DateTime, FieldKey, StatusCode, messages::ValueSource};
use disclosure::GateOutcome;

use super::values::{FieldCandidate, receive_candidates};
use crate::{
    ChangeSet, ConnectorState,
    effects::ConnectorEvent,
    operator::{Action, EntryFault, OperationKey, OperatorEntry, typed_value},
    queries::fields_of_operation,
};

/// Age at which an entry that waited on a page is not accepted any more.
const AGE_MAX: Duration = Duration::from_secs(31 * 86_400);

/// Treatment of an operator's entry, and what it changed.
#[derive(Debug, Clone, PartialEq)]
pub enum EntryOutcome {
    /// Stored; these fields got a value from the entry.
    Taken(Vec<(FieldKey, GateOutcome)>),
    /// Stored before under the same id.
    Repeated,
    /// Refused for good: it is not stored.
    Refused(EntryFault),
}

/// Stores an entry, and offers what the journal now says to the gates of the fields that are
/// decided Manual.
pub fn enter(
    state: &mut ConnectorState,
    entry: OperatorEntry,
    now: DateTime,
) -> (EntryOutcome, ChangeSet) {
    let mut changes = ChangeSet::default();
    if let Err(fault) = check(state, &entry, now) {
        return (EntryOutcome::Refused(fault), changes);
    }
    let operation = entry.operation.clone();
    if let Some(journal) = state.journals.get(&operation) {
        if journal.has(&entry.entry_id) {
            return (EntryOutcome::Repeated, changes);
        }
        if journal.is_full() {
            return (EntryOutcome::Refused(EntryFault::TooMany), changes);
        }
    }
    state.journals.insert(entry.clone());
    changes.writes.operator_entries.push(entry);
    changes.effects.events.push(ConnectorEvent::Operator(operation.clone()));
    let (keys, candidates): (Vec<FieldKey>, Vec<FieldCandidate>) =
        answers(state, &operation).into_iter().unzip();
    let outcomes = receive_candidates(state, candidates, now);
    let taken = keys.into_iter().zip(outcomes).filter_map(|(key, taken)| Some((key, taken?)));
    (EntryOutcome::Taken(taken.collect()), changes)
}

/// Stores entries in any order, and returns their outcomes in the same order.
pub fn enter_all(
    state: &mut ConnectorState,
    entries: Vec<OperatorEntry>,
    now: DateTime,
) -> (Vec<EntryOutcome>, ChangeSet) {
    let mut changes = ChangeSet::default();
    let enter_one = |entry| {
        let (outcome, of_entry) = enter(state, entry, now);
        changes.merge(of_entry);
        outcome
    };
    let outcomes = entries.into_iter().map(enter_one).collect();
    (outcomes, changes)
}

fn check(state: &ConnectorState, entry: &OperatorEntry, now: DateTime) -> Result<(), EntryFault> {
    state.operation(&entry.operation).ok_or(EntryFault::UnknownOperation)?;
    entry.action.check()?;
    if now.since(entry.made_at) > AGE_MAX {
        return Err(EntryFault::TooOld);
    }
    if let Action::Value { value, .. } = &entry.action {
        let key = entry.action.field(&entry.operation);
        let field = key
            .and_then(|key| state.fields.get(&key))
            .filter(|field| field.decision().is_open_for(ValueSource::Manual))
            .ok_or(EntryFault::NotManual)?;
        typed_value(value, field.definition().field_type.0, entry.made_at)
            .map_err(EntryFault::WrongType)?;
    }
    Ok(())
}

/// Returns what an operation's journal says about those of its fields that are decided Manual.
fn answers(state: &ConnectorState, operation: &OperationKey) -> Vec<(FieldKey, FieldCandidate)> {
    let Some((document, journal)) = state.operation(operation).zip(state.journal(operation)) else {
        return Vec::new();
    };
    let manual = fields_of_operation(state, operation)
        .into_iter()
        .filter(|(_, field)| field.decision().is_open_for(ValueSource::Manual));
    let answer = |(key, field): (FieldKey, &crate::Field)| {
        let (semantic, field_type) =
            (field.definition().semantic.as_ref(), field.definition().field_type.0);
        let (answer, at) = journal.answer(&key, semantic, document.planned_quantity)?;
        let value = match answer.json(field_type) {
            None => DataValue::status_only(StatusCode::BAD_NO_DATA, Some(at)),
            // A meaning that does not fit the field's type says nothing; a typed value was checked
            // when it came.
            Some(json) => typed_value(&json, field_type, at).ok()?,
        };
        let candidate = FieldCandidate {
            field: field.id(),
            source: ValueSource::Manual,
            mapping_version: None,
            value,
            transform: None,
        };
        Some((key, candidate))
    };
    manual.filter_map(answer).collect()
}
