//! Records for the log: what a transaction did, written once it is committed.

use asi_model::{FieldKey, MessageId, OperationNetworkId, OrganisationId, RequestKey};
use disclosure::DocumentId;
use ledger::ConflictKind;

/// A record for the log (OpenTelemetry's LogRecord). It has no values of the plant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LogRecord {
    /// A network is in effect in a revision.
    NetworkReceived { network: OperationNetworkId, revision: u64 },
    /// A network was withdrawn by a revision.
    NetworkWithdrawn { network: OperationNetworkId, revision: u64 },
    /// A message of the platform was rejected and answered.
    MessageRejected { message_id: MessageId, fault_count: usize },
    /// Standing rules decided about fields of a network.
    RulesDecided { network: OperationNetworkId, field_count: usize },
    /// A standing rule could not be applied to a field, which waits for an engineer.
    RuleNotApplied { field: FieldKey, reason: String },
    /// Consents ended, since a cap holds their fields back.
    FieldsHeldBack { cap: DocumentId, field_count: usize },
    /// The validity of a field's request has ended.
    RequestEnded { field: FieldKey },
    /// A request has no data set writer: all DataSetWriterIds are taken.
    WriterMissing { request: RequestKey },
    /// Every data set writer began a new epoch: the store was restored, moved, copied or
    /// migrated.
    EpochsBegun,
    /// A recipient that was added later sees reports of the past.
    PastReleased { request: RequestKey, recipient: OrganisationId, report_count: u64 },
    /// Reports were dropped for newer ones: the spool is full.
    ReportsCoalesced { report_count: usize },
    /// The platform countersigned a checkpoint of a log.
    LogWitnessed { origin: String },
    /// The platform countersigns with another key than before.
    WitnessChanged { origin: String },
    /// The platform holds nothing any more of a log of which it had countersigned `former_size` leaves.
    WitnessForgot { origin: String, former_size: u64 },
    /// An answer of the platform to a checkpoint proves nothing.
    WitnessNotUnderstood { origin: String, reason: String },
    /// The platform holds another history of a log; nothing is disclosed any more.
    LedgerConflict { origin: String, kind: ConflictKind },
    /// An engineer replaced a log by this one.
    LogReplaced { origin: String },
}
