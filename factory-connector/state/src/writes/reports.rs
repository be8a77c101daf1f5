//! Rows of the spool: data set writers, reports and control messages.

use std::collections::BTreeMap;

use asi_model::{DateTime, FieldKey, FieldName, MessageId, OrganisationId, RequestKey};
use disclosure::ReportBody;
use ledger::SALT_BYTES;
use spool::ReportRow;

use super::GapWrites;
use crate::ControlBody;

/// Rows about data set writers.
#[derive(Debug, Default, PartialEq)]
pub struct WriterWrites {
    /// Writers that are new, retired or have another version, by DataSetWriterId.
    pub changed: BTreeMap<u16, WriterRow>,
    /// Fields that a writer carries for the first time in its epoch.
    pub carried_fields: Vec<CarriedFieldRow>,
    /// Every writer began a new epoch, as a restored, moved or copied store demands.
    pub are_epochs_begun: bool,
}

impl WriterWrites {
    pub(super) fn merge(&mut self, later: Self) {
        let Self { changed, carried_fields, are_epochs_begun } = later;
        super::merge::extend(&mut self.changed, changed);
        self.carried_fields.extend(carried_fields);
        self.are_epochs_begun |= are_epochs_begun;
    }
}

/// A DataSetWriter (OPC UA Part 14).
#[derive(Debug, Clone, PartialEq)]
pub struct WriterRow {
    /// The request that it reports about.
    pub request: RequestKey,
    /// MajorVersion of the metadata.
    pub epoch: u32,
    /// MinorVersion of the metadata.
    pub minor_version: u32,
    /// Sequence number of the next report.
    pub next_sequence: u32,
    /// The fields that the metadata describes, in payload order.
    pub fields: Vec<FieldName>,
    pub retired_at: Option<DateTime>,
}

/// The first report of an epoch that carries a field.
#[derive(Debug, Clone, PartialEq)]
pub struct CarriedFieldRow {
    pub field: FieldKey,
    pub data_set_writer_id: u16,
    pub epoch: u32,
    pub first_sequence: u32,
}

/// Rows about reports.
#[derive(Debug, Default, PartialEq)]
pub struct ReportWrites {
    /// New reports, in the order of their numbers.
    pub queued: Vec<NewReport>,
    /// Changes of delivery state, in order.
    pub moves: Vec<ReportMove>,
    /// Numbers of the reports whose values retention empties.
    pub emptied: Vec<i64>,
    /// Gaps that were announced, until a receipt covers them.
    pub gaps: GapWrites,
}

impl ReportWrites {
    pub(super) fn merge(&mut self, later: Self) {
        let Self { queued, moves, emptied, gaps } = later;
        self.queued.extend(queued);
        self.moves.extend(moves);
        self.emptied.extend(emptied);
        self.gaps.merge(gaps);
    }
}

/// A report to be sent.
#[derive(Debug, Clone, PartialEq)]
pub struct NewReport {
    /// Number in the spool.
    pub id: i64,
    /// Number of the message in which it is sent: that of the message's last report.
    pub message: i64,
    pub data_set_writer_id: u16,
    pub epoch: u32,
    pub sequence: u32,
    pub created_at: DateTime,
    /// Organisations that may read it.
    pub recipients: Vec<OrganisationId>,
    /// The DataSetMessage as JSON, without its number and times.
    pub body: ReportBody,
    /// Random bytes, so that its hashes reveal nothing.
    pub salt: [u8; SALT_BYTES],
}

/// A change of the delivery state of reports.
#[derive(Debug, Clone, PartialEq)]
pub enum ReportMove {
    /// The broker accepted these reports.
    Sent {
        /// Numbers of the reports, each with the id of the message that carried it.
        reports: Vec<(i64, Option<MessageId>)>,
        at: DateTime,
    },
    /// The platform has stored these reports: the spool is done with them.
    Receipted {
        /// Numbers of the reports.
        reports: Vec<i64>,
        at: DateTime,
    },
    /// Reports to send again.
    Waiting(Vec<i64>),
    /// Receipted reports that the platform misses all the same, to send again.
    Reopened(Vec<i64>),
    /// Messages that the broker rejected once more.
    Attempted(Vec<i64>),
    /// Messages that the broker will never accept.
    Parked(Vec<i64>),
    /// Reports that the spool is done with.
    Done(Vec<i64>),
    /// Reports that are never sent again, whatever their outcome.
    Revoked(Vec<i64>),
}

impl ReportMove {
    /// Returns whether the move is about a report, or about its message.
    #[must_use]
    pub fn concerns(&self, report: i64, message: i64) -> bool {
        match self {
            Self::Sent { reports, .. } => reports.iter().any(|(id, _)| *id == report),
            Self::Receipted { reports, .. }
            | Self::Waiting(reports)
            | Self::Reopened(reports)
            | Self::Done(reports)
            | Self::Revoked(reports) => reports.contains(&report),
            Self::Attempted(messages) | Self::Parked(messages) => messages.contains(&message),
        }
    }
}

/// A report in the spool, without its body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WaitingRow {
    /// Input of the spool's decisions.
    pub row: ReportRow,
    /// Organisations that may read it.
    pub recipients: Vec<OrganisationId>,
    /// The consent ended after it was sent.
    pub is_revoked: bool,
    /// Number of the message in which it is sent.
    pub message: i64,
    /// Taken back before it was known to be sent.
    pub is_done: bool,
}

/// Rows about control messages: everything that is sent but reports.
#[derive(Debug, Default, PartialEq)]
pub struct ControlWrites {
    /// New messages, in the order of their numbers.
    pub queued: Vec<ControlRow>,
    /// Numbers of messages that were accepted or expired.
    pub done: Vec<i64>,
    /// Numbers of messages that the broker will never accept.
    pub parked: Vec<i64>,
    /// Numbers of messages that the broker rejected once more.
    pub attempted: Vec<i64>,
}

impl ControlWrites {
    pub(super) fn merge(&mut self, later: Self) {
        let Self { queued, done, parked, attempted } = later;
        self.queued.extend(queued);
        self.done.extend(done);
        self.parked.extend(parked);
        self.attempted.extend(attempted);
    }
}

/// A control message.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlRow {
    /// Number in the spool.
    pub id: i64,
    pub message_id: MessageId,
    pub subject: String,
    /// Id of the message that this one answers.
    pub correlation_id: Option<MessageId>,
    pub body: ControlBody,
    pub created_at: DateTime,
    /// Time to live in milliseconds; unlimited without it.
    pub ttl_ms: Option<u64>,
}
