//! Revocation: consents to several fields end at once, with one receipt.

use asi_model::{DateTime, FieldKey, messages::GapCause};
use disclosure::DecisionBasis;
use uuid::Uuid;

use super::decide::{Course, DecisionCommand, DecisionError, DecisionRequest, decide_in};
use crate::{
    ChangeSet, ConnectorState,
    change_set::{EndedConsents, Ending},
};

/// Fields whose consent a person ends, with the decision in its place.
#[derive(Debug, Clone)]
pub struct Revocation {
    pub fields: Vec<FieldKey>,
    /// [`DecisionCommand::LeavePending`] or [`DecisionCommand::Refuse`].
    pub command: DecisionCommand,
    /// Reason for the partners; a refusal needs one.
    pub reason: Option<String>,
    /// Name of the user.
    pub revoked_by: String,
}

/// Ends the consents to fields, all or none, and returns the id of the receipt. Fields that are not
/// mapped stay as they are.
///
/// # Errors
/// [`DecisionError`].
pub fn revoke(
    state: &mut ConnectorState,
    revocation: &Revocation,
    now: DateTime,
) -> Result<(Uuid, ChangeSet), DecisionError> {
    let Revocation { fields, command, reason, revoked_by } = revocation;
    let reason = reason.as_deref().filter(|reason| !reason.trim().is_empty());
    let known: Option<Vec<_>> = fields.iter().map(|key| state.field(key)).collect();
    let mapped: Vec<FieldKey> = known
        .ok_or(DecisionError::UnknownField)?
        .into_iter()
        .filter(|field| field.decision().is_mapped())
        .map(|field| field.key().clone())
        .collect();
    if mapped.is_empty() {
        return Err(DecisionError::NothingToRevoke);
    }
    if matches!(command, DecisionCommand::Refuse) && reason.is_none() {
        return Err(DecisionError::NoReason);
    }
    let ending =
        Ending { cause: GapCause::Revoked, reason, revoked_by: Some(revoked_by), is_joint: true };
    let mut changes = ChangeSet::default();
    let id = state.ids.next_uuid();
    changes.ended.push(EndedConsents::new(id, ending));
    let mut course = Course::of_ending();
    for key in mapped {
        let request = DecisionRequest {
            command: command.clone(),
            reason: reason.map(str::to_owned),
            decided_by: revoked_by.clone(),
            basis: DecisionBasis::default(),
            preview: None,
        };
        decide_in(state, &mut changes, &key, request, &mut course, now)?;
    }
    Ok((id, changes))
}
