//! What retention removes. The chains stay provable: emptied values leave their hashes, removed entries leave a signed
//! anchor.

use asi_model::{DateTime, FactoryId, OrganisationId};
use sqlx::{Connection as _, Row as _, SqliteConnection};

use super::{
    Store, StoreError,
    load::{get, unsigned},
    rows::id_list,
};
use crate::ledger::{Anchor, LedgerKey};

/// Reports whose values are emptied in one round.
const VALUES_PER_ROUND: i64 = 2000;
/// Entries of a chain that are removed in one round.
const ENTRIES_PER_ROUND: i64 = 2000;

impl Store {
    /// Empties the values of reports that are done with and were made before a time, after the one with this number.
    /// Returns the number of the last one looked at; none when there are no more.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn empty_values(&mut self, before: DateTime, after: i64) -> Result<Option<i64>, StoreError> {
        let rows = sqlx::query(
            "SELECT id FROM report WHERE id > ? AND created_at < ? AND state = 'DONE' AND body IS NOT NULL \
             ORDER BY id LIMIT ?",
        )
        .bind(after)
        .bind(before.unix_micros())
        .bind(VALUES_PER_ROUND)
        .fetch_all(&mut self.writer)
        .await
        .map_err(StoreError::while_doing("look for old values"))?;
        let ids: Vec<i64> = rows.iter().map(|row| get(row, 0)).collect::<Result<_, _>>()?;
        if ids.is_empty() {
            return Ok(None);
        }
        sqlx::query("UPDATE report SET body = NULL, salt = NULL WHERE id IN (SELECT value FROM json_each(?))")
            .bind(id_list(&ids))
            .execute(&mut self.writer)
            .await
            .map_err(StoreError::while_doing("empty old values"))?;
        Ok(ids.last().copied())
    }

    /// Removes the oldest entries of each chain that were recorded before a time, with the reports that no chain speaks
    /// of any more, and puts signed anchors in their place. What the spool still works with stays. Returns how many
    /// entries were removed.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be written; then nothing was removed.
    pub async fn prune_ledger(
        &mut self,
        before: DateTime,
        factory: &FactoryId,
        key: &LedgerKey,
        now: DateTime,
    ) -> Result<u64, StoreError> {
        let action = "remove old entries";
        let begin = self.writer.begin_with("BEGIN IMMEDIATE").await;
        let mut transaction = begin.map_err(StoreError::while_doing("begin a transaction"))?;
        let oldest_open: Option<i64> =
            sqlx::query_scalar("SELECT min(created_at) FROM report WHERE state IN ('WAITING', 'SENT', 'PARKED')")
                .fetch_one(&mut *transaction)
                .await
                .map_err(StoreError::while_doing(action))?;
        let before = before.unix_micros().min(oldest_open.unwrap_or(i64::MAX));
        let mut removed = 0;
        for recipient in super::ledger_recipients(&mut transaction).await? {
            removed += prune_chain(&mut transaction, &recipient, before, factory, key, now).await?;
        }
        transaction.commit().await.map_err(StoreError::while_doing("commit a transaction"))?;
        Ok(removed)
    }
}

async fn prune_chain(
    connection: &mut SqliteConnection,
    recipient: &str,
    before: i64,
    factory: &FactoryId,
    key: &LedgerKey,
    now: DateTime,
) -> Result<u64, StoreError> {
    let action = "remove old entries";
    let rows = sqlx::query(
        "SELECT number, recorded_at, hash, report_id FROM ledger_entry WHERE recipient = ? ORDER BY number LIMIT ?",
    )
    .bind(recipient)
    .bind(ENTRIES_PER_ROUND)
    .fetch_all(&mut *connection)
    .await
    .map_err(StoreError::while_doing(action))?;
    let mut last: Option<(i64, i64, Vec<u8>)> = None;
    let mut reports: Vec<i64> = Vec::new();
    let mut count = 0;
    for row in &rows {
        let recorded_at: i64 = get(row, 1)?;
        if recorded_at >= before {
            break;
        }
        last = Some((get(row, 0)?, recorded_at, get(row, 2)?));
        reports.extend(row.try_get::<Option<i64>, _>(3).map_err(StoreError::while_doing("read a column"))?);
        count += 1;
    }
    let Some((number, recorded_at, hash)) = last else { return Ok(0) };
    let anchor = Anchor {
        factory_id: factory.clone(),
        recipient: recipient.parse::<OrganisationId>().map_err(StoreError::unreadable("identifier"))?,
        number: unsigned(number),
        hash: hex::encode(hash),
        last_entry_at: DateTime::from_unix_micros(recorded_at),
        // As it is stored beside the text.
        recorded_at: DateTime::from_unix_micros(now.unix_micros()),
    };
    let content = anchor.canonical();
    sqlx::query(
        "INSERT INTO ledger_anchor (recipient, recorded_at, content, signature, public_key) VALUES (?, ?, ?, ?, ?) \
         ON CONFLICT (recipient) DO UPDATE SET recorded_at = excluded.recorded_at, content = excluded.content, \
         signature = excluded.signature, public_key = excluded.public_key",
    )
    .bind(recipient)
    .bind(now.unix_micros())
    .bind(content.clone())
    .bind(key.sign(&content).to_vec())
    .bind(key.public().to_vec())
    .execute(&mut *connection)
    .await
    .map_err(StoreError::while_doing("anchor a chain"))?;
    sqlx::query("DELETE FROM ledger_entry WHERE recipient = ? AND number <= ?")
        .bind(recipient)
        .bind(number)
        .execute(&mut *connection)
        .await
        .map_err(StoreError::while_doing(action))?;
    sqlx::query(
        "DELETE FROM report WHERE id IN (SELECT value FROM json_each(?)) AND state = 'DONE' \
         AND NOT EXISTS (SELECT 1 FROM ledger_entry e WHERE e.report_id = report.id)",
    )
    .bind(id_list(&reports))
    .execute(connection)
    .await
    .map_err(StoreError::while_doing("remove old reports"))?;
    Ok(count)
}
