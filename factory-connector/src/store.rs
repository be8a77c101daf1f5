//! The connector's durable file: one SQLite database in full-sync mode with one writer.
//!
//! One module per noun, with its columns, its reading and its writing; each statement is in exactly
//! one place. Everything that belongs together is collected in [`Writes`] and committed in one
//! transaction ([`Store::commit`]): nothing leaves that is not logged, and nothing that is logged
//! is lost. Reading goes through repositories that borrow a [`StoreSession`], a connection of its
//! own, and never waits for a transaction.

mod announced_gaps;
mod carried_fields;
mod comments;
mod commit;
mod consents;
mod control_messages;
mod dead_letters;
mod enrolments;
mod error;
mod fields;
mod former_disclosures;
mod handle;
mod identity;
mod ledger;
mod load;
mod mapping_templates;
mod mapping_versions;
mod migrations;
mod names;
mod networks;
mod operator_entries;
mod passkeys;
mod past_decisions;
mod past_reports;
mod place;
mod policy_documents;
mod previews;
mod query;
mod received_messages;
mod recipient_policies;
mod reports;
mod revocations;
mod row;
mod rule_decisions;
mod second_factors;
mod secrets;
mod session;
mod shadow_mappings;
mod sources;
mod spool;
mod statement;
mod users;
mod write_connection;
mod writers;

pub use announced_gaps::AnnouncedGaps;
pub use comments::{Comments, StoredComment};
pub use connector_state::writes::SourceRow;
use connector_state::{
    Snapshot, StoredBudgets, StoredLedger, StoredMappings, StoredNetwork, StoredPolicies, Writes,
    writes::{
        AnchorRow, AnnouncedGapRow, CarriedFieldRow, CheckpointRow, CommentRow, ConsentRow,
        ControlRow, DeadLetterRow, DocumentRow, FieldRow, FieldValueRow, FormerDisclosureRow,
        GapWrites, NetworkRow, NewReport, PastDecisionRow, PolicyWrites, PreviewRow,
        RecipientPolicyRow, RemovedEntries, ReportMove, RevocationRow, RuleDecisionRow, ShadowRow,
        TemplateRow, VersionRow, WaitingRow, WriterRow,
    },
};
pub use control_messages::ControlMessage;
pub use dead_letters::{DeadLetter, DeadLetters};
pub use enrolments::{Enrolment, Enrolments};
pub use error::StoreError;
pub use fields::Fields;
pub use former_disclosures::FormerDisclosures;
pub use handle::Store;
pub use identity::StoreIdentity;
pub use ledger::{
    Checkpoints, Ledger, LedgerCursor, LedgerFilter, LedgerRow, LedgerSubject, LogCheckpoint,
    StoredCheckpoint, Trusted,
};
pub use mapping_templates::MappingTemplates;
pub use mapping_versions::{StoredMappingVersions, VERSIONS_MAX};
pub use networks::{Networks, Revisions};
pub use operator_entries::OperatorEntries;
pub use passkeys::Passkeys;
pub use past_decisions::{PastDecisions, StoredPastDecision};
pub use past_reports::{EpochRecipients, PastReports};
pub use policy_documents::{DocumentKind, PolicyDocuments};
pub use received_messages::ReceivedMessages;
pub use recipient_policies::RecipientPolicies;
pub use reports::{LastSequences, ReportMessage, Reports};
pub use revocations::{Revocations, StoredRevocation};
pub use rule_decisions::{RuleDecision, RuleDecisions};
pub use second_factors::SecondFactors;
pub use secrets::{SecretHolder, SecretRows};
pub use session::{ReaderUse, Readers, StoreSession};
pub use shadow_mappings::ShadowMappings;
pub use sources::Sources;
pub use spool::{Message, Spool, SpooledMessage};
pub use users::{Role, User, Users};
pub use writers::Writers;
