//! Logs of the chains: as many hashes as are needed to append, with the last checkpoint.

use asi_model::{FactoryId, OrganisationId};
use ledger::{Anchor, Head, Heads, Log, LogStart, Logs};
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};
use transparency_log::{Checkpoint, LeafRange, SignedNote};

use crate::store::{
    error::StoreError,
    query::{all, optional, query},
    row::{Columns as _, signed},
    statement::write_rows,
};

/// Entries read at once where a log is computed.
const BLOCK: i64 = 4000;
const READ: &str = "read the ledger's logs";

/// Reads the logs of all chains up to these heads.
pub(super) async fn load(
    connection: &mut SqliteConnection,
    heads: &Heads,
) -> Result<Logs, StoreError> {
    let mut logs = Logs::default();
    let identity = query("SELECT factory_id FROM identity");
    let Some(factory) =
        optional(connection, identity, READ, |row| row.parsed::<FactoryId>("factory_id")).await?
    else {
        return Ok(logs);
    };
    for (recipient, head) in heads.iter() {
        let sql = "SELECT start, size, leaves, checkpoint FROM ledger_log
                   WHERE recipient = ? AND start <> ''";
        let stored = query(sql).bind(recipient.to_string());
        let mut log = match optional(connection, stored, READ, log).await? {
            Some(log) => log,
            None => {
                let anchor = anchor(connection, recipient).await?;
                Log::new(factory.clone(), recipient.clone(), &anchor)
            }
        };
        append_missing(connection, &mut log, recipient, head).await?;
        logs.insert(log);
    }
    Ok(logs)
}

/// Appends the entries that the log does not have yet: those of a chain of a former version.
async fn append_missing(
    connection: &mut SqliteConnection,
    log: &mut Log,
    recipient: &OrganisationId,
    head: &Head,
) -> Result<(), StoreError> {
    let after = log.last_number();
    if after < head.number {
        let mut take = |content: &str| log.append(content);
        let last = each_entry(connection, recipient, after, &mut take).await?;
        if last < head.number {
            tracing::error!(
                %recipient,
                "Entries of the ledger are missing; run `factory-connector ledger verify`."
            );
        }
    }
    Ok(())
}

/// Calls `take` with the text of each entry after a number of a chain, in order. Returns the last
/// number, that number where there is none.
pub(super) async fn each_entry(
    connection: &mut SqliteConnection,
    recipient: &OrganisationId,
    after: u64,
    take: &mut impl FnMut(&str),
) -> Result<u64, StoreError> {
    let mut last = after;
    loop {
        let sql = "SELECT number, content FROM ledger_entry WHERE recipient = ? AND number > ?
                   ORDER BY number LIMIT ?";
        let next = query(sql).bind(recipient.to_string()).bind(signed(last)).bind(BLOCK);
        let read = |row: &SqliteRow| Ok((row.number("number")?, row.column::<String>("content")?));
        let entries: Vec<(u64, String)> = all(connection, next, READ, read).await?;
        let Some((number, _)) = entries.last() else { return Ok(last) };
        last = *number;
        entries.iter().for_each(|(_, content)| take(content));
    }
}

/// Reads the anchor of a pruned chain; `None` of one that was not pruned.
pub(super) async fn stored_anchor(
    connection: &mut SqliteConnection,
    recipient: &OrganisationId,
) -> Result<Option<Anchor>, StoreError> {
    let sql = "SELECT content FROM ledger_anchor WHERE recipient = ?";
    let query = query(sql).bind(recipient.to_string());
    optional(connection, query, READ, |row| row.document("content")).await
}

/// Returns the entry after which a pruned chain begins; the beginning of one that was not pruned.
pub(super) async fn anchor(
    connection: &mut SqliteConnection,
    recipient: &OrganisationId,
) -> Result<Head, StoreError> {
    let Some(anchor) = stored_anchor(connection, recipient).await? else {
        return Ok(Head::default());
    };
    let hash = hex::decode(&anchor.hash).ok().and_then(|hash| hash.try_into().ok());
    let hash = hash.ok_or("a hash has 32 bytes").map_err(StoreError::unreadable("hash"))?;
    Ok(Head { number: anchor.number, hash })
}

fn log(row: &SqliteRow) -> Result<Log, StoreError> {
    let start: LogStart = row.document("start")?;
    let leaves: Vec<u8> = row.column("leaves")?;
    let leaves = LeafRange::from_bytes(0, row.number("size")?, &leaves)
        .filter(|leaves| leaves.end() > 0)
        .ok_or("the hashes are not those of its size")
        .map_err(StoreError::unreadable("leaves"))?;
    let note: String = row.column("checkpoint")?;
    let checkpoint = SignedNote::parse(&note)
        .ok()
        .and_then(|parsed| parsed.text().parse::<Checkpoint>().ok())
        .map(|checkpoint| (checkpoint.size, note));
    Ok(Log::stored(start, leaves, checkpoint))
}

/// Stores logs that grew or were signed.
pub(in crate::store) fn write(connection: &Connection, logs: &[Log]) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO ledger_log (recipient, start, size, root, leaves, checkpoint)
         VALUES (?, ?, ?, ?, ?, ?)
         ON CONFLICT (recipient) DO UPDATE SET
             start = excluded.start, size = excluded.size, root = excluded.root,
             leaves = excluded.leaves, checkpoint = excluded.checkpoint",
        logs,
        |log| {
            (
                log.start().recipient.as_str(),
                log.start().canonical(),
                signed(log.leaves().end()),
                log.leaves().root(),
                log.leaves().to_bytes(),
                log.checkpoint().unwrap_or_default(),
            )
        },
    )
}
