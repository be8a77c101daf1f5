//! What the ledger records.

use std::collections::BTreeMap;

use asi_model::{
    DateTime, FieldKey, FieldName, MessageId, OrganisationId,
    messages::{MappingState, ValueSource},
};
use disclosure::{DecisionBasis, DisclosurePolicy, Language};
use serde::{Deserialize, Serialize};

/// Sequence numbers of one writer and epoch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SequenceRange {
    /// The writer.
    pub data_set_writer_id: u16,
    /// Its epoch.
    pub epoch: u32,
    /// The first.
    pub first_sequence: u32,
    /// The last.
    pub last_sequence: u32,
}

/// What happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "SCREAMING_SNAKE_CASE", rename_all_fields = "camelCase")]
#[expect(clippy::large_enum_variant, reason = "one at a time, moved once")]
pub enum Event {
    /// The engineer decided about a field.
    Consent {
        /// Which.
        field: FieldKey,
        /// Counts the consents of the field.
        version: u32,
        /// The decision.
        mapping_state: MappingState,
        /// Where values come from.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        value_source: Option<ValueSource>,
        /// How they are coarsened.
        policy: DisclosurePolicy,
        /// Who decided.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        decided_by: Option<String>,
        /// The rules and named policies on whose grounds it was decided.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        grounds: Option<DecisionBasis>,
    },
    /// A DataSetMessage was committed to the spool: from here on it will leave.
    Queued {
        /// Which; first and last are the same.
        #[serde(flatten)]
        range: SequenceRange,
        /// Root over the salted hashes of its members, hexadecimal.
        values: String,
        /// Under which consent each field left.
        consents: BTreeMap<FieldName, u32>,
    },
    /// The broker accepted them.
    Sent {
        /// Which.
        #[serde(flatten)]
        range: SequenceRange,
        /// The NetworkMessage they left in.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        message_id: Option<MessageId>,
    },
    /// The platform holds them.
    Receipted(SequenceRange),
    /// The spool was full and only newer values were kept.
    Coalesced(SequenceRange),
    /// They became too old before they could be sent.
    Expired(SequenceRange),
    /// They were taken back because the consent or the request ended; those not sent never left.
    Purged(SequenceRange),
    /// A consent ended; the receipt with this id says which.
    Revoked {
        /// The receipt.
        revocation_id: String,
        /// The writer that the fields left with.
        data_set_writer_id: u16,
        /// Its epoch up to then.
        epoch: u32,
        /// The last number that the broker accepted.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        last_sent_sequence: Option<u32>,
        /// The last number that the platform said it holds.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        last_delivered_sequence: Option<u32>,
    },
}

/// The kinds of events, to look for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
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
}

impl EventKind {
    /// Those that name reports by their writer.
    pub const OF_REPORTS: [Self; 7] = [
        Self::Queued,
        Self::Sent,
        Self::Receipted,
        Self::Coalesced,
        Self::Expired,
        Self::Purged,
        Self::Revoked,
    ];

    /// For people to read, as the pages say it.
    #[must_use]
    pub const fn said_in(self, language: Language) -> &'static str {
        let (english, german) = match self {
            Self::Consent => ("Decision", "Entscheidung"),
            Self::Queued => ("Queued", "Eingereiht"),
            Self::Sent => ("Sent", "Gesendet"),
            Self::Receipted => ("Receipted", "Quittiert"),
            Self::Coalesced => ("Coalesced", "Zusammengefasst"),
            Self::Expired => ("Expired", "Verfallen"),
            Self::Purged => ("Purged", "Gelöscht"),
            Self::Revoked => ("Consent ended", "Einwilligung beendet"),
        };
        language.choose(english, german)
    }

    /// As in the hashed text.
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
        }
    }
}

/// An entry of a chain, as it is hashed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Entry {
    /// Whose chain.
    pub recipient: OrganisationId,
    /// Its place, from 1 without gaps.
    pub number: u64,
    /// When it was recorded.
    pub recorded_at: DateTime,
    /// What happened.
    #[serde(flatten)]
    pub event: Event,
}

impl Entry {
    /// The canonical text that is hashed and stored.
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
        let entry = |event| Entry {
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
        for entry in [queued, sent] {
            assert_eq!(
                serde_json::from_str::<Entry>(&entry.canonical()).expect("reads back"),
                entry
            );
        }
    }
}
