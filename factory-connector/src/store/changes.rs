//! What one transaction writes.

use std::collections::BTreeMap;

use asi_model::{
    DateTime, FieldKey, FieldName, MessageId, OperationNetworkId, OrganisationId, RequestKey,
    messages::{Comment, MappingState, ValueSource},
};

use super::{DocumentRow, MappingChanges, RecipientPolicyRow, RuleDecisionRow};
use crate::operator::OperatorEntry;
use ledger::{LinkedEntry, SALT_BYTES, SignedHead};

/// Everything of one transaction. Later entries about the same thing win.
#[derive(Debug, Default)]
pub struct Changes {
    /// Networks that came, changed or were withdrawn.
    pub networks: Vec<NetworkRow>,
    /// Fields that are new or decided anew.
    pub fields: BTreeMap<i64, FieldRow>,
    /// Fields that are gone.
    pub removed_fields: Vec<i64>,
    /// Fields whose values, waiting values or transform state changed.
    pub field_values: BTreeMap<i64, FieldValueRow>,
    /// Consents given.
    pub consents: Vec<ConsentRow>,
    /// Writers that are new, retired or moved on.
    pub writers: BTreeMap<u16, WriterRow>,
    /// Fields that a writer carries for the first time in its epoch.
    pub carried_fields: Vec<CarriedFieldRow>,
    /// New reports.
    pub reports: Vec<NewReport>,
    /// Reports whose state changed.
    pub report_moves: Vec<ReportMove>,
    /// New control messages.
    pub controls: Vec<ControlRow>,
    /// Control messages that are done with.
    pub controls_done: Vec<i64>,
    /// Control messages to set aside.
    pub controls_parked: Vec<i64>,
    /// Control messages with one failed attempt more.
    pub controls_attempted: Vec<i64>,
    /// Ledger entries with the report they are about.
    pub ledger: Vec<(LinkedEntry, Option<i64>)>,
    /// The signed ends of the chains that grew.
    pub heads: Vec<SignedHead>,
    /// Receipts of consents that ended.
    pub revocations: Vec<RevocationRow>,
    /// A signed checkpoint.
    pub checkpoint: Option<CheckpointRow>,
    /// Messages whose effect this is.
    pub seen: Vec<(MessageId, DateTime)>,
    /// Remarks, and whether they are our own.
    pub comments: Vec<CommentRow>,
    /// What was rejected.
    pub dead_letters: Vec<DeadLetterRow>,
    /// What people entered about operations.
    pub operator_entries: Vec<OperatorEntry>,
    /// New versions of named policies.
    pub policies: Vec<DocumentRow>,
    /// New versions of standing rules.
    pub rules: Vec<DocumentRow>,
    /// Policies set for recipients.
    pub recipient_policies: Vec<RecipientPolicyRow>,
    /// What rules have decided.
    pub rule_decisions: Vec<RuleDecisionRow>,
    /// What was undone of it, by whom and when.
    pub undone_rule_decisions: Vec<(i64, String, DateTime)>,
    /// Sources that are new or changed.
    pub sources: Vec<SourceRow>,
    /// Sources that are gone.
    pub removed_sources: Vec<String>,
    /// Versions, shadows and templates of mappings.
    pub mappings: MappingChanges,
    /// Every writer has begun a new epoch, as a restored, moved or copied store demands.
    pub are_epochs_begun: bool,
    /// This connector was granted its factory's lease, or refused it.
    pub is_lease_held: Option<bool>,
}

impl Changes {
    /// Nothing to write.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.networks.is_empty()
            && self.fields.is_empty()
            && self.removed_fields.is_empty()
            && self.field_values.is_empty()
            && self.consents.is_empty()
            && self.writers.is_empty()
            && self.carried_fields.is_empty()
            && self.reports.is_empty()
            && self.report_moves.is_empty()
            && self.controls.is_empty()
            && self.controls_done.is_empty()
            && self.controls_parked.is_empty()
            && self.controls_attempted.is_empty()
            && self.ledger.is_empty()
            && self.heads.is_empty()
            && self.revocations.is_empty()
            && self.checkpoint.is_none()
            && self.seen.is_empty()
            && self.comments.is_empty()
            && self.dead_letters.is_empty()
            && self.operator_entries.is_empty()
            && self.policies.is_empty()
            && self.rules.is_empty()
            && self.recipient_policies.is_empty()
            && self.rule_decisions.is_empty()
            && self.undone_rule_decisions.is_empty()
            && self.sources.is_empty()
            && self.removed_sources.is_empty()
            && self.mappings.is_empty()
            && !self.are_epochs_begun
            && self.is_lease_held.is_none()
    }
}

/// A signed statement of all chains' heads.
#[derive(Debug, Clone)]
pub struct CheckpointRow {
    /// Its number.
    pub number: u64,
    /// When it was made.
    pub recorded_at: DateTime,
    /// The signed text.
    pub content: String,
    /// The Ed25519 signature.
    pub signature: [u8; 64],
    /// The key it is verified with.
    pub public_key: [u8; 32],
}

/// A signed receipt of consents that ended.
#[derive(Debug, Clone)]
pub struct RevocationRow {
    /// Its id.
    pub revocation_id: String,
    /// When.
    pub revoked_at: DateTime,
    /// The signed text.
    pub content: String,
    /// The Ed25519 signature.
    pub signature: [u8; 64],
    /// The key it is verified with.
    pub public_key: [u8; 32],
}

/// A network as last received.
#[derive(Debug, Clone)]
pub struct NetworkRow {
    /// Its id.
    pub operation_network_id: OperationNetworkId,
    /// Its revision, or that of its withdrawal.
    pub revision: u64,
    /// The message as JSON; `None` once withdrawn.
    pub message: Option<String>,
    /// When it came.
    pub received_at: DateTime,
}

