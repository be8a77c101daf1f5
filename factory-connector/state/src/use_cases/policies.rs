//! Named policies and the policies of recipients. A change applies at once to all mapped fields that
//! it concerns, and each field whose precision changes gets a consent of its own.

use asi_model::{DateTime, FieldKey, OrganisationId};
use disclosure::{DocumentId, DocumentVersion, NAME_CHARS_MAX, NamedPolicy, RuleFault};

use crate::{
    ChangeSet, ConnectorState, DocumentError, Field, consents, dependencies,
    effects::ConnectorEvent,
    gates::through_gate,
    queries::{effective_policy, fields_for_recipient, fields_under_policy},
    writes::RecipientPolicyRow,
};

/// Stores a new version of a named policy, and applies it.
///
/// # Errors
/// [`DocumentError`].
pub fn put_policy(
    state: &mut ConnectorState,
    id: &DocumentId,
    policy: NamedPolicy,
    expected: Option<u32>,
    by: &str,
    now: DateTime,
) -> Result<(DocumentVersion, ChangeSet), DocumentError> {
    let mut faults: Vec<RuleFault> =
        policy.disclosure.own_faults().into_iter().map(RuleFault::from).collect();
    if policy.name.trim().is_empty() || policy.name.chars().count() > NAME_CHARS_MAX {
        let message = "A name has 1 to 120 characters.".to_owned();
        faults.insert(0, RuleFault { pointer: "/name".to_owned(), message });
    }
    if !faults.is_empty() {
        return Err(DocumentError::Faults(faults));
    }
    let row = state.policies.put_named(id, policy, expected, (by, now))?;
    let mut changes = ChangeSet::default();
    let version = row.key.clone();
    changes.writes.policies.named.push(row);
    let fields = keys_of(fields_under_policy(state, id));
    apply(state, &mut changes, fields, by, now);
    Ok((version, changes))
}

/// Sets a named policy for everything that a recipient gets, or takes it away, and returns the
/// version of the setting.
///
/// # Errors
/// [`DocumentError`].
pub fn set_recipient_policy(
    state: &mut ConnectorState,
    recipient: &OrganisationId,
    policy_id: Option<DocumentId>,
    expected: Option<u32>,
    by: &str,
    now: DateTime,
) -> Result<(u32, ChangeSet), DocumentError> {
    let set = state.policies.set_recipient(recipient, policy_id, expected, (by, now))?;
    let mut changes = ChangeSet::default();
    let version = set.version;
    let row = RecipientPolicyRow { recipient: recipient.clone(), set };
    changes.writes.policies.recipients.push(row);
    let fields = keys_of(fields_for_recipient(state, recipient));
    apply(state, &mut changes, fields, by, now);
    Ok((version, changes))
}

/// Brings these fields to the precision that holds now. Only a changed policy changes it: a revision
/// with other recipients takes the consent back.
fn apply(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    fields: Vec<FieldKey>,
    by: &str,
    now: DateTime,
) {
    changes.effects.events.push(ConnectorEvent::Policies);
    for key in fields {
        let Some(field) = state.fields.get(&key) else { continue };
        let (id, writer, decision) = (field.id(), field.writer(), field.decision());
        let policy_id = decision.basis.policy_id.as_ref();
        let (policy, _) = effective_policy(state, field, &decision.policy, policy_id);
        if policy == *field.gate().policy() {
            continue;
        }
        through_gate(state, id, now, |gate| gate.change_policy(policy, now));
        if let Some(mut field) = state.fields.get_mut(&key) {
            field.change_decision(|decision| {
                decision.decided_by = Some(by.to_owned());
                decision.decided_at = Some(now);
                decision.version += 1;
            });
        }
        dependencies::update(state, &key, now);
        consents::record(state, changes, &key, now);
        changes.to_refresh.insert(writer, now);
    }
}

fn keys_of<'s>(fields: impl Iterator<Item = &'s Field>) -> Vec<FieldKey> {
    let mut keys: Vec<FieldKey> = fields.map(|field| field.key().clone()).collect();
    keys.sort();
    keys.dedup();
    keys
}
