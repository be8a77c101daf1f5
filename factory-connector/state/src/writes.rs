//! Write set: everything that one transaction stores.

mod fields;
mod gaps;
mod ledger;
mod mappings;
mod merge;
mod messages;
mod past;
mod policies;
mod reports;
mod sources;

pub use fields::{
    ConsentRow, FieldRow, FieldValueRow, FieldWrites, FormerDisclosureRow, PreviewRow,
};
pub use gaps::{AnnouncedGapRow, GapWrites};
pub use ledger::{AnchorRow, CheckpointRow, LedgerWrites, RemovedEntries, RevocationRow};
pub use mappings::{MappingWrites, ShadowRow, TemplateRow, VersionRow};
pub use messages::{CommentRow, DeadLetterRow, MessageWrites, NetworkRow};
pub use past::PastDecisionRow;
pub use policies::{DocumentRow, PolicyWrites, RecipientPolicyRow, RuleDecisionRow};
pub use reports::{
    CarriedFieldRow, ControlRow, ControlWrites, NewReport, ReportMove, ReportWrites, WaitingRow,
    WriterRow, WriterWrites,
};
pub use sources::{SourceRow, SourceWrites};

use asi_model::OperationNetworkId;

use crate::operator::OperatorEntry;

/// Rows of one transaction, by noun. Of two rows about the same thing the later one holds.
#[derive(Debug, Default, PartialEq)]
pub struct Writes {
    /// Networks that are new, revised or withdrawn.
    pub networks: Vec<NetworkRow>,
    /// Fields with their consents and the states of their gates.
    pub fields: FieldWrites,
    pub writers: WriterWrites,
    /// Reports: queued ones, and changes of their delivery state.
    pub reports: ReportWrites,
    /// Control messages: queued ones, and changes of their delivery state.
    pub controls: ControlWrites,
    /// Entries of the ledger, signed heads, receipts and checkpoints.
    pub ledger: LedgerWrites,
    /// Messages that were received, and what people wrote.
    pub messages: MessageWrites,
    pub operator_entries: Vec<OperatorEntry>,
    /// Policies, standing rules and their decisions, alliances and caps.
    pub policies: PolicyWrites,
    pub sources: SourceWrites,
    /// Versions of mappings, shadow mappings and templates.
    pub mappings: MappingWrites,
    /// The lease of the factory was granted (true) or refused (false) to this connector.
    pub is_lease_held: Option<bool>,
}

impl Writes {
    /// Returns true where nothing is to be written.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Adds the rows of a later change.
    pub(crate) fn merge(&mut self, later: Self) {
        // Every member is named, so that a new one cannot be forgotten.
        let Self {
            networks,
            fields,
            writers,
            reports,
            controls,
            ledger,
            messages,
            operator_entries,
            policies,
            sources,
            mappings,
            is_lease_held,
        } = later;
        for id in &fields.removed {
            self.mappings.forget_field(*id);
        }
        // A withdrawal removes the entries that were made before it.
        let withdrawn = |id: &OperationNetworkId| {
            let mut rows = networks.iter().filter(|row| row.operation_network_id == *id);
            rows.any(|row| row.message.is_none())
        };
        self.operator_entries.retain(|entry| !withdrawn(&entry.operation.operation_network_id));
        self.networks.extend(networks);
        self.fields.merge(fields);
        self.writers.merge(writers);
        self.reports.merge(reports);
        self.controls.merge(controls);
        self.ledger.merge(ledger);
        self.messages.merge(messages);
        self.operator_entries.extend(operator_entries);
        self.policies.merge(policies);
        self.sources.merge(sources);
        self.mappings.merge(mappings);
        self.is_lease_held = is_lease_held.or(self.is_lease_held);
    }

    /// Removes a field, and drops what was to be written about it before.
    pub(crate) fn remove_field(&mut self, id: i64) {
        self.fields.remove(id);
        self.mappings.forget_field(id);
    }
}
