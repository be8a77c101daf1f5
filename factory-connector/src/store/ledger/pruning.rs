//! Removal of old entries. A chain stays provable: a signed anchor stands for what was removed.

use asi_model::{DateTime, FactoryId};
use ledger::{Anchor, Hash, LedgerKey};
use rusqlite::Connection;
use transparency_log::leaf_hash;

use super::{anchors, logs};
use crate::store::{error::StoreError, reports, statement::run};

/// Entries of a chain that are removed in one round. The coordinator serves nothing else meanwhile.
const ENTRIES_PER_ROUND: i64 = 2000;
const PRUNE: &str = "remove old entries";

/// An entry that is old enough.
struct OldEntry {
    number: i64,
    recorded_at: i64,
    hash: Vec<u8>,
    /// Hash of the entry in its log.
    leaf: Hash,
    report_id: Option<i64>,
}

/// Removes the oldest entries of each chain that were recorded before a time, with the reports that
/// no chain refers to any more. Entries about reports that the spool works with stay. Returns the
/// number of removed entries.
pub(in crate::store) fn prune(
    connection: &Connection,
    before: DateTime,
    factory: &FactoryId,
    key: &LedgerKey,
    now: DateTime,
) -> Result<u64, StoreError> {
    let recipients = recipients(connection).map_err(StoreError::while_writing(PRUNE))?;
    let oldest = reports::oldest_in_spool(connection).map_err(StoreError::while_writing(PRUNE))?;
    let before = before.unix_micros().min(oldest.unwrap_or(i64::MAX));
    let mut removed = 0;
    for recipient in &recipients {
        let entries = oldest_entries(connection, recipient, before)
            .map_err(StoreError::while_writing(PRUNE))?;
        let Some(last) = entries.last() else { continue };
        let mut leaves = logs::leaves_before(connection, recipient)?;
        entries.iter().for_each(|entry| leaves.append(entry.leaf));
        let anchor = Anchor {
            factory_id: factory.clone(),
            recipient: recipient.parse().map_err(StoreError::unreadable("recipient"))?,
            number: last.number.unsigned_abs(),
            hash: hex::encode(&last.hash),
            leaves: leaves.hashes().iter().map(hex::encode).collect(),
            last_entry_at: DateTime::from_unix_micros(last.recorded_at),
            // As it is stored beside the text, which has microseconds only.
            recorded_at: DateTime::from_unix_micros(now.unix_micros()),
        };
        // In the transaction of the removal: a chain that begins late without an anchor counts as
        // cut.
        anchors::write(connection, &anchor, key)
            .map_err(StoreError::while_writing("anchor a chain"))?;
        remove(connection, recipient, &entries).map_err(StoreError::while_writing(PRUNE))?;
        removed += entries.len() as u64;
    }
    Ok(removed)
}

fn recipients(connection: &Connection) -> rusqlite::Result<Vec<String>> {
    connection
        .prepare_cached("SELECT recipient FROM ledger_head ORDER BY recipient")?
        .query_map((), |row| row.get("recipient"))?
        .collect()
}

/// Reads the oldest entries of a chain, up to the first that is not old enough.
fn oldest_entries(
    connection: &Connection,
    recipient: &str,
    before: i64,
) -> rusqlite::Result<Vec<OldEntry>> {
    let mut statement = connection.prepare_cached(
        "SELECT number, recorded_at, content, hash, report_id FROM ledger_entry
         WHERE recipient = ? ORDER BY number LIMIT ?",
    )?;
    let mut rows = statement.query((recipient, ENTRIES_PER_ROUND))?;
    let mut entries = Vec::new();
    while let Some(row) = rows.next()? {
        let entry = OldEntry {
            number: row.get("number")?,
            recorded_at: row.get("recorded_at")?,
            hash: row.get("hash")?,
            leaf: leaf_hash(row.get_ref("content")?.as_bytes()?),
            report_id: row.get("report_id")?,
        };
        if entry.recorded_at >= before {
            break;
        }
        entries.push(entry);
    }
    Ok(entries)
}

/// Removes these entries, the oldest of their chain, and the reports that only they refer to.
fn remove(connection: &Connection, recipient: &str, entries: &[OldEntry]) -> rusqlite::Result<()> {
    let Some(last) = entries.last() else { return Ok(()) };
    run(
        connection,
        "DELETE FROM ledger_entry WHERE recipient = ? AND number <= ?",
        (recipient, last.number),
    )?;
    let reports: Vec<i64> = entries.iter().filter_map(|entry| entry.report_id).collect();
    reports::remove_unreferenced(connection, &reports)
}
