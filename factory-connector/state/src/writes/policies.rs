//! Rows about policies, standing rules, alliances and caps.

use asi_model::{DateTime, FieldKey, OrganisationId};
use disclosure::{DocumentVersion, RuleAction};
use serde::Serialize;

use crate::recipient_policy::RecipientPolicy;

/// Rows about policies, standing rules, alliances and caps.
#[derive(Debug, Default, PartialEq)]
pub struct PolicyWrites {
    /// New versions of named policies.
    pub named: Vec<DocumentRow>,
    /// New versions of standing rules.
    pub rules: Vec<DocumentRow>,
    /// Policies that were set for recipients.
    pub recipients: Vec<RecipientPolicyRow>,
    /// Decisions of standing rules.
    pub rule_decisions: Vec<RuleDecisionRow>,
    /// Decisions of standing rules that were undone: number, user and time.
    pub undone_rule_decisions: Vec<(i64, String, DateTime)>,
    /// New versions of alliances.
    pub alliances: Vec<DocumentRow>,
    /// New versions of caps.
    pub caps: Vec<DocumentRow>,
}

impl PolicyWrites {
    pub(super) fn merge(&mut self, later: Self) {
        let Self {
            named,
            rules,
            recipients,
            rule_decisions,
            undone_rule_decisions,
            alliances,
            caps,
        } = later;
        self.named.extend(named);
        self.rules.extend(rules);
        self.recipients.extend(recipients);
        self.rule_decisions.extend(rule_decisions);
        self.undone_rule_decisions.extend(undone_rule_decisions);
        self.alliances.extend(alliances);
        self.caps.extend(caps);
    }
}

/// A version of a named policy, standing rule, alliance or cap.
#[derive(Debug, Clone, PartialEq)]
pub struct DocumentRow {
    pub key: DocumentVersion,
    /// The document as JSON.
    pub document: String,
    pub changed_by: String,
    pub changed_at: DateTime,
}

impl DocumentRow {
    pub(crate) fn new(
        key: &DocumentVersion,
        document: &impl Serialize,
        by: &str,
        now: DateTime,
    ) -> Self {
        let document =
            serde_json::to_string(document).expect("documents have text keys and finite numbers");
        Self { key: key.clone(), document, changed_by: by.to_owned(), changed_at: now }
    }
}

/// A policy that was set for everything one recipient gets.
#[derive(Debug, Clone, PartialEq)]
pub struct RecipientPolicyRow {
    pub recipient: OrganisationId,
    pub set: RecipientPolicy,
}

/// A decision of standing rules about a field.
#[derive(Debug, Clone, PartialEq)]
pub struct RuleDecisionRow {
    /// Number of the decision.
    pub id: i64,
    pub field: FieldKey,
    pub action: RuleAction,
    /// The rules that decided, in their versions.
    pub rules: Vec<DocumentVersion>,
    /// Number of the consent that the decision made.
    pub consent_version: u32,
    pub decided_at: DateTime,
}
