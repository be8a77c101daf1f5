//! Validity of requests: values flow while a request asks for them.

use std::collections::BTreeSet;

use asi_model::DateTime;

use super::values::{FieldCandidate, TakenCandidate, receive_candidates};
use crate::{ChangeSet, ConnectorState, Field, LogRecord, consents, endings};

/// Reason that a partner reads when its request has ended.
const ENDED: &str = "The request's validity has ended.";

/// Releases the values that were kept for requests which ask for them from now on, all at once: a state
/// among them withholds the others. Returns them.
pub fn begin_requests(state: &mut ConnectorState, now: DateTime) -> Vec<TakenCandidate> {
    let mut kept = Vec::new();
    while let Some(id) = state.fields.pop_beginning(now) {
        let Some(mut field) = state.fields.by_id_mut(id) else { continue };
        if let Some((value, source)) = field.take_kept().zip(field.decision().value_source) {
            let (mapping_version, transform) = (None, None);
            kept.push(FieldCandidate { field: id, source, mapping_version, value, transform });
        }
    }
    let outcomes = receive_candidates(state, kept.clone(), now);
    TakenCandidate::all_of(kept, outcomes)
}

/// Ends the consents to fields whose requests have ended: they are undecided again. Values that
/// were disclosed in time are still delivered.
pub fn end_requests(state: &mut ConnectorState, now: DateTime) -> ChangeSet {
    let mut changes = ChangeSet::default();
    let mut writers = BTreeSet::new();
    for key in state.fields.ended(now) {
        let before = endings::disclosed(state, std::iter::once(&key), now);
        consents::close(state, &mut changes, &key, ENDED, now);
        endings::note(state, &mut changes, before, now);
        writers.extend(state.field(&key).map(Field::writer));
        changes.effects.log.push(LogRecord::RequestEnded { field: key });
    }
    changes.to_refresh.extend(writers.into_iter().map(|writer| (writer, now)));
    changes
}
