//! Rows as the state reads and writes them, without any SQL.

use std::collections::HashMap;

use asi_model::{
    DateTime, FieldKey, OperationNetworkId, OrganisationId, messages::OperationNetworkMessage,
};
use disclosure::{DocumentVersion, NamedPolicy, Rule, RuleAction, Versioned};
use ledger::Heads;
use messaging::spool::ReportRow;
use serde::Serialize;

use super::{FieldRow, FieldValueRow, SourceRow, WriterRow};
use crate::{books::RecipientPolicy, operator::OperatorEntry};

/// Everything that the connector keeps in memory, as read at a start.
#[derive(Debug, Default)]
pub struct Snapshot {
    /// All networks, withdrawn ones included.
    pub networks: Vec<StoredNetwork>,
    /// All fields, each with its values once it had any.
    pub fields: Vec<(FieldRow, Option<FieldValueRow>)>,
    /// All writers by their ids.
    pub writers: Vec<(u16, WriterRow)>,
    /// The ends of the ledger's chains.
    pub heads: Heads,
    /// Number and time of the last checkpoint.
    pub last_checkpoint: Option<(u64, DateTime)>,
    /// The greatest id that is stored in the spool; 0 for an empty one.
    pub last_row: i64,
    /// Entries of operators about active networks.
    pub operator_entries: Vec<OperatorEntry>,
    /// Sources of values.
    pub sources: Vec<SourceRow>,
    /// Versions and shadows of mappings.
    pub mappings: StoredMappings,
    /// Named policies in their newest version.
    pub policies: Vec<Versioned<NamedPolicy>>,
    /// Standing rules in their newest version.
    pub rules: Vec<Versioned<Rule>>,
    /// The newest policy of each recipient.
    pub recipient_policies: Vec<(OrganisationId, RecipientPolicy)>,
    /// The greatest id of a decision of rules; 0 before the first.
    pub last_rule_decision: i64,
}

/// A stored network.
#[derive(Debug, Clone)]
pub struct StoredNetwork {
    pub operation_network_id: OperationNetworkId,
    pub revision: u64,
    /// The message as received; `None` once withdrawn.
    pub message: Option<OperationNetworkMessage>,
    pub received_at: DateTime,
}

/// A report in the spool without its body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WaitingRow {
    /// Input for decisions about the spool.
    pub row: ReportRow,
    /// Organisations that may see it.
    pub recipients: Vec<OrganisationId>,
    /// The consent ended after it was sent.
    pub is_revoked: bool,
    /// Number of the message that it travels in.
    pub message: i64,
    /// It was taken back before it was known to have left.
    pub is_done: bool,
}

/// Changes of one transaction to mappings.
#[derive(Debug, Default)]
pub struct MappingChanges {
    /// New versions of fields' mappings.
    pub versions: Vec<VersionRow>,
    /// Shadows that start, by the id of the field; `None` where one ends.
    pub shadows: Vec<(i64, Option<ShadowRow>)>,
    /// Templates that are new or changed.
    pub templates: Vec<TemplateRow>,
    /// Ids of removed templates.
    pub removed_templates: Vec<String>,
}

impl MappingChanges {
    /// Returns true when there is nothing to write.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.versions.is_empty()
            && self.shadows.is_empty()
            && self.templates.is_empty()
            && self.removed_templates.is_empty()
    }
}

/// A published mapping.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VersionRow {
    pub field_id: i64,
    /// Counts from 1 within the field.
    pub version: u32,
    /// The mapping as JSON.
    pub mapping: String,
    /// The person who published it, if known.
    pub author: Option<String>,
    /// Origin other than the editor: a former version, a file, a shadow.
    pub note: Option<String>,
    pub published_at: DateTime,
}

/// A mapping that runs beside the published one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShadowRow {
    /// The mapping as JSON.
    pub mapping: String,
    /// The person who started it.
    pub author: String,
    pub started_at: DateTime,
}

/// A stored template.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TemplateRow {
    pub template_id: String,
    /// The template as JSON.
    pub template: String,
    /// The person who changed it last.
    pub author: String,
    pub changed_at: DateTime,
}

/// Versions and shadows of all fields' mappings, by the ids of the fields.
#[derive(Debug, Default)]
pub struct StoredMappings {
    /// The newest version of each field with its mapping as JSON; `None` for the mapping of the
    /// field's decision.
    pub versions: HashMap<i64, (u32, Option<String>)>,
    pub shadows: HashMap<i64, ShadowRow>,
}

/// A version of a named policy or standing rule.
#[derive(Debug, Clone)]
pub struct DocumentRow {
    pub key: DocumentVersion,
    /// The policy or rule as JSON.
    pub document: String,
    /// The person who wrote it.
    pub changed_by: String,
    pub changed_at: DateTime,
}

impl DocumentRow {
    /// Writes a policy or rule as JSON.
    pub fn new(key: &DocumentVersion, document: &impl Serialize, by: &str, now: DateTime) -> Self {
        let document = serde_json::to_string(document)
            .expect("policies and rules have text keys and finite numbers");
        Self { key: key.clone(), document, changed_by: by.to_owned(), changed_at: now }
    }
}

/// A policy set for a recipient.
#[derive(Debug, Clone)]
pub struct RecipientPolicyRow {
    pub recipient: OrganisationId,
    pub set: RecipientPolicy,
}

/// A decision of standing rules about a field.
#[derive(Debug, Clone)]
pub struct RuleDecisionRow {
    pub id: i64,
    pub field: FieldKey,
    pub action: RuleAction,
    /// The rules, in the versions that decided.
    pub rules: Vec<DocumentVersion>,
    /// Number of the consent that the decision made.
    pub consent_version: u32,
    pub decided_at: DateTime,
}
