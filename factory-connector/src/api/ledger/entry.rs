//! Entries of a chain as pages show them.

use std::collections::BTreeMap;

use asi_model::{
    FieldKey, FieldName, MessageId,
    messages::{MappingState, ValueSource},
    openapi::EncodedValue,
};
use disclosure::{DecisionBasis, DisclosurePolicy, Statement, StatementPart};
use ledger::{Event, LedgerEntry, RetentionStatement, SequenceRange};
use serde::Serialize;
use serde_json::{Map, Value};
use utoipa::ToSchema;

use crate::store::LedgerRow;

/// An entry of a chain.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct EntryView {
    /// Position in the chain, from 1.
    sequence: u64,
    /// Time of recording, RFC 3339.
    at: String,
    /// Recipient of the chain.
    recipient_id: String,
    #[serde(flatten)]
    event: EventView,
    /// Values of a report that left, by field, while they are retained.
    #[schema(value_type = Option<BTreeMap<String, EncodedValue>>)]
    value: Option<Map<String, Value>>,
    /// Precision under each consent that the entry names, by field, in the words of the statement to
    /// the partner.
    precision: BTreeMap<String, String>,
    /// The same as codes with parameters.
    precision_parts: BTreeMap<String, Vec<StatementPart>>,
    /// Id of the message that carried a report last.
    left_in_message: Option<String>,
    /// Time at which the broker accepted a report last.
    #[schema(format = "date-time")]
    sent_at: Option<String>,
    /// Time of the platform's receipt for a report.
    #[schema(format = "date-time")]
    delivered_at: Option<String>,
    /// Hash of the entry, hexadecimal.
    hash: String,
}

/// Event that an entry records.
#[derive(Serialize, ToSchema)]
#[serde(tag = "kind", rename_all = "SCREAMING_SNAKE_CASE")]
pub enum EventView {
    /// The engineer decided about a field.
    Consent(Box<ConsentView>),
    /// A DataSetMessage was committed to the spool and will be sent.
    Queued(QueuedView),
    /// The broker accepted these DataSetMessages.
    Sent(SentView),
    /// The platform has stored them.
    Receipted(SequenceRange),
    /// Dropped for newer values, because the spool was full.
    Coalesced(SequenceRange),
    /// Became too old before they could be sent.
    Expired(SequenceRange),
    /// Withdrawn because the consent or the request ended.
    Purged(SequenceRange),
    /// A consent ended.
    Revoked(RevokedView),
    /// Values of reports were emptied, or the oldest entries of the chain removed.
    Retention(RetentionStatement),
    /// Reports that had left for others before are shown to this recipient, too.
    PastReleased(PastReleasedView),
    /// The stored text is damaged; the verification of the ledger names the entry.
    Unreadable,
}

/// Decision about a field.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ConsentView {
    #[serde(flatten)]
    field: FieldKey,
    /// Number of the consent of the field, from 1.
    version: u32,
    mapping_state: MappingState,
    /// Source of the values; none for a refusal.
    #[serde(skip_serializing_if = "Option::is_none")]
    value_source: Option<ValueSource>,
    /// Coarsening of values as decided.
    policy: DisclosurePolicy,
    /// Name of the person or rule that decided.
    #[serde(skip_serializing_if = "Option::is_none")]
    decided_by: Option<String>,
    /// The rules and named policies that the decision is based on.
    #[serde(rename = "grounds", skip_serializing_if = "Option::is_none")]
    basis: Option<DecisionBasis>,
}

/// Commitment to the values of a DataSetMessage.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct QueuedView {
    #[serde(flatten)]
    range: SequenceRange,
    /// Root over the salted hashes of its members, hexadecimal.
    values: String,
    /// The consent of each field, by its number.
    #[schema(value_type = BTreeMap<String, u32>)]
    consents: BTreeMap<FieldName, u32>,
}

/// DataSetMessages with the NetworkMessage that contained them.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SentView {
    #[serde(flatten)]
    range: SequenceRange,
    #[serde(skip_serializing_if = "Option::is_none")]
    message_id: Option<MessageId>,
}

