//! Receipts of ended consents: signed statements, and the later arrivals of reports that were on
//! their way.

use ledger::RevocationReceipt;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    RevocationRow,
    error::StoreError,
    query::{all, one, optional, query},
    row::Columns as _,
    statement::write_rows,
};

/// A receipt with its signature, and the arrivals since of reports that were on their way.
#[derive(Debug, Clone, PartialEq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct StoredRevocation {
    /// The receipt as it was signed.
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

/// Columns of [`StoredRevocation`].
const COLUMNS: &str = "content, signature, public_key";
const READ: &str = "read the revocations";

/// Repository of revocations.
pub struct Revocations<'c>(pub(super) &'c mut SqliteConnection);

impl Revocations<'_> {
    /// Reads receipts older than the one with the id `before`, newest first. Several may have the
    /// same time.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn page(
        &mut self,
        before: Option<&str>,
        limit: u32,
    ) -> Result<Vec<StoredRevocation>, StoreError> {
        let sql = format!(
            "SELECT {COLUMNS} FROM revocation
             WHERE ?1 IS NULL OR (revoked_at, revocation_id) <
                 (SELECT revoked_at, revocation_id FROM revocation WHERE revocation_id = ?1)
             ORDER BY revoked_at DESC, revocation_id DESC LIMIT ?2"
        );
        let query = query(sql).bind(before).bind(i64::from(limit));
        let mut found = all(self.0, query, READ, revocation).await?;
        for revocation in &mut found {
            self.count_arrivals(revocation).await?;
        }
        Ok(found)
    }

    /// Looks one up by its id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(&mut self, id: &str) -> Result<Option<StoredRevocation>, StoreError> {
        let sql = format!("SELECT {COLUMNS} FROM revocation WHERE revocation_id = ?");
        let found = optional(self.0, query(sql).bind(id), READ, revocation).await?;
        let Some(mut found) = found else { return Ok(None) };
        self.count_arrivals(&mut found).await?;
        Ok(Some(found))
    }

    async fn count_arrivals(&mut self, found: &mut StoredRevocation) -> Result<(), StoreError> {
        let sql = "SELECT count(*) FILTER (WHERE receipted_at IS NOT NULL) AS arrived,
                       count(*) FILTER (WHERE state = 'SENT') AS open
                   FROM report WHERE writer_id = ? AND epoch = ? AND sequence BETWEEN ? AND ?";
        for writer in &found.receipt.writers {
            for range in &writer.in_flight {
                let query = query(sql)
                    .bind(i64::from(writer.data_set_writer_id))
                    .bind(i64::from(writer.epoch))
                    .bind(i64::from(range.first_sequence))
                    .bind(i64::from(range.last_sequence));
                let counted = one(self.0, query, "read the spool", |row| {
                    Ok((row.number::<u32>("arrived")?, row.number::<u32>("open")?))
                });
                let (arrived, open) = counted.await?;
                found.arrived_since += arrived;
                found.open += open;
            }
        }
        Ok(())
    }
}

fn revocation(row: &SqliteRow) -> Result<StoredRevocation, StoreError> {
    Ok(StoredRevocation {
        receipt: row.document("content")?,
        signed_text: row.column("content")?,
        signature: hex::encode(row.column::<Vec<u8>>("signature")?),
        public_key: hex::encode(row.column::<Vec<u8>>("public_key")?),
        arrived_since: 0,
        open: 0,
    })
}

pub(super) fn write(
    connection: &Connection,
    revocations: &[RevocationRow],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO revocation (revocation_id, revoked_at, content, signature, public_key)
         VALUES (?, ?, ?, ?, ?)",
        revocations,
        |row| {
            (
                &row.revocation_id,
                row.revoked_at.unix_micros(),
                &row.content,
                &row.signature,
                &row.public_key,
            )
        },
    )
}

#[cfg(test)]
mod tests {
    use asi_model::{DateTime, FactoryId, messages::GapCause};

    use super::*;
    use crate::store::Store;

    #[tokio::test]
    async fn receipts_of_one_moment_are_each_on_one_page() {
        let folder = tempfile::tempdir().expect("a folder");
        let factory_id: FactoryId = "F".parse().expect("an id");
        let now = DateTime::from_unix_micros(1_000_000);
        let mut session = Store::connect(folder.path()).await.expect("a store");
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
                .execute(session.connection())
                .await
                .expect("stored");
        }
        let (mut seen, mut last) = (Vec::new(), None::<String>);
        loop {
            let page = session.revocations().page(last.as_deref(), 2).await.expect("read");
            seen.extend(page.iter().map(|found| found.receipt.revocation_id.clone()));
            last = page.last().map(|found| found.receipt.revocation_id.clone());
            if last.is_none() {
                break;
            }
        }
        assert_eq!(seen, ["id-6", "id-5", "id-4", "id-3", "id-2", "id-1", "id-0"]);
    }
}
