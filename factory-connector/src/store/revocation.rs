//! Receipts of ended consents, and what became of reports that were on their way then.

use asi_model::DateTime;
use sqlx::{Row as _, SqlitePool, sqlite::SqliteRow};

use super::{StoreError, load::get};
use crate::ledger::RevocationReceipt;

/// A receipt with its signature, and what is known today of what was on its way.
#[derive(Debug, Clone, PartialEq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct StoredRevocation {
    /// As signed.
    #[serde(flatten)]
    pub receipt: RevocationReceipt,
    /// The exact text that was signed.
    pub signed_text: String,
    /// The Ed25519 signature over that text, hexadecimal.
    pub signature: String,
    /// The key it is verified with, hexadecimal.
    pub public_key: String,
    /// Reports that were on their way when the consent ended, of which the platform has said since that it holds them.
    pub arrived_since: u32,
    /// Reports of which it is still not known whether they arrived.
    pub open: u32,
}

const COLUMNS: &str = "SELECT content, signature, public_key, revoked_at FROM revocation";

/// Receipts, newest first, before a time.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn revocations(
    readers: &SqlitePool,
    before: DateTime,
    limit: u32,
) -> Result<Vec<StoredRevocation>, StoreError> {
    let rows = sqlx::query(
        "SELECT content, signature, public_key, revoked_at FROM revocation WHERE revoked_at < ? \
         ORDER BY revoked_at DESC, revocation_id DESC LIMIT ?",
    )
    .bind(before.unix_micros())
    .bind(i64::from(limit))
    .fetch_all(readers)
    .await
    .map_err(StoreError::while_doing("read the revocations"))?;
    let mut found = Vec::with_capacity(rows.len());
    for row in &rows {
        found.push(with_arrivals(readers, revocation(row)?).await?);
    }
    Ok(found)
}

/// One receipt.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn revocation_by_id(readers: &SqlitePool, id: &str) -> Result<Option<StoredRevocation>, StoreError> {
    let row = sqlx::query(sqlx::AssertSqlSafe(format!("{COLUMNS} WHERE revocation_id = ?")))
        .bind(id.to_owned())
        .fetch_optional(readers)
        .await
        .map_err(StoreError::while_doing("read the revocations"))?;
    match row {
        Some(row) => Ok(Some(with_arrivals(readers, revocation(&row)?).await?)),
        None => Ok(None),
    }
}

fn revocation(row: &SqliteRow) -> Result<StoredRevocation, StoreError> {
    let signed_text: String = get(row, 0)?;
    Ok(StoredRevocation {
        receipt: serde_json::from_str(&signed_text).map_err(StoreError::unreadable("revocation"))?,
        signed_text,
        signature: hex::encode(get::<Vec<u8>>(row, 1)?),
        public_key: hex::encode(get::<Vec<u8>>(row, 2)?),
        arrived_since: 0,
        open: 0,
    })
}

async fn with_arrivals(readers: &SqlitePool, mut found: StoredRevocation) -> Result<StoredRevocation, StoreError> {
    for writer in &found.receipt.writers {
        for range in &writer.in_flight {
            let row = sqlx::query(
                "SELECT count(*) FILTER (WHERE receipted_at IS NOT NULL), count(*) FILTER (WHERE state = 'SENT') \
                 FROM report WHERE writer_id = ? AND epoch = ? AND sequence BETWEEN ? AND ?",
            )
            .bind(i64::from(writer.data_set_writer_id))
            .bind(i64::from(writer.epoch))
            .bind(i64::from(range.first_sequence))
            .bind(i64::from(range.last_sequence))
            .fetch_one(readers)
            .await
            .map_err(StoreError::while_doing("read the spool"))?;
            let count = |column| row.try_get::<u32, _>(column).map_err(StoreError::while_doing("read a column"));
            found.arrived_since += count(0)?;
            found.open += count(1)?;
        }
    }
    Ok(found)
}