/// End of a consent.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RevokedView {
    /// Id of the receipt that states it.
    revocation_id: String,
    /// The writer of the fields' reports.
    data_set_writer_id: u16,
    /// The writer's epoch until then.
    epoch: u32,
    /// The last sequence number that the broker accepted.
    #[serde(skip_serializing_if = "Option::is_none")]
    last_sent_sequence: Option<u32>,
    /// The last sequence number that the platform confirmed.
    #[serde(skip_serializing_if = "Option::is_none")]
    last_delivered_sequence: Option<u32>,
}

/// Reports of the past that are shown to the recipient of the chain.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PastReleasedView {
    #[serde(flatten)]
    range: SequenceRange,
    /// Root over the roots of the reports' values, hexadecimal.
    values: String,
    /// Name of the person who decided.
    decided_by: String,
    /// Reason that the person gave.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
}

impl From<LedgerRow> for EntryView {
    fn from(row: LedgerRow) -> Self {
        // A damaged entry must not hide the others; the verification reports it.
        let (at, recipient_id, event) = match serde_json::from_str::<LedgerEntry>(&row.content) {
            Ok(LedgerEntry { recipient, recorded_at, event, .. }) => {
                (recorded_at.to_string(), recipient.to_string(), event.into())
            }
            Err(_) => (String::new(), String::new(), EventView::Unreadable),
        };
        let event = match (event, row.basis) {
            (EventView::Consent(consent), basis @ Some(_)) => {
                EventView::Consent(Box::new(ConsentView { basis, ..*consent }))
            }
            (event, _) => event,
        };
        let (mut precision, mut precision_parts) = (BTreeMap::new(), BTreeMap::new());
        for (field, Statement { statement, statement_parts }) in row.precision {
            precision.insert(field.clone(), statement);
            precision_parts.insert(field, statement_parts);
        }
        Self {
            sequence: row.number,
            at,
            recipient_id,
            event,
            value: row.report.as_deref().and_then(payload),
            precision,
            precision_parts,
            left_in_message: row.message_id,
            sent_at: row.sent_at.map(|at| at.to_string()),
            delivered_at: row.delivered_at.map(|at| at.to_string()),
            hash: row.hash,
        }
    }
}

impl From<Event> for EventView {
    fn from(event: Event) -> Self {
        match event {
            Event::Consent {
                field,
                version,
                mapping_state,
                value_source,
                policy,
                decided_by,
                basis,
            } => Self::Consent(Box::new(ConsentView {
                field,
                version,
                mapping_state,
                value_source,
                policy,
                decided_by,
                basis,
            })),
            Event::Queued { range, values, consents } => {
                Self::Queued(QueuedView { range, values, consents })
            }
            Event::Sent { range, message_id } => Self::Sent(SentView { range, message_id }),
            Event::Receipted(range) => Self::Receipted(range),
            Event::Coalesced(range) => Self::Coalesced(range),
            Event::Expired(range) => Self::Expired(range),
            Event::Purged(range) => Self::Purged(range),
            Event::Revoked {
                revocation_id,
                data_set_writer_id,
                epoch,
                last_sent_sequence,
                last_delivered_sequence,
            } => Self::Revoked(RevokedView {
                revocation_id,
                data_set_writer_id,
                epoch,
                last_sent_sequence,
                last_delivered_sequence,
            }),
            Event::Retention(statement) => Self::Retention(statement),
            Event::PastReleased { range, values, decided_by, reason } => {
                Self::PastReleased(PastReleasedView { range, values, decided_by, reason })
            }
        }
    }
}

/// Returns the payload of a DataSetMessage.
fn payload(report: &str) -> Option<Map<String, Value>> {
    let mut report: Map<String, Value> = serde_json::from_str(report).ok()?;
    match report.remove("Payload")? {
        Value::Object(payload) => Some(payload),
        _ => None,
    }
}
