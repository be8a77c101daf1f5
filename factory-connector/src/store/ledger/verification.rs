//! Reading the whole ledger for its verification.
//!
//! Texts are read as bytes here: a damaged one is a finding, not a failure to read.

mod parallel;
mod reports;
mod surroundings;
mod trusted;

use std::collections::HashMap;

use ledger::{CheckedEntry, Hash, StoredEntry, Verification, Verifier};
use sqlx::{Connection as _, SqliteConnection, sqlite::SqliteRow};
use tokio::sync::mpsc;

pub use self::trusted::Trusted;
use self::{
    parallel::on_all_processors,
    reports::{Digests, NewReports, ReportReader},
    surroundings::surroundings,
};
use crate::store::{
    error::StoreError,
    query::{all, optional, query},
    row::Columns as _,
};

/// Entries read at once.
const BLOCK: i64 = 4000;
/// Blocks that may wait for their check: enough to read while all processors check, and a bound on
/// memory for a ledger of any length.
const BLOCKS_AHEAD: usize = 2;
const READ: &str = "read the ledger";

/// Position of the reading in a chain.
struct ChainPosition {
    recipient: Vec<u8>,
    /// The least number that the next entry may have; `None` at the end.
    next: Option<i64>,
    /// The last report that was referred to.
    report: i64,
}

/// Some entries of one chain, with the reports that no block before had.
struct Block {
    recipient: Vec<u8>,
    entries: Vec<StoredEntry>,
    reports: NewReports,
}

/// Reads every chain from its beginning and checks it on all processors.
pub(super) async fn verify(
    connection: &mut SqliteConnection,
    against: Trusted,
) -> Result<Verification, StoreError> {
    // One view of everything, while the connector goes on writing.
    let mut view = connection.begin().await.map_err(StoreError::while_doing(READ))?;
    let verifier = Verifier::new(surroundings(&mut view, against).await?);
    let (blocks, arriving) = mpsc::channel(BLOCKS_AHEAD);
    let checking = tokio::task::spawn_blocking(move || check(verifier, arriving));
    let read = read(&mut view, &blocks).await;
    drop(blocks);
    let outcome = checking.await.map_err(|error| StoreError::Unreadable {
        what: "ledger",
        reason: format!("the verification stopped: {error}"),
    });
    read.and(outcome)
}

/// Reads all chains side by side: a report goes to several recipients at about the same time, and
/// is read once for all.
async fn read(
    connection: &mut SqliteConnection,
    blocks: &mpsc::Sender<Block>,
) -> Result<(), StoreError> {
    let mut chains = chains(connection).await?;
    let mut report_reader = ReportReader::default();
    while let Some(chain) =
        chains.iter_mut().filter(|chain| chain.next.is_some()).min_by_key(|chain| chain.report)
    {
        let entries = entries(connection, chain).await?;
        let Some(last) = entries.last() else {
            chain.next = None;
            continue;
        };
        chain.next = last.number.checked_add(1);
        let referred: Vec<i64> = entries.iter().filter_map(|entry| entry.report_id).collect();
        chain.report = referred.iter().copied().fold(chain.report, i64::max);
        let recipient = chain.recipient.clone();
        let behind =
            chains.iter().filter(|chain| chain.next.is_some()).map(|chain| chain.report).min();
        let reports = report_reader.read(connection, &referred, behind).await?;
        if blocks.send(Block { recipient, entries, reports }).await.is_err() {
            break;
        }
    }
    Ok(())
}

async fn chains(connection: &mut SqliteConnection) -> Result<Vec<ChainPosition>, StoreError> {
    // From recipient to recipient by the primary key: a DISTINCT would read every entry, and so
    // would an order by the new name, which is that of the bytes.
    let sql = "SELECT CAST(recipient AS BLOB) AS recipient FROM ledger_entry
               WHERE ?1 IS NULL OR ledger_entry.recipient > CAST(?1 AS TEXT)
               ORDER BY ledger_entry.recipient LIMIT 1";
    let mut chains: Vec<ChainPosition> = Vec::new();
    loop {
        let query = query(sql).bind(chains.last().map(|chain| chain.recipient.clone()));
        let found = optional(connection, query, READ, |row| row.column("recipient")).await?;
        let Some(recipient) = found else { return Ok(chains) };
        chains.push(ChainPosition { recipient, next: Some(i64::MIN), report: i64::MIN });
    }
}

async fn entries(
    connection: &mut SqliteConnection,
    chain: &ChainPosition,
) -> Result<Vec<StoredEntry>, StoreError> {
    let sql = "SELECT number, recorded_at, report_id, CAST(content AS BLOB) AS content, hash
               FROM ledger_entry
               WHERE recipient = CAST(? AS TEXT) AND number >= ? ORDER BY number LIMIT ?";
    let query = query(sql).bind(chain.recipient.clone()).bind(chain.next).bind(BLOCK);
    all(connection, query, READ, entry).await
}

fn entry(row: &SqliteRow) -> Result<StoredEntry, StoreError> {
    Ok(StoredEntry {
        number: row.column("number")?,
        recorded_at: row.column("recorded_at")?,
        report_id: row.column("report_id")?,
        content: row.column("content")?,
        hash: row.column("hash")?,
    })
}

/// Checks the blocks in the order of their arrival.
fn check(mut verifier: Verifier, mut blocks: mpsc::Receiver<Block>) -> Verification {
    let mut digests = Digests::default();
    let mut last: HashMap<Vec<u8>, Hash> = HashMap::new();
    while let Some(Block { recipient, entries, reports }) = blocks.blocking_recv() {
        digests.add(reports);
        let start = last.get(&recipient).copied().unwrap_or_else(|| verifier.start_of(&recipient));
        let previous: Vec<Hash> =
            std::iter::once(start).chain(entries.iter().map(StoredEntry::stored_hash)).collect();
        let pairs: Vec<(&StoredEntry, &Hash)> = entries.iter().zip(&previous).collect();
        let checked: Vec<CheckedEntry> = on_all_processors(&pairs, |(entry, previous)| {
            entry.check(&recipient, previous, entry.report_id.and_then(|id| digests.get(id)))
        });
        verifier.take(&recipient, checked);
        last.insert(recipient, previous.last().copied().unwrap_or_default());
    }
    verifier.finish()
}
