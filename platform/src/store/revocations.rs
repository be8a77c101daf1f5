//! Receipts of revocations, as the factories signed them.

use asi_model::{
    DateTime, DynamicDataRequestId, FactoryId, OperationId, OperationNetworkId,
    messages::SignedRevocation,
};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow, signed},
    scope::Scope,
};
use crate::opaque_id::OpaqueId;

/// A receipt as its readers see it: for the organisations that received the values, and for the
/// factory's own.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RevocationEntry {
    pub receipt_id: OpaqueId,
    pub factory_id: FactoryId,
    pub operation_id: OperationId,
    pub dynamic_data_request_id: DynamicDataRequestId,
    /// The receipt, a JSON document, byte by byte as the factory signed it.
    pub signed_text: String,
    /// Ed25519 signature over the UTF-8 text, hexadecimal, as the factory stated it.
    pub signature: String,
    /// Ed25519 key, hexadecimal, as the factory stated it; to be compared with the key of its
    /// ledger's checkpoints.
    pub public_key: String,
    /// Time of arrival at the platform.
    pub received_at: DateTime,
}

/// Condition on a row `v` of `revocation`: it is about the network `$2`, and the viewer `$1` may read it.
macro_rules! readable {
    () => {
        "v.operation_network_id = $2 AND (CAST($1 AS TEXT) IS NULL OR EXISTS (
             SELECT 1 FROM revocation_reader r
             WHERE r.revocation_number = v.revocation_number AND r.organisation_id = $1))"
    };
}

/// Repository of receipts.
pub struct Revocations<'w>(pub(super) &'w mut Connection);

impl Revocations<'_> {
    /// Stores a receipt with its readers: of the recipients that the factory names those that a
    /// revision named as recipients of the request, and the factory's organisation. A repeat has no
    /// effect.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add(
        &mut self,
        id: &OpaqueId,
        receipt: &SignedRevocation,
        received_at: DateTime,
    ) -> Result<bool, StoreError> {
        let sql =
            "INSERT INTO revocation (message_id, factory_id, operation_network_id, operation_id,
                       dynamic_data_request_id, signed_text, signature, public_key, received_at,
                       opaque_id)
                   VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)
                   ON CONFLICT DO NOTHING RETURNING revocation_number";
        let row = sqlx::query(sql)
            .bind(receipt.message_id.as_str())
            .bind(receipt.factory_id.as_str())
            .bind(receipt.operation_network_id.as_str())
            .bind(receipt.operation_id.as_str())
            .bind(receipt.dynamic_data_request_id.as_str())
            .bind(&receipt.signed_text)
            .bind(&receipt.signature)
            .bind(&receipt.public_key)
            .bind(received_at.ticks())
            .bind(id.as_str())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("store a receipt of a revocation"))?;
        let Some(row) = row else { return Ok(false) };
        let number: u64 = row.unsigned("revocation_number")?;
        let readers: Vec<&str> =
            receipt.recipient_list.iter().map(asi_model::OrganisationId::as_str).collect();
        let readers = serde_json::to_string(&readers).expect("texts serialise");
        let sql = "INSERT INTO revocation_reader (revocation_number, organisation_id)
                   SELECT $1, n.organisation_id FROM named_recipient n
                   JOIN json_each($2) r ON r.value = n.organisation_id
                   WHERE n.operation_network_id = $4 AND n.dynamic_data_request_id = $5
                   UNION SELECT $1, organisation_id FROM factory WHERE factory_id = $3";
        sqlx::query(sql)
            .bind(signed(number))
            .bind(readers)
            .bind(receipt.factory_id.as_str())
            .bind(receipt.operation_network_id.as_str())
            .bind(receipt.dynamic_data_request_id.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store the readers of a receipt"))?;
        Ok(true)
    }

    /// Returns the receipts about requests of a network that the viewer may read, oldest first, those
    /// that came after `after`. One that the viewer may not read restricts nothing.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(
        &mut self,
        scope: &Scope,
        network: &OperationNetworkId,
        after: Option<&OpaqueId>,
        limit: u32,
    ) -> Result<Vec<RevocationEntry>, StoreError> {
        let sql = concat!(
            "SELECT v.* FROM revocation v WHERE ",
            readable!(),
            " AND v.revocation_number > COALESCE(
                  (SELECT v.revocation_number FROM revocation v WHERE v.opaque_id = $3 AND ",
            readable!(),
            "), 0) ORDER BY v.revocation_number LIMIT $4"
        );
        let rows = sqlx::query(sql)
            .bind(scope.recipient())
            .bind(network.as_str())
            .bind(after.map(OpaqueId::as_str))
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list receipts of revocations"))?;
        rows.iter().map(read).collect()
    }
}

fn read(row: &DatabaseRow) -> Result<RevocationEntry, StoreError> {
    Ok(RevocationEntry {
        receipt_id: row.parsed("opaque_id")?,
        factory_id: row.parsed("factory_id")?,
        operation_id: row.parsed("operation_id")?,
        dynamic_data_request_id: row.parsed("dynamic_data_request_id")?,
        signed_text: row.column("signed_text")?,
        signature: row.column("signature")?,
        public_key: row.column("public_key")?,
        received_at: row.time("received_at")?,
    })
}
