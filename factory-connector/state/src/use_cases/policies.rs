//! Named policies and the policies of recipients. A change applies at once to all mapped fields that
//! it concerns, and each field whose precision changes gets a consent of its own.

use std::sync::Arc;

use asi_model::{DateTime, FieldKey, OrganisationId};
use disclosure::{
    DisclosurePolicy, DocumentId, DocumentVersion, NAME_CHARS_MAX, NamedPolicy, RuleFault,
};

use crate::{
    ChangeSet, ConnectorState, DocumentError, Field, PolicyRegistry, consents, dependencies,
    effects::ConnectorEvent,
    gates::through_gate,
    queries::{
        Supposed, cap_usage, effective_policy, exchanges, fields_for_recipient, fields_under_policy,
    },
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
    let before = state.policies.clone();
    let row = state.policies.put_named(id, policy, expected, (by, now))?;
    let fields = revised(state, fields_under_policy(state, id));
    admit(state, &fields, before, now)?;
    let mut changes = ChangeSet::default();
    let version = row.key.clone();
    changes.writes.policies.named.push(row);
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
    let before = state.policies.clone();
    let set = state.policies.set_recipient(recipient, policy_id, expected, (by, now))?;
    let fields = revised(state, fields_for_recipient(state, recipient));
    admit(state, &fields, before, now)?;
    let mut changes = ChangeSet::default();
    let version = set.version;
    let row = RecipientPolicyRow { recipient: recipient.clone(), set };
    changes.writes.policies.recipients.push(row);
    apply(state, &mut changes, fields, by, now);
    Ok((version, changes))
}

/// A field with the policy that is in force for it from now on.
type Revised = (FieldKey, Arc<DisclosurePolicy>);

/// Returns those of these fields whose policy in force changes, sorted, each once. Only a changed
/// policy changes it: a revision with other recipients takes the consent back.
fn revised<'s>(state: &ConnectorState, fields: impl Iterator<Item = &'s Field>) -> Vec<Revised> {
    let revise = |field: &Field| {
        let decision = field.decision();
        let policy_id = decision.basis.policy_id.as_ref();
        let (policy, _) = effective_policy(state, field, &decision.policy, policy_id);
        (policy != *field.gate().policy()).then(|| (field.key().clone(), policy))
    };
    let mut revised: Vec<Revised> = fields.filter_map(revise).collect();
    revised.sort_by(|left, right| left.0.cmp(&right.0));
    revised.dedup_by(|left, right| left.0 == right.0);
    revised
}

/// Checks that all caps hold with the new policies; otherwise the former documents hold again.
fn admit(
    state: &mut ConnectorState,
    fields: &[Revised],
    former: PolicyRegistry,
    now: DateTime,
) -> Result<(), DocumentError> {
    let mut usage = cap_usage(state, now);
    if usage.is_empty() {
        return Ok(());
    }
    let supposed = fields.iter().map(|(key, policy)| {
        (key.clone(), Supposed { policy: Some(Arc::clone(policy)), variables: None })
    });
    let changes = exchanges(state, &supposed.collect());
    usage.exchange(&changes).map_err(|excesses| {
        state.policies = former;
        DocumentError::OverCap(excesses)
    })
}

/// Puts the new policies in force.
fn apply(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    fields: Vec<Revised>,
    by: &str,
    now: DateTime,
) {
    changes.effects.events.push(ConnectorEvent::Policies);
    for (key, policy) in fields {
        let Some(field) = state.fields.get(&key) else { continue };
        let (id, writer) = (field.id(), field.writer());
        if !policy.allows_all_of(field.gate().policy()) {
            changes.purge_replaced(writer);
        }
        through_gate(state, id, now, |gate| gate.change_policy(policy, now));
        if let Some(mut field) = state.fields.get_mut(&key) {
            field.change_decision(|decision| {
                decision.decided_by = Some(by.to_owned());
                decision.follow(now);
            });
        }
        dependencies::update(state, &key, now);
        consents::record(state, changes, &key, now);
        changes.to_refresh.insert(writer, now);
    }
}
