//! Reports that left a plant by the audit file of its ledger, and what they contained.

use std::collections::BTreeMap;

use ::ledger::{Event, LedgerEntry, SequenceRange, audit::AuditEntry};
use asi_model::{
    DateTime, FieldKey, FieldName, RequestKey, Scalar,
    opcua_json::Leniency,
    plain_value::ReportedValue,
    pubsub::{
        DataSetMessage, PubSubMessage, ReportHeader, is_report_field, json::decode_described,
    },
};
use serde::Serialize;

/// Numbers of a report, unique within its factory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ReportId {
    pub data_set_writer_id: u16,
    pub epoch: u32,
    pub sequence: u32,
}

/// Statement of an entry about reports.
#[derive(Debug)]
pub enum LeftEntry {
    /// A report was queued for the recipient.
    Queued(Box<QueuedReport>),
    /// Reports of which those that were not sent never will be.
    Ended(SequenceRange),
    /// Reports that had left for others are shown to the recipient, too.
    PastReleased(SequenceRange),
    /// A decision about a field, with the number of the consent.
    Consent(FieldKey, u32),
    /// A statement about something else.
    Other,
}

/// A report that was queued for a recipient.
#[derive(Debug)]
pub struct QueuedReport {
    pub id: ReportId,
    pub recorded_at: DateTime,
    /// The consent of each field, by its number.
    pub consents: BTreeMap<FieldName, u32>,
    /// Its content; none where retention has emptied it, or no reader of the wire could read it.
    pub content: Option<ReportContent>,
}

/// Content of a report, as those who receive it read it.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportContent {
    /// The request it answers.
    pub request: RequestKey,
    pub report_name: String,
    /// The newest source time among the fields.
    pub shopfloor_timestamp: Option<DateTime>,
    /// Time of the report at the connector.
    pub report_timestamp: Option<DateTime>,
    /// The fields by their names.
    pub fields: BTreeMap<String, ReportedValue>,
}

impl ReportId {
    /// Returns the writer and its epoch.
    pub const fn writer(self) -> (u16, u32) {
        (self.data_set_writer_id, self.epoch)
    }
}

impl LeftEntry {
    /// Reads a line of an audit file after the first.
    pub fn read(line: &str) -> Self {
        let Ok(line) = serde_json::from_str::<AuditEntry>(line) else { return Self::Other };
        let Ok(entry) = serde_json::from_str::<LedgerEntry>(&line.entry) else {
            return Self::Other;
        };
        match entry.event {
            Event::Queued { range, consents, .. } => Self::Queued(Box::new(QueuedReport {
                id: ReportId {
                    data_set_writer_id: range.data_set_writer_id,
                    epoch: range.epoch,
                    sequence: range.first_sequence,
                },
                recorded_at: entry.recorded_at,
                consents,
                content: line.report.and_then(|report| ReportContent::read(report.get())),
            })),
            Event::Coalesced(range) | Event::Expired(range) | Event::Purged(range) => {
                Self::Ended(range)
            }
            Event::PastReleased { range, .. } => Self::PastReleased(range),
            Event::Consent { field, version, .. } => Self::Consent(field, version),
            Event::Sent { .. }
            | Event::Receipted(_)
            | Event::Revoked { .. }
            | Event::Retention(_) => Self::Other,
        }
    }
}

impl ReportContent {
    /// Reads a DataSetMessage; `None` where it is none that answers a request.
    fn read(report: &str) -> Option<Self> {
        let decoded = decode_described(report.as_bytes(), Leniency::Lenient, &()).ok()?;
        let PubSubMessage::Data(mut message) = decoded.message else { return None };
        let message = message.messages.pop()?;
        let text = |name| message.text(name);
        let request = RequestKey {
            operation_network_id: text(ReportHeader::OPERATION_NETWORK_ID)?.parse().ok()?,
            operation_id: text(ReportHeader::OPERATION_ID)?.parse().ok()?,
            dynamic_data_request_id: text(ReportHeader::DYNAMIC_DATA_REQUEST_ID)?.parse().ok()?,
        };
        let shopfloor_timestamp = time(&message, ReportHeader::SHOPFLOOR_TIMESTAMP);
        let fields = message.fields.iter().filter(|field| is_report_field(&message, &field.name));
        let fields = fields.map(|field| {
            let mut value = ReportedValue::from(&field.value);
            // A value without a time of its own has that of its report.
            value.source_timestamp = value.source_timestamp.or(shopfloor_timestamp);
            (field.name.to_string(), value)
        });
        Some(Self {
            request,
            report_name: text(ReportHeader::REPORT_NAME).unwrap_or_default().to_owned(),
            shopfloor_timestamp,
            report_timestamp: message.timestamp,
            fields: fields.collect(),
        })
    }

    /// Returns the time of a value, as records of accesses have it.
    pub fn time_of(&self, value: &ReportedValue) -> Option<DateTime> {
        value.source_timestamp.or(self.report_timestamp).or(self.shopfloor_timestamp)
    }
}

fn time(message: &DataSetMessage, name: &str) -> Option<DateTime> {
    match message.field(name)?.value.as_scalar()? {
        Scalar::DateTime(time) => Some(*time),
        Scalar::String(text) => text.as_deref()?.parse().ok(),
        _ => None,
    }
}
