//! Alliances of partners that tell each other what they get.

use asi_model::DateTime;
use disclosure::{Alliance, DocumentId, DocumentVersion};

use crate::{
    ChangeSet, ConnectorState, DocumentError, effects::ConnectorEvent, queries::cap_usage,
};

/// Stores a new version of an alliance, where its members together stay within all caps.
///
/// # Errors
/// [`DocumentError`].
pub fn put_alliance(
    state: &mut ConnectorState,
    id: &DocumentId,
    alliance: Alliance,
    expected: Option<u32>,
    by: &str,
    now: DateTime,
) -> Result<(DocumentVersion, ChangeSet), DocumentError> {
    let (before, usage) = (state.budgets.clone(), cap_usage(state, now));
    let row = state.budgets.put_alliance(id, alliance, expected, (by, now))?;
    let excesses = cap_usage(state, now).excesses_over(&usage);
    if !excesses.is_empty() {
        state.budgets = before;
        return Err(DocumentError::OverCap(excesses));
    }
    let mut changes = ChangeSet::default();
    let version = row.key.clone();
    changes.writes.policies.alliances.push(row);
    changes.effects.events.push(ConnectorEvent::Policies);
    Ok((version, changes))
}
