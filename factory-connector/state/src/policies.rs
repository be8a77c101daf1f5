//! Named policies, the policies set for recipients, and standing rules, each in its newest version.

use std::{
    collections::{BTreeMap, BTreeSet},
    time::Duration,
};

use asi_model::{DateTime, OrganisationId};
use disclosure::{DisclosurePolicy, DocumentId, DocumentVersion, NamedPolicy, Rule, Versioned};

use crate::{
    DocumentError, Field,
    documents::{by_id, next_version, put},
    recipient_policy::RecipientPolicy,
    snapshot::StoredPolicies,
    writes::DocumentRow,
};

/// Owner of policies and standing rules.
#[derive(Debug, Clone, Default)]
pub struct PolicyRegistry {
    named: BTreeMap<DocumentId, Versioned<NamedPolicy>>,
    rules: BTreeMap<DocumentId, Versioned<Rule>>,
    recipients: BTreeMap<OrganisationId, RecipientPolicy>,
    last_rule_decision: i64,
}

impl From<StoredPolicies> for PolicyRegistry {
    fn from(stored: StoredPolicies) -> Self {
        Self {
            named: by_id(stored.named),
            rules: by_id(stored.rules),
            recipients: stored.recipients.into_iter().collect(),
            last_rule_decision: stored.last_rule_decision,
        }
    }
}

impl PolicyRegistry {
    /// Returns the named policies, retired ones included.
    pub fn named(&self) -> impl Iterator<Item = &Versioned<NamedPolicy>> {
        self.named.values()
    }

    /// Returns a named policy that is not retired.
    #[must_use]
    pub fn applicable(&self, id: &DocumentId) -> Option<&Versioned<NamedPolicy>> {
        self.named.get(id).filter(|policy| !policy.document.is_retired)
    }

    /// Returns the standing rules.
    pub fn rules(&self) -> impl Iterator<Item = &Versioned<Rule>> {
        self.rules.values()
    }

    /// Returns the standing rules that are enabled.
    pub fn enabled_rules(&self) -> impl Iterator<Item = &Versioned<Rule>> {
        self.rules.values().filter(|rule| rule.document.is_enabled)
    }

    /// Returns the longest period of all rules and named policies, also of those that do not apply
    /// at present.
    #[must_use]
    pub fn longest_period(&self) -> Duration {
        let named = self.named.values().map(|policy| &policy.document.disclosure);
        let ruled = self.rules.values().filter_map(|rule| rule.document.disclosure.as_ref());
        named.chain(ruled).map(DisclosurePolicy::longest_period).max().unwrap_or_default()
    }

    /// Returns the policies that are set for recipients.
    pub fn recipients(&self) -> impl Iterator<Item = (&OrganisationId, &RecipientPolicy)> {
        self.recipients.iter()
    }

    /// Returns the ids of the named policies that apply to a field: the one that its decision names
    /// and those of its recipients.
    #[must_use]
    pub fn ids_for<'p>(
        &'p self,
        named: Option<&'p DocumentId>,
        recipients: &[OrganisationId],
    ) -> BTreeSet<&'p DocumentId> {
        let mut ids: BTreeSet<&DocumentId> = named.into_iter().collect();
        if !self.recipients.is_empty() {
            let set = recipients.iter().filter_map(|recipient| self.recipients.get(recipient));
            ids.extend(set.filter_map(|set| set.policy_id.as_ref()));
        }
        ids
    }

    /// Returns the strictest of a precision and of named policies, as a field's type allows, and
    /// the versions of the policies.
    #[must_use]
    pub fn strictest<'p>(
        &self,
        field: &Field,
        policy: DisclosurePolicy,
        ids: impl IntoIterator<Item = &'p DocumentId>,
    ) -> (DisclosurePolicy, Vec<DocumentVersion>) {
        let (mut strictest, mut versions) = (policy, Vec::new());
        for named in ids.into_iter().filter_map(|id| self.named.get(id)) {
            strictest = strictest.strictest(&fitted(&named.document.disclosure, field));
            versions.push(named.key.clone());
        }
        (strictest, versions)
    }

    /// Stores the next version of a named policy, and returns its row.
    pub(crate) fn put_named(
        &mut self,
        id: &DocumentId,
        policy: NamedPolicy,
        expected: Option<u32>,
        author: (&str, DateTime),
    ) -> Result<DocumentRow, DocumentError> {
        put(&mut self.named, id, policy, expected, author)
    }

    /// Stores the next version of a standing rule, and returns its row.
    pub(crate) fn put_rule(
        &mut self,
        id: &DocumentId,
        rule: Rule,
        expected: Option<u32>,
        author: (&str, DateTime),
    ) -> Result<DocumentRow, DocumentError> {
        put(&mut self.rules, id, rule, expected, author)
    }

    /// Sets or takes away the policy for a recipient.
    pub(crate) fn set_recipient(
        &mut self,
        recipient: &OrganisationId,
        policy_id: Option<DocumentId>,
        expected: Option<u32>,
        (by, now): (&str, DateTime),
    ) -> Result<RecipientPolicy, DocumentError> {
        if let Some(id) = policy_id.as_ref().filter(|id| self.applicable(id).is_none()) {
            return Err(DocumentError::Unknown(id.clone()));
        }
        let known = self.recipients.get(recipient).map(|set| set.version);
        let version = next_version(known, expected, self.recipients.len())?;
        let set =
            RecipientPolicy { version, policy_id, changed_by: by.to_owned(), changed_at: now };
        self.recipients.insert(recipient.clone(), set.clone());
        Ok(set)
    }

    /// Returns the number for a new decision of rules.
    pub(crate) const fn next_rule_decision(&mut self) -> i64 {
        self.last_rule_decision += 1;
        self.last_rule_decision
    }
}

/// Returns a policy as far as it makes sense for a field's type.
pub(crate) fn fitted(policy: &DisclosurePolicy, field: &Field) -> DisclosurePolicy {
    policy.fitted_to(field.definition().field_type.0, field.is_array())
}
