//! The connector's durable file: one SQLite database in full-sync mode with one writer.
//!
//! The desk collects everything that belongs together in [`Changes`] and commits it in one
//! transaction: what cannot be logged does not leave, what is logged is not lost. Reading goes
//! through connections of its own and never waits.

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
mod place;
mod policies;
mod retention;
mod revisions;
mod revocation;
mod spool;
mod spooled;
mod verify;
mod writer;

pub use accounts::{Role, User, count_users, everybody, put_user, remove_user, user, users};
pub use changes::{
    CarriedFieldRow, Changes, CheckpointRow, CommentRow, ConsentRow, ControlRow, DeadLetterRow,
    FieldRow, FieldValueRow, NetworkRow, NewReport, ReportMove, RevocationRow, SourceRow,
    WriterRow,
};
pub use error::StoreError;
pub use ledger::{
    LedgerFilter, LedgerReader, LedgerRow, LedgerSubject, StoredCheckpoint, ledger_checkpoints,
    ledger_fields, ledger_recipients,
};
pub use load::Snapshot;
pub use lookups::{
    DeadLetter, Enrolment, StoredComment, comments, dead_letters, enrolment, put_enrolment, sources,
};
pub use mappings::{
    MappingChanges, MappingShelf, ShadowRow, TemplateRow, VERSIONS_MAX, VersionRow, templates,
    versions,
};
pub use open::{Identity, Store};
pub use policies::{
    DocumentRow, DocumentVersions, RecipientPolicyRow, RuleDecision, RuleDecisionRow,
    document_versions, rule_decision, rule_decisions,
};
pub use revisions::{Revisions, revisions};
pub use revocation::{StoredRevocation, revocation_by_id, revocations};
pub use spool::{Message, SpoolReader, WaitingRow};
pub use spooled::{SpooledMessage, spooled};
pub use verify::verify_ledger;
