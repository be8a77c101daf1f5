//! The platform's database: one repository per noun, each statement in exactly one place.
//!
//! A unit of work is a transaction ([`Work`]) that is committed explicitly or not at all;
//! repositories borrow it. Lookups return `Option`: "not found" is a decision of the caller. Every
//! query on partners' data takes the viewer's [`Scope`], so that forgetting it is a compile error and
//! not a leak.
//!
//! # PostgreSQL
//! Statements use numbered parameters (`$1`), `ON CONFLICT`, `RETURNING` and nothing else of a
//! dialect, so that they run on PostgreSQL unchanged. SQLite's own part is in `connection` (opening,
//! one writer, pragmas) and in the folder `migrations/sqlite`; a second database is a second such
//! module behind the same [`Database`] alias.

mod access_storage;
mod accesses;
mod asked_requests;
mod audit;
mod collaborations;
mod comments;
mod connection;
mod credentials;
mod database;
mod dead_letters;
mod error;
mod factories;
mod fields;
mod holder;
mod inbox;
mod leases;
mod ledger_logs;
mod meta_data;
mod networks;
mod organisations;
mod outgoing;
mod ownership;
mod parts;
mod passkeys;
mod past_releases;
mod quotas;
mod recipient_sets;
mod recipients;
mod removals;
mod report_cursor;
mod report_history;
mod reports;
mod revocations;
mod revoked_access;
mod row;
mod scope;
mod second_factors;
mod signing_keys;
mod tools;
mod users;
mod visibility;
mod work;
mod writers;

pub use accesses::{AccessQuery, Accesses, AccessesKept, ListedAccess, StoredAccessLog};
pub use asked_requests::AskedRequests;
pub use audit::{
    AuditAgent, AuditAgentKind, AuditEntries, AuditEntry, AuditFact, AuditFactKind, AuditKept,
    AuditOutcome, AuditSubject, NewAuditEntry,
};
pub use collaborations::{Collaboration, Collaborations};
pub use comments::{CommentEntry, Comments, NewComment};
pub use connection::{Store, StoreReader};
pub use credentials::{BrokerCredential, Credentials};
pub use database::Database;
pub use dead_letters::{
    DEAD_LETTER_BYTES_PER_ADDRESS_MAX, DEAD_LETTERS_PER_ADDRESS_MAX, DeadLetterContent,
    DeadLetters, NewDeadLetter, StoredDeadLetter,
};
pub use error::StoreError;
pub use factories::{Factories, Factory, Heard};
pub use fields::{
    AskedField, CurrentValue, DecisionAudience, DecisionEffect, FieldRow, Fields, NewField,
    state_name,
};
pub use holder::Holder;
pub use inbox::{InboxMessages, NewInboxMessage};
pub use leases::Leases;
pub use ledger_logs::LedgerLogs;
pub use meta_data::MetaData;
pub use networks::{NetworkRow, NetworkSummary, Networks};
pub use organisations::{Organisation, Organisations};
pub use outgoing::{ANSWERS_WAITING_MAX, NewOutgoing, OutgoingMessages};
pub use ownership::Ownership;
pub use parts::{NetworkPart, PartState, Parts, SeenPart};
pub use passkeys::Passkeys;
pub use past_releases::{PastReleases, ReleasedRange};
pub use quotas::{Kept, Quotas};
pub use recipient_sets::{RecipientSetId, RecipientSets};
pub use recipients::{Recipient, Recipients};
pub use removals::{Leaver, RemainingRecords, RemovalEffects, Removals};
pub use report_cursor::ReportCursor;
pub use reports::{NewReport, Report, ReportQuery, Reports};
pub use revocations::{RevocationEntry, Revocations};
pub use revoked_access::RevokedAccess;
pub use scope::Scope;
pub use second_factors::SecondFactors;
pub use signing_keys::SigningKeys;
pub use tools::{Tool, Tools};
pub use users::{Role, User, Users};
pub use visibility::{NetworkOwners, Sight, Visibility, part_of, viewers};
pub use work::Work;
pub use writers::{
    GAPS_PER_WRITER_MAX, SeenWriter, StoredGap, WriterKey, WriterRow, Writers, WritersWanted,
};
