//! Receipts of ended consents, and what became of reports that were on their way then.

use sqlx::{Row as _, SqlitePool, sqlite::SqliteRow};

use super::{StoreError, load::get};
use ledger::RevocationReceipt;

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
    /// Reports that were on their way when the consent ended, of which the platform has said since
    /// that it holds them.
    pub arrived_since: u32,
    /// Reports of which it is still not known whether they arrived.
    pub open: u32,
}

const COLUMNS: &str = "SELECT content, signature, public_key, revoked_at FROM revocation";

/// Receipts, newest first, before another one. Several may have the same time.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn revocations(
    readers: &SqlitePool,
    before: Option<&str>,
    limit: u32,
) -> Result<Vec<StoredRevocation>, StoreError> {
    let rows = sqlx::query(
        "SELECT content, signature, public_key, revoked_at FROM revocation WHERE ?1 IS NULL OR \
         (revoked_at, revocation_id) < (SELECT revoked_at, revocation_id FROM revocation WHERE revocation_id = ?1) \
         ORDER BY revoked_at DESC, revocation_id DESC LIMIT ?2",
    )
    .bind(before.map(str::to_owned))
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
pub async fn revocation_by_id(
    readers: &SqlitePool,
    id: &str,
) -> Result<Option<StoredRevocation>, StoreError> {
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
        receipt: serde_json::from_str(&signed_text)
            .map_err(StoreError::unreadable("revocation"))?,
        signed_text,
        signature: hex::encode(get::<Vec<u8>>(row, 1)?),
        public_key: hex::encode(get::<Vec<u8>>(row, 2)?),
        arrived_since: 0,
        open: 0,
    })
}

async fn with_arrivals(
    readers: &SqlitePool,
    mut found: StoredRevocation,
) -> Result<StoredRevocation, StoreError> {
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
            let count = |column| {
                row.try_get::<u32, _>(column).map_err(StoreError::while_doing("read a column"))
            };
            found.arrived_since += count(0)?;
            found.open += count(1)?;
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use asi_model::{DateTime, messages::GapCause};

    use super::*;
    use crate::store::Store;

    #[tokio::test]
    async fn receipts_of_one_moment_are_each_on_one_page() {
        let folder = tempfile::tempdir().expect("a folder");
        let factory_id = "F".parse().expect("an id");
        let now = DateTime::from_unix_micros(1_000_000);
        let mut store = Store::open(folder.path(), &factory_id, now).await.expect("a store");
        for number in 0..7_i64 {
            let receipt = RevocationReceipt {
                revocation_id: format!("id-{number}"),
                factory_id: factory_id.clone(),
                revoked_at: now,
                revoked_by: None,
                reason: None,
                cause: GapCause::Withdrawn,
                fields: Vec::new(),
                writers: Vec::new(),
            };
            sqlx::query("INSERT INTO revocation VALUES (?, ?, ?, x'00', x'00')")
                .bind(receipt.revocation_id.clone())
                .bind(number / 5)
                .bind(receipt.canonical())
                .execute(&mut store.reader)
                .await
                .expect("stored");
        }
        let readers = store.readers();
        let (mut seen, mut last) = (Vec::new(), None::<String>);
        loop {
            let page = revocations(&readers, last.as_deref(), 2).await.expect("read");
            seen.extend(page.iter().map(|found| found.receipt.revocation_id.clone()));
            last = page.last().map(|found| found.receipt.revocation_id.clone());
            if last.is_none() {
                break;
            }
        }
        assert_eq!(seen, ["id-6", "id-5", "id-4", "id-3", "id-2", "id-1", "id-0"]);
    }
}
