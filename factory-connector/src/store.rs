//! The connector's durable file: one SQLite database in full-sync mode with one writer.
//!
//! The desk collects everything that belongs together in [`Changes`] and commits it in one transaction: what cannot be
//! logged does not leave, what is logged is not lost. Reading goes through connections of its own and never waits.

mod accounts;
mod changes;
mod commit;
mod error;
mod ledger;
mod load;
mod lookups;
mod mappings;
mod open;
mod operator;
mod policies;
mod revisions;
mod rows;
mod spool;

pub use accounts::{Role, User, count_users, put_user, remove_user, user, users};
pub use changes::{
    Changes, CheckpointRow, CommentRow, ConsentRow, ControlRow, DeadLetterRow, FieldRow, FieldValueRow, NetworkRow,
    NewReport, ReportMove, SourceRow, WriterRow,
};
pub use error::StoreError;
pub use ledger::{LedgerPage, LedgerRow, ledger_page, verify_ledger};
pub use load::Snapshot;
pub use lookups::{DeadLetter, Enrolment, StoredComment, comments, dead_letters, enrolment, put_enrolment, sources};
pub use mappings::{
    MappingChanges, MappingShelf, ShadowRow, TemplateRow, VERSIONS_MAX, VersionRow, templates, versions,
};
pub use open::{Identity, Store};
pub use policies::{
    DocumentRow, DocumentVersions, RecipientPolicyRow, RuleDecision, RuleDecisionRow, document_versions, rule_decision,
    rule_decisions,
};
pub use revisions::{Revisions, revisions};
pub use spool::{Message, SpoolReader, WaitingRow};
