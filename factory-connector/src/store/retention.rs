//! What retention removes. The chains stay provable: emptied values leave their hashes, removed
//! entries leave a signed anchor.

use asi_model::{DateTime, FactoryId, OrganisationId};
use rusqlite::{Connection, Transaction};

use super::{
    Store, StoreError,
    load::unsigned,
    writer::{id_list, run},
};
use ledger::{Anchor, LedgerKey};

/// Reports whose values are emptied in one round.
const VALUES_PER_ROUND: i64 = 2000;
/// Entries of a chain that are removed in one round.
const ENTRIES_PER_ROUND: i64 = 2000;
const PRUNE: &str = "remove old entries";

impl Store {
    /// Empties the values of reports that are done with and were made before a time, after the one
    /// with this number. Returns the number of the last one looked at; none when there are no more.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn empty_values(
        &mut self,
        before: DateTime,
        after: i64,
    ) -> Result<Option<i64>, StoreError> {
        let action = "empty old values";
        let work = move |connection: &Transaction<'_>| {
            empty_values(connection, before, after).map_err(StoreError::while_writing(action))
        };
        self.writer.transact(action, work).await
    }

    /// Removes the oldest entries of each chain that were recorded before a time, with the reports
    /// that no chain speaks of any more, and puts signed anchors in their place. What the spool
    /// still works with stays. Returns how many entries were removed.
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
        let (factory, key) = (factory.clone(), key.clone());
        let work = move |connection: &Transaction<'_>| {
            let recipients =
                recipients_and_oldest(connection, before).map_err(StoreError::while_writing(PRUNE));
            let (recipients, before) = recipients?;
            recipients
                .iter()
                .map(|recipient| prune_chain(connection, recipient, before, &factory, &key, now))
                .sum()
        };
        self.writer.transact(PRUNE, work).await
    }
}

fn empty_values(
    connection: &Connection,
    before: DateTime,
    after: i64,
) -> rusqlite::Result<Option<i64>> {
    let ids: Vec<i64> = connection
        .prepare_cached(
            "SELECT id FROM report WHERE id > ? AND created_at < ? AND state = 'DONE' AND body IS NOT NULL \
             ORDER BY id LIMIT ?",
        )?
        .query_map((after, before.unix_micros(), VALUES_PER_ROUND), |row| row.get(0))?
        .collect::<Result<_, _>>()?;
    if !ids.is_empty() {
        let statement = "UPDATE report SET body = NULL, salt = NULL WHERE id IN (SELECT value FROM json_each(?))";
        run(connection, statement, (id_list(&ids),))?;
    }
    Ok(ids.last().copied())
}

/// The chains, and the time before which nothing is still worked with.
fn recipients_and_oldest(
    connection: &Connection,
    before: DateTime,
) -> rusqlite::Result<(Vec<String>, i64)> {
    let oldest = "SELECT min(created_at) FROM report WHERE state IN ('WAITING', 'SENT', 'PARKED')";
    let oldest_open: Option<i64> =
        connection.prepare_cached(oldest)?.query_row((), |row| row.get(0))?;
    let mut recipients =
        connection.prepare_cached("SELECT recipient FROM ledger_head ORDER BY recipient")?;
    let recipients = recipients.query_map((), |row| row.get(0))?.collect::<Result<_, _>>()?;
    Ok((recipients, before.unix_micros().min(oldest_open.unwrap_or(i64::MAX))))
}

fn prune_chain(
    connection: &Connection,
    recipient: &str,
    before: i64,
    factory: &FactoryId,
    key: &LedgerKey,
    now: DateTime,
) -> Result<u64, StoreError> {
    let entries =
        oldest_entries(connection, recipient, before).map_err(StoreError::while_writing(PRUNE))?;
    let Some((number, recorded_at, hash, _)) = entries.last() else { return Ok(0) };
    let anchor = Anchor {
        factory_id: factory.clone(),
        recipient: recipient
            .parse::<OrganisationId>()
            .map_err(StoreError::unreadable("identifier"))?,
        number: unsigned(*number),
        hash: hex::encode(hash),
        last_entry_at: DateTime::from_unix_micros(*recorded_at),
        // As it is stored beside the text.
        recorded_at: DateTime::from_unix_micros(now.unix_micros()),
    };
    let content = anchor.canonical();
    run(
        connection,
        "INSERT INTO ledger_anchor (recipient, recorded_at, content, signature, public_key) VALUES (?, ?, ?, ?, ?) \
         ON CONFLICT (recipient) DO UPDATE SET recorded_at = excluded.recorded_at, content = excluded.content, \
         signature = excluded.signature, public_key = excluded.public_key",
        (recipient, now.unix_micros(), &content, key.sign(&content), key.public()),
    )
    .map_err(StoreError::while_writing("anchor a chain"))?;
    run(
        connection,
        "DELETE FROM ledger_entry WHERE recipient = ? AND number <= ?",
        (recipient, number),
    )
    .map_err(StoreError::while_writing(PRUNE))?;
    let reports: Vec<i64> = entries.iter().filter_map(|(.., report)| *report).collect();
    run(
        connection,
        "DELETE FROM report WHERE id IN (SELECT value FROM json_each(?)) AND state = 'DONE' \
         AND NOT EXISTS (SELECT 1 FROM ledger_entry e WHERE e.report_id = report.id)",
        (id_list(&reports),),
    )
    .map_err(StoreError::while_writing("remove old reports"))?;
    Ok(entries.len() as u64)
}

/// Number, time, hash and report.
type OldEntry = (i64, i64, Vec<u8>, Option<i64>);

/// The oldest entries of a chain, up to the first that is not old enough.
fn oldest_entries(
    connection: &Connection,
    recipient: &str,
    before: i64,
) -> rusqlite::Result<Vec<OldEntry>> {
    let mut statement = connection.prepare_cached(
        "SELECT number, recorded_at, hash, report_id FROM ledger_entry WHERE recipient = ? ORDER BY number LIMIT ?",
    )?;
    let mut rows = statement.query((recipient, ENTRIES_PER_ROUND))?;
    let mut entries = Vec::new();
    while let Some(row) = rows.next()? {
        let recorded_at: i64 = row.get(1)?;
        if recorded_at >= before {
            break;
        }
        entries.push((row.get(0)?, recorded_at, row.get(2)?, row.get(3)?));
    }
    Ok(entries)
}
