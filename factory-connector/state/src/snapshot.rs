//! Stored state, as the store reads it back at a start and after a failed transaction.

use std::collections::{BTreeMap, HashMap};

use asi_model::{
    DateTime, OperationNetworkId, OrganisationId, RequestKey, messages::OperationNetworkMessage,
};
use disclosure::{Alliance, Cap, NamedPolicy, Rule, Versioned};
use ledger::{Heads, Logs, SequenceRange};

use crate::{
    operator::OperatorEntry,
    recipient_policy::RecipientPolicy,
    writes::{FieldRow, FieldValueRow, FormerDisclosureRow, ShadowRow, WriterRow},
};

/// Newest revision of a network, as read at the start.
#[derive(Debug, Clone)]
pub struct StoredNetwork {
    pub operation_network_id: OperationNetworkId,
    /// Revision of the network, or of its withdrawal.
    pub revision: u64,
    /// The message as received; `None` once withdrawn.
    pub message: Option<OperationNetworkMessage>,
    pub received_at: DateTime,
}

/// Stored versions of mappings, by field number.
#[derive(Debug, Default)]
pub struct StoredMappings {
    /// Number of the newest version, with its mapping as JSON; without JSON where it equals the
    /// mapping of the field's decision.
    pub newest_versions: HashMap<i64, (u32, Option<String>)>,
    pub shadows: HashMap<i64, ShadowRow>,
}

/// Named policies, recipients' policies and standing rules, as read at the start.
#[derive(Debug, Default)]
pub struct StoredPolicies {
    /// Named policies in their newest version.
    pub named: Vec<Versioned<NamedPolicy>>,
    /// Standing rules in their newest version.
    pub rules: Vec<Versioned<Rule>>,
    /// Policies that are set for recipients.
    pub recipients: Vec<(OrganisationId, RecipientPolicy)>,
    /// The greatest number ever given to a decision of rules.
    pub last_rule_decision: i64,
}

/// Stored alliances and caps, each in its newest version.
#[derive(Debug, Default)]
pub struct StoredBudgets {
    pub alliances: Vec<Versioned<Alliance>>,
    pub caps: Vec<Versioned<Cap>>,
}

/// Retention of a former version, as found at the first start of one that states it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FormerRetention {
    /// Reports without values, with the organisations whose chains have an entry about them.
    pub emptied: Vec<(SequenceRange, Vec<OrganisationId>)>,
    /// Number of the last entry that an anchor stands for, by chain.
    pub removed: BTreeMap<OrganisationId, u64>,
}

/// Stored ledger, as far as it is needed to go on, with decisions about the past.
#[derive(Debug, Default)]
pub struct StoredLedger {
    /// Heads of the chains.
    pub heads: Heads,
    /// Logs of the chains, up to these heads.
    pub logs: Logs,
    /// Number and time of the last checkpoint.
    pub last_checkpoint: Option<(u64, DateTime)>,
    /// Retention of former versions, unless the chains state it already.
    pub former_retention: Option<FormerRetention>,
    /// Requests and recipients with the number of the newest report that was decided about.
    pub past_decisions: Vec<(RequestKey, OrganisationId, i64)>,
}

/// Everything that [`ConnectorState`](crate::ConnectorState) is loaded from.
#[derive(Debug, Default)]
pub struct Snapshot {
    /// All networks, withdrawn ones included.
    pub networks: Vec<StoredNetwork>,
    /// All fields, each with the state of its gate and transform.
    pub fields: Vec<(FieldRow, Option<FieldValueRow>)>,
    /// All data set writers, by DataSetWriterId.
    pub writers: Vec<(u16, WriterRow)>,
    pub ledger: StoredLedger,
    /// The greatest number ever given in the spool.
    pub last_row: i64,
    /// The greatest number that is known to have been given to a field; 0 without knowledge.
    pub last_field: i64,
    pub operator_entries: Vec<OperatorEntry>,
    pub mappings: StoredMappings,
    pub policies: StoredPolicies,
    pub budgets: StoredBudgets,
    /// Disclosures whose consents ended a short while ago.
    pub former_disclosures: Vec<FormerDisclosureRow>,
}
