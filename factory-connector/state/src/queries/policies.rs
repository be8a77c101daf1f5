//! Policies in force: the strictest of the policy consented to, the named policy of the decision,
//! and the policies set for any of the recipients.

use std::sync::Arc;

use asi_model::{FieldKey, OrganisationId};
use disclosure::{DisclosurePolicy, DocumentId, DocumentVersion};

use crate::{ConnectorState, Field, policies::fitted};

/// A field, its policy in force, the policy that would be in force, and the field's unit.
pub type PolicyChange = (FieldKey, Arc<DisclosurePolicy>, Arc<DisclosurePolicy>, Option<String>);

/// Returns the policy that is in force for a field under a decision with this policy and named
/// policy, and the versions of the named policies in it.
#[must_use]
pub fn effective_policy(
    state: &ConnectorState,
    field: &Field,
    policy: &DisclosurePolicy,
    policy_id: Option<&DocumentId>,
) -> (Arc<DisclosurePolicy>, Vec<DocumentVersion>) {
    let recipients = state.networks.recipients(&field.key().request);
    let ids = state.policies.ids_for(policy_id, recipients);
    let (effective, versions) = state.policies.strictest(field, policy.clone(), ids);
    (Arc::new(effective), versions)
}

/// Returns the mapped fields whose policy in force a draft of a named policy would change, sorted.
#[must_use]
pub fn policy_changes(
    state: &ConnectorState,
    id: &DocumentId,
    draft: &DisclosurePolicy,
) -> Vec<PolicyChange> {
    let change = |field: &Field| {
        let decision = field.decision();
        let recipients = state.networks.recipients(&field.key().request);
        let mut ids = state.policies.ids_for(decision.basis.policy_id.as_ref(), recipients);
        if !ids.remove(id) {
            return None;
        }
        let with_draft = decision.policy.strictest(&fitted(draft, field));
        let (then, _) = state.policies.strictest(field, with_draft, ids);
        let now = Arc::clone(field.gate().policy());
        (then != *now)
            .then(|| (field.key().clone(), now, Arc::new(then), field.definition().unit.clone()))
    };
    let mut changes: Vec<PolicyChange> =
        fields_under_policy(state, id).filter_map(change).collect();
    changes.sort_by(|left, right| left.0.cmp(&right.0));
    changes.dedup_by(|left, right| left.0 == right.0);
    changes
}

/// Returns the mapped fields to which a named policy applies: those whose decisions name it, and
/// those of recipients for whom it is set. In no order, some perhaps more than once.
pub(crate) fn fields_under_policy<'s>(
    state: &'s ConnectorState,
    id: &'s DocumentId,
) -> impl Iterator<Item = &'s Field> {
    let set =
        state.policies.recipients().filter(move |(_, set)| set.policy_id.as_ref() == Some(id));
    let of_recipients = set.flat_map(move |(recipient, _)| fields_for_recipient(state, recipient));
    state.fields.under_policy(id).chain(of_recipients)
}

/// Returns the mapped fields whose reports an organisation may read, in the order of the requests.
pub(crate) fn fields_for_recipient<'s>(
    state: &'s ConnectorState,
    recipient: &'s OrganisationId,
) -> impl Iterator<Item = &'s Field> {
    let requests = state.networks.requests_for(recipient);
    let fields = requests.flat_map(move |request| state.fields_of(request).map(|(_, field)| field));
    fields.filter(|field| field.decision().is_mapped())
}
