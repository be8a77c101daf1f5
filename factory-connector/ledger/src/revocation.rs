//! Receipts of ended consents.

use asi_model::{DateTime, FactoryId, FieldKey, OrganisationId, RequestKey, messages::GapCause};
use serde::{Deserialize, Serialize};

use super::{Hash, key::is_signed};

/// Reason for which a receipt proves nothing.
#[derive(Debug, thiserror::Error)]
pub enum ReceiptError {
    /// The text was not signed with the key.
    #[error("the receipt is not signed with this key")]
    Signature,
    /// The signed text is no receipt.
    #[error("the signed text is no receipt")]
    Text(#[from] serde_json::Error),
}

/// Statement about the reports that had left when a consent ended. It is signed with the ledger's key
/// and never deleted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RevocationReceipt {
    pub revocation_id: String,
    pub factory_id: FactoryId,
    /// Time of the end; no value of these fields left afterwards.
    pub revoked_at: DateTime,
    /// User who ended the consent; none when the partner withdrew or changed the request.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub revoked_by: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// `REVOKED`, or `WITHDRAWN` by the partner.
    pub cause: GapCause,
    /// The fields with the consents that ended.
    pub fields: Vec<RevokedField>,
    /// The data sets that contained them.
    pub writers: Vec<RevokedWriter>,
}

/// A field whose consent ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RevokedField {
    pub field: FieldKey,
    /// Number of the consent that ended.
    pub consent_version: u32,
}

/// Delivery of a data set until the end of the consent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RevokedWriter {
    pub data_set_writer_id: u16,
    /// The writer's epoch until then.
    pub epoch: u32,
    /// The request that it reported for.
    pub request: RequestKey,
    /// Organisations that received it.
    pub recipient_list: Vec<OrganisationId>,
    /// The last sequence number given to a report; none when there was no report.
    pub last_queued_sequence: Option<u32>,
    /// The last sequence number that the broker accepted.
    pub last_sent_sequence: Option<u32>,
    /// The last sequence number that the platform confirmed.
    pub last_delivered_sequence: Option<u32>,
    /// Sent without a confirmation: they may have arrived, and are not sent again.
    pub in_flight: Vec<Sequences>,
    /// Queued and withdrawn: they never left.
    pub taken_back: Vec<Sequences>,
}

/// A range of consecutive sequence numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Sequences {
    pub first_sequence: u32,
    pub last_sequence: u32,
}

impl Sequences {
    /// Joins numbers to as few ranges as possible, in ascending order.
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

/// Most fields in one statement for a partner, so that it fits into a message.
const FIELDS_MAX: usize = 200;

impl RevocationReceipt {
    /// Returns what the receipt says about one data set, for its recipients: nothing of other
    /// requests, and not the name of the user. Many fields make several statements.
    #[must_use]
    pub fn for_partners(&self, writer: &RevokedWriter) -> Vec<Self> {
        let of_request = |field: &&RevokedField| field.field.request == writer.request;
        let fields: Vec<RevokedField> = self.fields.iter().filter(of_request).cloned().collect();
        let statement = |fields: &[RevokedField]| Self {
            revoked_by: None,
            fields: fields.to_vec(),
            writers: vec![writer.clone()],
            ..self.clone()
        };
        fields.chunks(FIELDS_MAX).map(statement).collect()
    }

    /// Reads a receipt whose signature is that of a key.
    ///
    /// # Errors
    /// [`ReceiptError`].
    pub fn verified(
        signed_text: &str,
        signature: &[u8],
        public_key: &Hash,
    ) -> Result<Self, ReceiptError> {
        if !is_signed(signed_text, signature, public_key) {
            return Err(ReceiptError::Signature);
        }
        Ok(serde_json::from_str(signed_text)?)
    }

    /// Returns the text that is signed and stored.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("a receipt has text keys only")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(request: &RequestKey, name: &str) -> RevokedField {
        RevokedField { field: request.field(name.parse().expect("a name")), consent_version: 2 }
    }

    /// The partner's page reads this text: `web/partner/networks/receipt.test.ts` opens the snapshot.
    #[test]
    fn a_statement_for_partners_reads_as_the_page_expects() {
        let request = RequestKey {
            operation_network_id: "frame".parse().expect("an id"),
            operation_id: "MakeFrame".parse().expect("an id"),
            dynamic_data_request_id: "Req".parse().expect("an id"),
        };
        let writer = RevokedWriter {
            data_set_writer_id: 1,
            epoch: 3,
            request: request.clone(),
            recipient_list: vec!["acme".parse().expect("an id")],
            last_queued_sequence: Some(9),
            last_sent_sequence: Some(8),
            last_delivered_sequence: Some(7),
            in_flight: Sequences::of(vec![8]),
            taken_back: Sequences::of(vec![9]),
        };
        let receipt = RevocationReceipt {
            revocation_id: "R".to_owned(),
            factory_id: "FOR_MUC".parse().expect("an id"),
            revoked_at: DateTime::from_unix_micros(1_800_000_000_000_000),
            revoked_by: Some("eve".to_owned()),
            reason: Some("Order closed".to_owned()),
            cause: GapCause::Revoked,
            fields: vec![field(&request, "count"), field(&request, "model")],
            writers: vec![writer.clone()],
        };
        let [statement] = &receipt.for_partners(&writer)[..] else { panic!("one statement") };
        insta::assert_snapshot!("statement_for_partners", statement.canonical());
    }
}
