//! Policies as documents of their own, and the precision that holds for a field: the strictest of
//! what was consented to, of the named policy it takes, and of the policies set for any of its
//! recipients.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use asi_model::{DateTime, FieldKey, OrganisationId};
use serde::Serialize;

use super::{Books, ConnectorEvent, Field};
use crate::store::{DocumentRow, RecipientPolicyRow};
use disclosure::{
    DOCUMENTS_MAX, DisclosurePolicy, DocumentId, DocumentVersion, NAME_CHARS_MAX, NamedPolicy,
    Rule, RuleFault, Versioned,
};

/// The policy that is set for everything one recipient gets.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RecipientPolicy {
    /// From 1, one more with every change.
    pub version: u32,
    /// The named policy; none after it was taken away.
    pub policy_id: Option<DocumentId>,
    /// Who set it.
    pub changed_by: String,
    /// When.
    pub changed_at: DateTime,
}

/// A field, the precision that holds, the one that would, and the field's unit.
pub type PolicyChange = (FieldKey, Arc<DisclosurePolicy>, Arc<DisclosurePolicy>, Option<String>);

/// Why a document is not kept.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DocumentError {
    /// There is none with this id.
    #[error("there is no document {0}")]
    Unknown(DocumentId),
    /// Somebody else changed it meanwhile.
    #[error("somebody else has changed it meanwhile; read version {0} and decide again")]
    Changed(u32),
    /// There are too many.
    #[error("there are {DOCUMENTS_MAX} documents already; retire some")]
    TooMany,
    /// The document is wrong.
    #[error("the document is wrong")]
    Faults(Vec<RuleFault>),
}

impl Books {
    /// The named policies.
    #[must_use]
    pub fn policies(&self) -> Vec<Versioned<NamedPolicy>> {
        self.policies.values().cloned().collect()
    }

    /// The standing rules.
    #[must_use]
    pub fn rules(&self) -> Vec<Versioned<Rule>> {
        self.rules.values().cloned().collect()
    }

    /// A named policy that may be applied.
    #[must_use]
    pub fn named_policy(&self, id: &DocumentId) -> Option<&Versioned<NamedPolicy>> {
        self.policies.get(id).filter(|policy| !policy.document.is_retired)
    }

    /// The policies set for recipients.
    #[must_use]
    pub fn recipient_policies(&self) -> Vec<(OrganisationId, RecipientPolicy)> {
        self.recipient_policies
            .iter()
            .map(|(recipient, set)| (recipient.clone(), set.clone()))
            .collect()
    }

    /// Keeps a new version of a named policy. The precision of the fields that take it, and of
    /// those whose recipients it is set for, changes at once; their partners are told.
    ///
    /// # Errors
    /// [`DocumentError`]; then nothing is changed.
    pub fn put_policy(
        &mut self,
        id: &DocumentId,
        policy: NamedPolicy,
        expected: Option<u32>,
        by: &str,
        now: DateTime,
    ) -> Result<DocumentVersion, DocumentError> {
        let mut faults: Vec<RuleFault> =
            policy.disclosure.own_faults().into_iter().map(RuleFault::from).collect();
        if policy.name.trim().is_empty() || policy.name.chars().count() > NAME_CHARS_MAX {
            let message = "A name has 1 to 120 characters.".to_owned();
            faults.insert(0, RuleFault { pointer: "/name".to_owned(), message });
        }
        if !faults.is_empty() {
            return Err(DocumentError::Faults(faults));
        }
        let key =
            keep(&mut self.policies, &mut self.changes.policies, id, policy, expected, (by, now))?;
        self.aftermath.events.push(ConnectorEvent::Policies);
        self.apply_policies(by, now);
        Ok(key)
    }

    /// Sets a named policy for everything that a recipient gets, or takes it away.
    ///
    /// # Errors
    /// [`DocumentError`]; then nothing is changed.
    pub fn set_recipient_policy(
        &mut self,
        recipient: &OrganisationId,
        policy_id: Option<DocumentId>,
        expected: Option<u32>,
        by: &str,
        now: DateTime,
    ) -> Result<u32, DocumentError> {
        if let Some(id) = policy_id.as_ref().filter(|id| self.named_policy(id).is_none()) {
            return Err(DocumentError::Unknown(id.clone()));
        }
        let known = self.recipient_policies.get(recipient).map(|set| set.version);
        let version = next_version(known, expected, self.recipient_policies.len())?;
        let set =
            RecipientPolicy { version, policy_id, changed_by: by.to_owned(), changed_at: now };
        self.changes
            .recipient_policies
            .push(RecipientPolicyRow { recipient: recipient.clone(), set: set.clone() });
        self.recipient_policies.insert(recipient.clone(), set);
        self.aftermath.events.push(ConnectorEvent::Policies);
        self.apply_policies(by, now);
        Ok(version)
    }

