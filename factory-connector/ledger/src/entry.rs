//! Entries of the ledger and the events that they record.

use std::collections::BTreeMap;

use asi_model::{
    DateTime, FieldKey, FieldName, MessageId, OrganisationId,
    messages::{MappingState, ValueSource},
};
use disclosure::{DecisionBasis, DisclosurePolicy, Language};
use serde::{Deserialize, Serialize};

use super::{RetentionStatement, SequenceRange};

/// Event that an entry records.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "SCREAMING_SNAKE_CASE", rename_all_fields = "camelCase")]
#[expect(clippy::large_enum_variant, reason = "one at a time, moved once")]
pub enum Event {
    /// The engineer decided about a field.
    Consent {
        field: FieldKey,
        /// Number of the consent of the field, from 1.
        version: u32,
        mapping_state: MappingState,
        /// Source of the values; none for a refusal.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        value_source: Option<ValueSource>,
        policy: DisclosurePolicy,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        decided_by: Option<String>,
        /// Commitment to the documents that the decision is based on (see
        /// [`basis_for_recipients`](crate::basis_for_recipients)); entries of former versions name
        /// them.
        #[serde(rename = "grounds", default, skip_serializing_if = "Option::is_none")]
        basis: Option<DecisionBasis>,
    },
    /// A DataSetMessage was committed to the spool and will be sent.
    Queued {
        /// The DataSetMessage; first and last sequence number are the same.
        #[serde(flatten)]
        range: SequenceRange,
        /// Root over the salted hashes of its members, hexadecimal.
        values: String,
        /// The consent of each field, by its number.
        consents: BTreeMap<FieldName, u32>,
    },
    /// The broker accepted these DataSetMessages.
    Sent {
        #[serde(flatten)]
        range: SequenceRange,
        /// The NetworkMessage that contained them.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        message_id: Option<MessageId>,
    },
    /// The platform has stored them.
    Receipted(SequenceRange),
    /// Dropped for newer values, because the spool was full.
    Coalesced(SequenceRange),
    /// Became too old before they could be sent.
    Expired(SequenceRange),
    /// Withdrawn because the consent or the request ended; those not sent never will be.
    Purged(SequenceRange),
    /// A consent ended, as the receipt with this id states.
    Revoked {
        revocation_id: String,
        /// The writer of the fields' reports.
        data_set_writer_id: u16,
        /// The writer's epoch until then.
        epoch: u32,
        /// The last sequence number that the broker accepted.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        last_sent_sequence: Option<u32>,
        /// The last sequence number that the platform confirmed.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        last_delivered_sequence: Option<u32>,
    },
    /// Values of reports were emptied, or the oldest entries of the chain removed.
    Retention(RetentionStatement),
    /// Reports that had left for others before are shown to this recipient, too.
    PastReleased {
        #[serde(flatten)]
        range: SequenceRange,
        /// Root over the roots of the reports' values, hexadecimal (see
        /// [`past_root`](crate::past_root)).
        values: String,
        /// Name of the person who decided.
        decided_by: String,
        /// Reason that the person gave.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reason: Option<String>,
    },
}

/// Kind of an event, for searches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[allow(missing_docs)]
pub enum EventKind {
    Consent,
    Queued,
    Sent,
    Receipted,
    Coalesced,
    Expired,
    Purged,
    Revoked,
    Retention,
    PastReleased,
}

impl EventKind {
    /// Kinds of events about reports.
    pub const OF_REPORTS: [Self; 8] = [
        Self::Queued,
        Self::Sent,
        Self::Receipted,
        Self::Coalesced,
        Self::Expired,
        Self::Purged,
        Self::Revoked,
        Self::PastReleased,
    ];

    /// Returns the name for people, the same as on the pages.
    #[must_use]
    pub const fn in_language(self, language: Language) -> &'static str {
        let (english, german) = match self {
            Self::Consent => ("Decision", "Entscheidung"),
            Self::Queued => ("Queued", "Eingereiht"),
            Self::Sent => ("Sent", "Gesendet"),
            Self::Receipted => ("Receipted", "Quittiert"),
            Self::Coalesced => ("Coalesced", "Zusammengefasst"),
            Self::Expired => ("Expired", "Verfallen"),
            Self::Purged => ("Purged", "Gelöscht"),
            Self::Revoked => ("Consent ended", "Einwilligung beendet"),
            Self::Retention => ("Retention", "Aufbewahrung"),
            Self::PastReleased => ("Past shown", "Vergangenes gezeigt"),
        };
        language.choose(english, german)
    }

    /// Returns the name in the hashed text.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Consent => "CONSENT",
            Self::Queued => "QUEUED",
            Self::Sent => "SENT",
            Self::Receipted => "RECEIPTED",
            Self::Coalesced => "COALESCED",
            Self::Expired => "EXPIRED",
            Self::Purged => "PURGED",
            Self::Revoked => "REVOKED",
            Self::Retention => "RETENTION",
            Self::PastReleased => "PAST_RELEASED",
        }
    }
}

/// An entry of a chain, whose canonical text is hashed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct LedgerEntry {
    pub recipient: OrganisationId,
    /// Number in the chain, from 1 without gaps.
    pub number: u64,
    pub recorded_at: DateTime,
    #[serde(flatten)]
    pub event: Event,
}

impl LedgerEntry {
    /// Returns the canonical text that is hashed and stored.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("an entry has text keys and finite numbers only")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_of_entries_never_changes() {
        let entry = |event| LedgerEntry {
            recipient: "acme".parse().expect("an id"),
            number: 7,
            recorded_at: "2026-11-21T10:00:00Z".parse().expect("a time"),
            event,
        };
        let range =
            SequenceRange { data_set_writer_id: 1, epoch: 9, first_sequence: 4, last_sequence: 4 };
        let queued = entry(Event::Queued {
            range,
            values: "00ff".to_owned(),
            consents: [("progress".parse().expect("a name"), 2)].into(),
        });
        insta::assert_snapshot!(queued.canonical(), @r#"{"recipient":"acme","number":7,"recordedAt":"2026-11-21T10:00:00Z","event":"QUEUED","dataSetWriterId":1,"epoch":9,"firstSequence":4,"lastSequence":4,"values":"00ff","consents":{"progress":2}}"#);
        let sent = entry(Event::Sent { range, message_id: None });
        insta::assert_snapshot!(sent.canonical(), @r#"{"recipient":"acme","number":7,"recordedAt":"2026-11-21T10:00:00Z","event":"SENT","dataSetWriterId":1,"epoch":9,"firstSequence":4,"lastSequence":4}"#);
        let past = entry(Event::PastReleased {
            range: SequenceRange { last_sequence: 9, ..range },
            values: "00ff".to_owned(),
            decided_by: "eve".to_owned(),
            reason: None,
        });
        insta::assert_snapshot!(past.canonical(), @r#"{"recipient":"acme","number":7,"recordedAt":"2026-11-21T10:00:00Z","event":"PAST_RELEASED","dataSetWriterId":1,"epoch":9,"firstSequence":4,"lastSequence":9,"values":"00ff","decidedBy":"eve"}"#);
        for entry in [queued, sent, past] {
            assert_eq!(
                serde_json::from_str::<LedgerEntry>(&entry.canonical()).expect("reads back"),
                entry
            );
        }
    }
}
