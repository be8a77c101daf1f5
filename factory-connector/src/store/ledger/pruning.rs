//! Removal of old entries. A chain stays provable: a signed anchor stands for what was removed.

use asi_model::{DateTime, OrganisationId};
use connector_state::use_cases::retain::OldEntries;
use ledger::Hash;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};
use transparency_log::leaf_hash;

use super::{anchors, audit, heads, logs, witnessed};
use crate::store::{
    RemovedEntries,
    error::StoreError,
    query::{all, query},
    reports,
    row::{Columns as _, signed},
    statement::run,
};

/// Entries of a chain that are removed in one round. The coordinator serves nothing else meanwhile.
const ENTRIES_PER_ROUND: i64 = 2000;
const READ: &str = "read old entries";

/// An entry of a chain.
struct PrunedEntry {
    number: u64,
    recorded_at: DateTime,
    hash: Hash,
    /// Hash of the entry in its log.
    leaf: Hash,
    report_id: Option<i64>,
}

/// Reads the oldest entries of each chain that were recorded before a time, up to the first that is
/// not old enough. Entries about reports that the spool works with are not among them, nor those
/// that the platform has yet to countersign, once it does.
pub(super) async fn old_entries(
    connection: &mut SqliteConnection,
    before: DateTime,
) -> Result<Vec<OldEntries>, StoreError> {
    let before = match reports::oldest_in_spool(connection).await? {
        Some(oldest) => before.min(oldest),
        None => before,
    };
    let mut chains = Vec::new();
    for recipient in heads::recipients(connection).await? {
        let recipient: OrganisationId =
            recipient.parse().map_err(StoreError::unreadable("recipient"))?;
        let sql = "SELECT number, recorded_at, content, hash, report_id FROM ledger_entry
                   WHERE recipient = ? ORDER BY number LIMIT ?";
        let query = query(sql).bind(recipient.to_string()).bind(ENTRIES_PER_ROUND);
        let mut entries = all(connection, query, READ, entry).await?;
        let count = entries.iter().take_while(|entry| entry.recorded_at < before).count();
        entries.truncate(count);
        // The proof of the next checkpoint needs the entries since the last countersigned one.
        if let Some(last) = witnessed::last_number(connection, &recipient).await? {
            entries.retain(|entry| entry.number <= last);
        }
        let Some(last) = entries.last() else { continue };
        // Entries about reports tell times on a time step, and so not always in their order.
        let newest = entries.iter().map(|entry| entry.recorded_at).max();
        let former = logs::stored_anchor(connection, &recipient).await?;
        let newest = newest.max(former.map(|anchor| anchor.last_entry_at));
        let last = (last.number, last.hash, newest.unwrap_or(last.recorded_at));
        let Some((_, mut leaves)) = audit::leaves_before(connection, &recipient).await? else {
            continue;
        };
        entries.iter().for_each(|entry| leaves.append(entry.leaf));
        chains.push(OldEntries {
            recipient,
            last,
            leaves: leaves.hashes().to_vec(),
            reports: entries.iter().filter_map(|entry| entry.report_id).collect(),
        });
    }
    Ok(chains)
}

fn entry(row: &SqliteRow) -> Result<PrunedEntry, StoreError> {
    let hash = row.column::<Vec<u8>>("hash")?.try_into();
    Ok(PrunedEntry {
        number: row.number("number")?,
        recorded_at: row.time("recorded_at")?,
        hash: hash.map_err(|_| "a hash has 32 bytes").map_err(StoreError::unreadable("hash"))?,
        leaf: leaf_hash(row.column::<String>("content")?.as_bytes()),
        report_id: row.column("report_id")?,
    })
}

/// Removes the oldest entries of chains, puts anchors in their place, and removes the reports that
/// no chain refers to any more.
pub(in crate::store) fn remove(
    connection: &Connection,
    removed: &[RemovedEntries],
) -> rusqlite::Result<()> {
    for RemovedEntries { anchor, reports } in removed {
        anchors::write(connection, anchor)?;
        run(
            connection,
            "DELETE FROM ledger_entry WHERE recipient = ? AND number <= ?",
            (anchor.recipient.as_str(), signed(anchor.number)),
        )?;
        reports::remove_unreferenced(connection, reports)?;
    }
    Ok(())
}
