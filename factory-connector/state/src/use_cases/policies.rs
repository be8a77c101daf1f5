//! Named policies and the policies of recipients. A change applies to all mapped fields at once,
//! and each field whose precision changes gets a consent of its own.

use std::{collections::BTreeSet, sync::Arc};

use asi_model::{DateTime, FieldKey, OrganisationId};
use disclosure::{
    DisclosurePolicy, DocumentId, DocumentVersion, NAME_CHARS_MAX, NamedPolicy, RuleFault,
};

use crate::{
    ChangeSet, ConnectorState, DocumentError, consents, dependencies, effects::ConnectorEvent,
    gates::through_gate, queries::effective_policy, writes::RecipientPolicyRow,
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
    apply(state, &mut changes, by, now);
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
    apply(state, &mut changes, by, now);
    Ok((version, changes))
}

/// Brings every mapped field to the precision that holds now.
fn apply(state: &mut ConnectorState, changes: &mut ChangeSet, by: &str, now: DateTime) {
    changes.effects.events.push(ConnectorEvent::Policies);
    let mut writers = BTreeSet::new();
    for (key, policy) in changed_fields(state) {
        let Some(mut field) = state.fields.get_mut(&key) else { continue };
        let id = field.id;
        field.gate.change_policy(policy, now);
        field.decision.decided_by = Some(by.to_owned());
        field.decision.decided_at = Some(now);
        field.decision.version += 1;
        writers.insert(field.writer);
        dependencies::update(state, &key, now);
        consents::record(state, changes, &key, now);
        through_gate(state, id, now, |_| ());
    }
    changes.to_refresh.extend(writers.into_iter().map(|writer| (writer, now)));
}

fn changed_fields(state: &ConnectorState) -> Vec<(FieldKey, Arc<DisclosurePolicy>)> {
    let mapped = state.fields.iter().filter(|field| field.decision.is_mapped());
    let changed = mapped.filter_map(|field| {
        let decision = &field.decision;
        let policy_id = decision.basis.policy_id.as_ref();
        let (policy, _) = effective_policy(state, field, &decision.policy, policy_id);
        (policy != *field.gate.policy()).then(|| (field.key.clone(), policy))
    });
    changed.collect()
}
