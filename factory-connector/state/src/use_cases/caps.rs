//! Caps of the information that partners get.
//!
//! A cap is a bound of a bound: as long as the sum of the bounds of all disclosed fields is within
//! it, nothing that a machine, script or person does lets more leave. So what would raise the sum
//! above a cap is refused, and a cap that is set below the sum ends consents until it holds. A
//! field that is held back is pending; it is not disclosed again by itself, since room under a cap
//! would otherwise tell a partner what is disclosed to others.

use asi_model::{DateTime, FieldKey};
use disclosure::{Cap, CapExcess, DecisionBasis, DocumentId, DocumentVersion};

use super::decide::{Course, DecisionCommand, DecisionRequest, decide_in};
use crate::{
    ChangeSet, ConnectorState, DocumentError, LogRecord, effects::ConnectorEvent,
    queries::held_back,
};

/// Reason that a partner reads when a cap holds a field back.
const HELD_BACK: &str = "The factory limits how much it discloses per hour.";

/// Stores a new version of a cap and holds fields back until it holds. Returns the version and the
/// fields.
///
/// # Errors
/// [`DocumentError`].
pub fn put_cap(
    state: &mut ConnectorState,
    id: &DocumentId,
    cap: Cap,
    expected: Option<u32>,
    by: &str,
    now: DateTime,
) -> Result<((DocumentVersion, Vec<FieldKey>), ChangeSet), DocumentError> {
    let row = state.budgets.put_cap(id, cap, expected, (by, now))?;
    let mut changes = ChangeSet::default();
    let version = row.key.clone();
    changes.writes.policies.caps.push(row);
    changes.effects.events.push(ConnectorEvent::Policies);
    let fields = hold_back(state, &mut changes, now);
    Ok(((version, fields), changes))
}

/// Ends consents until all caps hold, and returns their fields. The decision is that of the person
/// who set the cap.
pub(crate) fn hold_back(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    now: DateTime,
) -> Vec<FieldKey> {
    let found = held_back(state);
    let Some((_, [first, ..])) = found.first().map(|(key, excesses)| (key, &excesses[..])) else {
        return Vec::new();
    };
    let (cap, field_count) = (first.cap.id.clone(), found.len());
    changes.effects.log.push(LogRecord::FieldsHeldBack { cap, field_count });
    let mut course = Course::of_ending();
    let mut keys = Vec::with_capacity(found.len());
    for (key, excesses) in found {
        let request = decision(state, excesses);
        decide_in(state, changes, &key, request, &mut course, now)
            .expect("a known field can be left pending");
        keys.push(key);
    }
    keys
}

fn decision(state: &ConnectorState, excesses: Vec<CapExcess>) -> DecisionRequest {
    let author = excesses.iter().find_map(|excess| state.budgets.cap(&excess.cap.id));
    let decided_by = author.map(|cap| cap.changed_by.clone()).unwrap_or_default();
    let caps = excesses.into_iter().map(|excess| excess.cap).collect();
    DecisionRequest {
        command: DecisionCommand::LeavePending,
        reason: Some(HELD_BACK.to_owned()),
        decided_by,
        basis: DecisionBasis { caps, ..DecisionBasis::default() },
        preview: None,
    }
}
