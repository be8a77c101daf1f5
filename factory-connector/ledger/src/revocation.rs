//! Receipts of ended consents.

use asi_model::{DateTime, FactoryId, FieldKey, OrganisationId, RequestKey, messages::GapCause};
use serde::{Deserialize, Serialize};

/// A statement of what had left when a consent ended. It is signed with the ledger's key and kept
/// for ever.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RevocationReceipt {
    /// Its id.
    pub revocation_id: String,
    /// Whose.
    #[schema(value_type = String)]
    pub factory_id: FactoryId,
    /// When: nothing of these fields left afterwards.
    #[schema(value_type = String, format = "date-time")]
    pub revoked_at: DateTime,
    /// Who ended the consent; none where the partner withdrew or changed the request.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub revoked_by: Option<String>,
    /// Why.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// `REVOKED`, or `WITHDRAWN` by the partner.
    #[schema(value_type = String)]
    pub cause: GapCause,
    /// The fields that no longer leave, with the consent that ended.
    pub fields: Vec<RevokedField>,
    /// The data sets they left in.
    pub writers: Vec<RevokedWriter>,
}

/// A field whose consent ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RevokedField {
    /// The field.
    #[schema(value_type = Object)]
    pub field: FieldKey,
    /// The number of the consent that ended.
    pub consent_version: u32,
}

/// What had left of a data set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RevokedWriter {
    /// The writer.
    pub data_set_writer_id: u16,
    /// Its epoch up to now.
    pub epoch: u32,
    /// What it reported about.
    #[schema(value_type = Object)]
    pub request: RequestKey,
    /// Who could see it.
    #[schema(value_type = Vec<String>)]
    pub recipient_list: Vec<OrganisationId>,
    /// The last number given to a report; none where there was none.
    pub last_queued_sequence: Option<u32>,
    /// The last that the broker accepted.
    pub last_sent_sequence: Option<u32>,
    /// The last that the platform said it holds.
    pub last_delivered_sequence: Option<u32>,
    /// Sent, but not yet said to be held: they may have arrived, and are not sent again.
    pub in_flight: Vec<Sequences>,
    /// Queued and taken back: they never left.
    pub taken_back: Vec<Sequences>,
}

/// Neighbouring sequence numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Sequences {
    /// The first.
    pub first_sequence: u32,
    /// The last.
    pub last_sequence: u32,
}

impl Sequences {
    /// Numbers as few ranges, ascending.
    #[must_use]
    pub fn of(mut numbers: Vec<u32>) -> Vec<Self> {
        numbers.sort_unstable();
        numbers.dedup();
        let mut ranges: Vec<Self> = Vec::new();
        for number in numbers {
            match ranges.last_mut() {
                Some(range) if range.last_sequence.checked_add(1) == Some(number) => {
                    range.last_sequence = number
                }
                _ => ranges.push(Self { first_sequence: number, last_sequence: number }),
            }
        }
        ranges
    }
}

impl RevocationReceipt {
    /// The text that is signed and stored.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("a receipt has text keys only")
    }
}