    /// The precision that holds for a field, and the named policies that shaped it.
    #[must_use]
    pub fn effective_policy(
        &self,
        key: &FieldKey,
        field: &Field,
        policy: &DisclosurePolicy,
        policy_id: Option<&DocumentId>,
    ) -> (Arc<DisclosurePolicy>, Vec<DocumentVersion>) {
        let (mut effective, mut versions) = (policy.clone(), Vec::new());
        for policy in
            self.named_for(key, policy_id).into_iter().filter_map(|id| self.policies.get(id))
        {
            effective = effective.strictest(&fitted(&policy.document.disclosure, field));
            versions.push(policy.key.clone());
        }
        (Arc::new(effective), versions)
    }

    /// The mapped fields whose precision a draft of a named policy would change: with what holds,
    /// what would, and the field's unit.
    #[must_use]
    pub fn policy_changes(&self, id: &DocumentId, draft: &DisclosurePolicy) -> Vec<PolicyChange> {
        let mapped = self.fields.iter().filter(|field| field.decision.is_mapped());
        mapped
            .filter_map(|field| {
                let (key, decision, definition) = (&field.key, &field.decision, &field.definition);
                let with = |own: &DisclosurePolicy| {
                    let mut all = decision.policy.strictest(own);
                    for id in self
                        .named_for(key, decision.grounds.policy_id.as_ref())
                        .into_iter()
                        .filter(|n| *n != id)
                    {
                        if let Some(policy) = self.policies.get(id) {
                            all = all.strictest(&fitted(&policy.document.disclosure, field));
                        }
                    }
                    Arc::new(all)
                };
                let is_meant =
                    self.named_for(key, decision.grounds.policy_id.as_ref()).contains(id);
                let then = with(&fitted(draft, field));
                let now = Arc::clone(field.gate.policy());
                (is_meant && then != now).then(|| (key.clone(), now, then, definition.unit.clone()))
            })
            .collect()
    }

    /// The named policies that hold for a field: the one it takes and those of its recipients.
    fn named_for<'b>(
        &'b self,
        key: &FieldKey,
        policy_id: Option<&'b DocumentId>,
    ) -> BTreeSet<&'b DocumentId> {
        let mut named: BTreeSet<&DocumentId> = policy_id.into_iter().collect();
        if !self.recipient_policies.is_empty()
            && let Some((_, request)) = self.request(&key.request)
        {
            let set = request
                .recipient_list
                .iter()
                .filter_map(|recipient| self.recipient_policies.get(recipient));
            named.extend(set.filter_map(|set| set.policy_id.as_ref()));
        }
        named
    }

    /// A policy changed: brings every mapped field to the precision that now holds, each a consent
    /// of its own.
    fn apply_policies(&mut self, by: &str, now: DateTime) {
        let changed: Vec<(FieldKey, Arc<DisclosurePolicy>)> = self
            .fields
            .iter()
            .filter(|field| field.decision.is_mapped())
            .filter_map(|field| {
                let (key, decision) = (&field.key, &field.decision);
                let (effective, _) = self.effective_policy(
                    key,
                    field,
                    &decision.policy,
                    decision.grounds.policy_id.as_ref(),
                );
                (effective != *field.gate.policy()).then(|| (key.clone(), effective))
            })
            .collect();
        let mut writers = BTreeSet::new();
        for (key, effective) in changed {
            let Some(field) = self.fields.get_mut(&key) else { continue };
            field.gate.change_policy(effective, now);
            field.decision.decided_by = Some(by.to_owned());
            field.decision.decided_at = Some(now);
            field.decision.version += 1;
            writers.insert(field.writer);
            self.watch(&key, now);
            self.told_and_kept(&key, now);
            self.after_gate(&key, now);
        }
        for writer in writers {
            self.refresh_writer(writer, now);
        }
    }
}

fn fitted(policy: &DisclosurePolicy, field: &Field) -> DisclosurePolicy {
    policy.fitted_to(field.definition.field_type.0, field.definition.value_rank >= 0)
}

/// Keeps the next version of a document, and the row to be stored of it.
pub(super) fn keep<T: Serialize>(
    documents: &mut BTreeMap<DocumentId, Versioned<T>>,
    rows: &mut Vec<DocumentRow>,
    id: &DocumentId,
    document: T,
    expected: Option<u32>,
    (by, now): (&str, DateTime),
) -> Result<DocumentVersion, DocumentError> {
    let version =
        next_version(documents.get(id).map(|known| known.key.version), expected, documents.len())?;
    let key = DocumentVersion { id: id.clone(), version };
    rows.push(DocumentRow::new(&key, &document, by, now));
    let kept = Versioned { key: key.clone(), document, changed_by: by.to_owned(), changed_at: now };
    documents.insert(id.clone(), kept);
    Ok(key)
}

/// The version that follows, where nobody else was faster and there are not too many.
fn next_version(
    known: Option<u32>,
    expected: Option<u32>,
    count: usize,
) -> Result<u32, DocumentError> {
    let version = known.unwrap_or(0);
    if expected.is_some_and(|expected| expected != version) {
        return Err(DocumentError::Changed(version));
    }
    if known.is_none() && count >= DOCUMENTS_MAX {
        return Err(DocumentError::TooMany);
    }
    Ok(version + 1)
}
