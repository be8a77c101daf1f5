//! Logs as far as the platform has countersigned them: as many hashes as are needed to prove later
//! checkpoints, with the last countersigned one.

use asi_model::OrganisationId;
use ledger::{CosignedCheckpoint, Log, LogConflict, LogStart, Logs, Witnessing};
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};
use transparency_log::{LeafRange, leaf_hash};

use super::logs::each_entry;
use crate::store::{
    error::StoreError,
    query::{optional, query},
    row::{Columns as _, document, signed},
    statement::write_rows,
};

const READ: &str = "read what was countersigned of the ledger";

/// A row: size and leaves, the checkpoint, the conflict.
type Row = (LeafRange, Option<CosignedCheckpoint>, Option<LogConflict>);

/// Adds to logs what was countersigned of them.
pub(super) async fn add(connection: &mut SqliteConnection, logs: Logs) -> Result<Logs, StoreError> {
    let mut witnessed = Logs::default();
    for log in logs.iter() {
        let witnessing = load(connection, log).await?;
        witnessed.insert(log.clone().with(witnessing));
    }
    Ok(witnessed)
}

/// Reads what was countersigned of a log.
async fn load(connection: &mut SqliteConnection, log: &Log) -> Result<Witnessing, StoreError> {
    let sql = "SELECT size, leaves, checkpoint, witness_key, cosigned_at, conflict
               FROM ledger_witness WHERE recipient = ? AND origin = ?";
    let recipient = &log.start().recipient;
    let stored = query(sql).bind(recipient.to_string()).bind(log.start().origin());
    let nothing = || Witnessing::new(log.leaves().clone());
    let Some((witnessed, cosigned, conflict)) = optional(connection, stored, READ, row).await?
    else {
        return Ok(nothing());
    };
    let size = witnessed.end();
    let since = if size == 0 {
        log.leaves().clone()
    } else {
        let mut since = LeafRange::starting_at(size);
        let mut take = |content: &str| since.append(leaf_hash(content.as_bytes()));
        // The first leaf is no entry.
        let number = log.start().number + size - 1;
        each_entry(connection, recipient, number, &mut take).await?;
        since
    };
    // Where entries are missing, the platform is asked for what it holds.
    let (witnessed, since) = if since.end() == log.leaves().end() {
        (witnessed, since)
    } else {
        (LeafRange::starting_at(0), log.leaves().clone())
    };
    Ok(Witnessing::stored(witnessed, since, cosigned, conflict).unwrap_or_else(nothing))
}

fn row(row: &SqliteRow) -> Result<Row, StoreError> {
    let leaves: Vec<u8> = row.column("leaves")?;
    let witnessed = LeafRange::from_bytes(0, row.number("size")?, &leaves)
        .ok_or("the hashes are not those of its size")
        .map_err(StoreError::unreadable("leaves"))?;
    let note: String = row.column("checkpoint")?;
    let cosigned = if note.is_empty() {
        None
    } else {
        let (witness_key, cosigned_at) = (row.column("witness_key")?, row.time("cosigned_at")?);
        Some(CosignedCheckpoint { note, witness_key, cosigned_at })
    };
    Ok((witnessed, cosigned, row.document_option("conflict")?))
}

/// Returns the number of the last entry that the platform has countersigned in the present log of a
/// chain; `None` where it has countersigned nothing of it.
pub(super) async fn last_number(
    connection: &mut SqliteConnection,
    recipient: &OrganisationId,
) -> Result<Option<u64>, StoreError> {
    let sql = "SELECT l.start, w.origin, w.size FROM ledger_log l
               JOIN ledger_witness w ON w.recipient = l.recipient
               WHERE l.recipient = ? AND w.size > 0 AND l.start <> ''";
    let read = |row: &SqliteRow| {
        let start: LogStart = row.document("start")?;
        Ok((start, row.column::<String>("origin")?, row.number("size")?))
    };
    let stored = query(sql).bind(recipient.to_string());
    let row: Option<(LogStart, String, u64)> = optional(connection, stored, READ, read).await?;
    let Some((start, origin, size)) = row else { return Ok(None) };
    // The first leaf is no entry.
    let last = start.number + size - 1;
    Ok((start.origin() == origin).then_some(last))
}

/// Stores logs of which more was countersigned, or about which there is a conflict.
pub(in crate::store) fn write(connection: &Connection, logs: &[Log]) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO ledger_witness
             (recipient, origin, size, leaves, checkpoint, witness_key, cosigned_at, conflict)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?)
         ON CONFLICT (recipient) DO UPDATE SET
             origin = excluded.origin, size = excluded.size, leaves = excluded.leaves,
             checkpoint = excluded.checkpoint, witness_key = excluded.witness_key,
             cosigned_at = excluded.cosigned_at, conflict = excluded.conflict",
        logs,
        |log| {
            let witnessing = log.witnessing();
            let cosigned = witnessing.cosigned();
            (
                log.start().recipient.as_str(),
                log.start().origin(),
                signed(witnessing.witnessed().end()),
                witnessing.witnessed().to_bytes(),
                cosigned.map_or("", |cosigned| &cosigned.note),
                cosigned.map_or("", |cosigned| &cosigned.witness_key),
                cosigned.map_or(0, |cosigned| cosigned.cosigned_at.unix_micros()),
                witnessing.conflict().map(document),
            )
        },
    )
}
