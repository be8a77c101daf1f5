//! JSON Schemas (2020-12) of every message, generated from the types and published under `schema/`.
//!
//! A schema describes the structure; the validation has the rules beyond it.

mod document;
mod pubsub;
mod pubsub_definitions;

pub use document::SCHEMA_BASE;

use serde_json::Value;

use crate::{
    messages::{
        Acknowledgement, AssetOffer, AssetRequest, Comment, Decision, Gap, Lease, LeaseRequest,
        LedgerCheckpoint, LedgerCosignature, OperationNetworkMessage, PastRelease, Receipt,
        ReceiptRequest, SignedRevocation, Withdraw,
    },
    network::OperationNetwork,
};
use document::{document, message};

/// Every schema with its file name.
#[must_use]
pub fn all() -> Vec<(&'static str, Value)> {
    vec![
        ("operation-network.schema.json", message::<OperationNetworkMessage>("operation-network")),
        ("withdraw.schema.json", message::<Withdraw>("withdraw")),
        ("comment.schema.json", message::<Comment>("comment")),
        ("asset-request.schema.json", message::<AssetRequest>("asset-request")),
        ("receipt.schema.json", message::<Receipt>("receipt")),
        ("lease.schema.json", message::<Lease>("lease")),
        ("ledger-cosignature.schema.json", message::<LedgerCosignature>("ledger-cosignature")),
        ("acknowledgement.schema.json", message::<Acknowledgement>("acknowledgement")),
        ("decision.schema.json", message::<Decision>("decision")),
        ("gap.schema.json", message::<Gap>("gap")),
        ("asset-offer.schema.json", message::<AssetOffer>("asset-offer")),
        ("lease-request.schema.json", message::<LeaseRequest>("lease-request")),
        ("revocation.schema.json", message::<SignedRevocation>("revocation")),
        ("ledger-checkpoint.schema.json", message::<LedgerCheckpoint>("ledger-checkpoint")),
        ("past-release.schema.json", message::<PastRelease>("past-release")),
        ("receipt-request.schema.json", message::<ReceiptRequest>("receipt-request")),
        ("network.schema.json", document::<OperationNetwork>("network")),
        ("ua-data.schema.json", pubsub::data()),
        ("ua-metadata.schema.json", pubsub::meta_data()),
        ("ua-status.schema.json", pubsub::status()),
    ]
}

/// The text of a schema file.
#[must_use]
pub fn text(schema: &Value) -> String {
    format!("{schema:#}\n")
}

#[cfg(test)]
mod tests;