/// A field with its decision.
#[derive(Debug, Clone)]
pub struct FieldRow {
    /// Our number for it.
    pub id: i64,
    /// Its name.
    pub key: FieldKey,
    /// The decision.
    pub mapping_state: MappingState,
    /// Where values come from.
    pub value_source: Option<ValueSource>,
    /// Why it was decided so.
    pub reason: Option<String>,
    /// Who decided.
    pub decided_by: Option<String>,
    /// When.
    pub decided_at: Option<DateTime>,
    /// The mapping as JSON.
    pub mapping: Option<String>,
    /// The disclosure policy as JSON.
    pub policy: String,
    /// On what the decision rests, as JSON.
    pub grounds: Option<String>,
    /// Counts the consents.
    pub consent_version: u32,
}

/// Where a field's values stand.
#[derive(Debug, Clone)]
pub struct FieldValueRow {
    /// The gate's state as JSON.
    pub gate: String,
    /// The transform's state as JSON.
    pub transform: Option<String>,
}

/// A consent, kept for ever.
#[derive(Debug, Clone)]
pub struct ConsentRow {
    /// The field's key as text.
    pub field: String,
    /// Its number.
    pub version: u32,
    /// The decision.
    pub mapping_state: MappingState,
    /// Where values come from.
    pub value_source: Option<ValueSource>,
    /// The policy as JSON.
    pub policy: String,
    /// On what it rests, as JSON.
    pub grounds: Option<String>,
    /// Why.
    pub reason: Option<String>,
    /// Who.
    pub decided_by: Option<String>,
    /// When.
    pub decided_at: DateTime,
}

/// A DataSetWriter.
#[derive(Debug, Clone)]
pub struct WriterRow {
    /// The request it reports about.
    pub request: RequestKey,
    /// MajorVersion.
    pub epoch: u32,
    /// MinorVersion.
    pub minor_version: u32,
    /// The next report's number.
    pub next_sequence: u32,
    /// The fields that the metadata describes, in payload order.
    pub fields: Vec<FieldName>,
    /// When it was retired.
    pub retired_at: Option<DateTime>,
}

/// Since when a writer carries a field in its epoch.
#[derive(Debug, Clone)]
pub struct CarriedFieldRow {
    /// The field.
    pub field: FieldKey,
    /// The writer.
    pub data_set_writer_id: u16,
    /// Its epoch.
    pub epoch: u32,
    /// The first report with the field.
    pub first_sequence: u32,
}

/// A report on its way out.
#[derive(Debug, Clone)]
pub struct NewReport {
    /// Its number in the spool.
    pub id: i64,
    /// The number of the message it travels in.
    pub message: i64,
    /// The writer.
    pub data_set_writer_id: u16,
    /// Its epoch.
    pub epoch: u32,
    /// Its sequence number.
    pub sequence: u32,
    /// When it was made.
    pub created_at: DateTime,
    /// Who may see it.
    pub recipients: Vec<OrganisationId>,
    /// The DataSetMessage as JSON.
    pub body: String,
    /// The salt of its hashes.
    pub salt: [u8; SALT_BYTES],
    /// Taken back before it was ever committed.
    pub is_purged: bool,
}

/// A change of reports in the spool.
#[derive(Debug, Clone)]
pub enum ReportMove {
    /// The broker accepted these reports, in these messages.
    Sent {
        /// The reports' numbers, with the id of the message each left in.
        reports: Vec<(i64, Option<MessageId>)>,
        /// When.
        at: DateTime,
    },
    /// The platform holds these reports: the spool is done with them.
    Receipted {
        /// The reports' numbers.
        reports: Vec<i64>,
        /// When it was said.
        at: DateTime,
    },
    /// They are sent again.
    Waiting(Vec<i64>),
    /// The broker refused these messages once more.
    Attempted(Vec<i64>),
    /// The broker will never take these messages.
    Parked(Vec<i64>),
    /// The spool is done with these reports.
    Done(Vec<i64>),
    /// These are not sent again, whatever becomes of them.
    Revoked(Vec<i64>),
}

/// A control message.
#[derive(Debug, Clone)]
pub struct ControlRow {
    /// Its number in the spool.
    pub id: i64,
    /// Its id.
    pub message_id: MessageId,
    /// Its type.
    pub subject: String,
    /// What it answers.
    pub correlation_id: Option<MessageId>,
    /// The body.
    pub body: String,
    /// When it was made.
    pub created_at: DateTime,
    /// How long it is of use, in milliseconds.
    pub ttl_ms: Option<u64>,
}

/// A remark.
#[derive(Debug, Clone)]
pub struct CommentRow {
    /// The remark.
    pub comment: Comment,
    /// Said by this factory.
    pub is_own: bool,
    /// When.
    pub written_at: DateTime,
}

/// A message that was rejected.
#[derive(Debug, Clone)]
pub struct DeadLetterRow {
    /// Received here, or sent from here.
    pub is_received: bool,
    /// Its id, where it has one.
    pub message_id: Option<MessageId>,
    /// Its type, as far as it is known.
    pub subject: String,
    /// Why, as a code.
    pub code: String,
    /// Why, in words.
    pub reason: String,
    /// What it said.
    pub body: Vec<u8>,
    /// When.
    pub occurred_at: DateTime,
}

/// A source of values.
#[derive(Debug, Clone)]
pub struct SourceRow {
    /// Its name.
    pub source_id: String,
    /// Its configuration as JSON, without the password.
    pub config: String,
    /// The password.
    pub password: Option<String>,
}
