//! Reading the whole ledger for its verification.

mod reports;

use std::collections::HashMap;

use sqlx::{Connection as _, SqliteConnection, sqlite::SqliteRow};
use tokio::sync::mpsc;

use self::reports::{Digests, NewReports, Wanted};
use super::{
    StoreError,
    load::{all, get, unsigned},
};
use ledger::{
    CheckedEntry, Hash, StoredConsent, StoredEntry, StoredHead, StoredStatement, Surroundings,
    Verification, Verifier,
};

/// Entries read at once.
const BLOCK: i64 = 4000;
/// Blocks that may wait to be looked at.
const BLOCKS_AHEAD: usize = 2;
/// Texts are read as bytes: one that was damaged is a finding, not a failure.
const ENTRIES: &str = "SELECT number, recorded_at, report_id, CAST(content AS BLOB), hash FROM ledger_entry \
    WHERE recipient = CAST(? AS TEXT) AND number >= ? ORDER BY number LIMIT ?";
const NEXT_CHAIN: &str = "SELECT CAST(recipient AS BLOB) FROM ledger_entry WHERE ?1 IS NULL OR recipient > CAST(?1 AS TEXT) \
    ORDER BY recipient LIMIT 1";

/// How far a chain was read.
struct Chain {
    recipient: Vec<u8>,
    /// The least number that the next entry may have; none at the end.
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

/// Reads every chain from its beginning and looks for any change, deletion or reordering.
/// Everything signed must be signed with the trusted key, where one is given.
///
/// # Errors
/// [`StoreError`] where the tables cannot be read.
pub async fn verify_ledger(
    connection: &mut SqliteConnection,
    trusted_key: Option<Hash>,
) -> Result<Verification, StoreError> {
    // One view of everything, while the connector goes on writing.
    let mut view = connection.begin().await.map_err(StoreError::while_doing("read the ledger"))?;
    let verifier = Verifier::new(surroundings(&mut view, trusted_key).await?);
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
    let mut wanted = Wanted::default();
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
        let reports = wanted.read(connection, &referred, behind).await?;
        if blocks.send(Block { recipient, entries, reports }).await.is_err() {
            break;
        }
    }
    Ok(())
}

async fn chains(connection: &mut SqliteConnection) -> Result<Vec<Chain>, StoreError> {
    let mut chains: Vec<Chain> = Vec::new();
    loop {
        let row = sqlx::query(NEXT_CHAIN)
            .bind(chains.last().map(|chain| chain.recipient.clone()))
            .fetch_optional(&mut *connection)
            .await
            .map_err(StoreError::while_doing("read the ledger"))?;
        let Some(row) = row else { return Ok(chains) };
        chains.push(Chain { recipient: get(&row, 0)?, next: Some(i64::MIN), report: i64::MIN });
    }
}

async fn entries(
    connection: &mut SqliteConnection,
    chain: &Chain,
) -> Result<Vec<StoredEntry>, StoreError> {
    let rows = sqlx::query(ENTRIES)
        .bind(chain.recipient.clone())
        .bind(chain.next)
        .bind(BLOCK)
        .fetch_all(connection)
        .await
        .map_err(StoreError::while_doing("read the ledger"))?;
    rows.iter().map(entry).collect()
}

fn entry(row: &SqliteRow) -> Result<StoredEntry, StoreError> {
    Ok(StoredEntry {
        number: get(row, 0)?,
        recorded_at: get(row, 1)?,
        report_id: get(row, 2)?,
        content: get(row, 3)?,
        hash: get(row, 4)?,
    })
}

/// Looks at the blocks as they come.
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

/// Does the same with each, in their order.
fn on_all_processors<T: Sync, R: Send>(items: &[T], each: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let share = items.len().div_ceil(threads).max(1);
    let each = &each;
    std::thread::scope(|scope| {
        let parts: Vec<_> = items
            .chunks(share)
            .map(|part| scope.spawn(move || part.iter().map(each).collect::<Vec<_>>()))
            .collect();
        parts
            .into_iter()
            .flat_map(|part| part.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    })
}

async fn surroundings(
    connection: &mut SqliteConnection,
    trusted_key: Option<Hash>,
) -> Result<Surroundings, StoreError> {
    let factory = all(connection, "SELECT factory_id FROM identity", |row| get::<String>(row, 0))
        .await?
        .pop();
    Ok(Surroundings {
        factory_id: factory.unwrap_or_default(),
        trusted_key,
        anchors: all(
            connection,
            "SELECT CAST(recipient AS BLOB), recorded_at, CAST(content AS BLOB), signature, public_key \
             FROM ledger_anchor ORDER BY recipient",
            statement,
        )
        .await?,
        checkpoints: all(
            connection,
            "SELECT CAST(CAST(number AS TEXT) AS BLOB), recorded_at, CAST(content AS BLOB), signature, public_key \
             FROM ledger_checkpoint ORDER BY number",
            statement,
        )
        .await?,
        revocations: all(
            connection,
            "SELECT CAST(revocation_id AS BLOB), revoked_at, CAST(content AS BLOB), signature, public_key \
             FROM revocation ORDER BY revocation_id",
            statement,
        )
        .await?,
        heads: all(
            connection,
            "SELECT CAST(recipient AS BLOB), number, hash, signature, public_key FROM ledger_head ORDER BY recipient",
            |row| {
                Ok(StoredHead {
                    recipient: text(row, 0)?,
                    number: get(row, 1)?,
                    hash: get(row, 2)?,
                    signature: get(row, 3)?,
                    public_key: get(row, 4)?,
                })
            },
        )
        .await?,
        consents: consents(connection).await?,
    })
}

fn statement(row: &SqliteRow) -> Result<StoredStatement, StoreError> {
    Ok(StoredStatement {
        name: text(row, 0)?,
        recorded_at: get(row, 1)?,
        content: get(row, 2)?,
        signature: get(row, 3)?,
        public_key: get(row, 4)?,
    })
}

async fn consents(
    connection: &mut SqliteConnection,
) -> Result<HashMap<(String, u32), StoredConsent>, StoreError> {
    let rows = all(
        connection,
        "SELECT CAST(field AS BLOB), version, CAST(mapping_state AS BLOB), CAST(value_source AS BLOB), \
         CAST(policy AS BLOB), CAST(decided_by AS BLOB), decided_at FROM consent",
        |row| {
            let consent = StoredConsent {
                mapping_state: text(row, 2)?,
                value_source: optional_text(row, 3)?,
                policy: text(row, 4)?,
                decided_by: optional_text(row, 5)?,
                decided_at: get(row, 6)?,
            };
            Ok(((text(row, 0)?, unsigned(get(row, 1)?)), consent))
        },
    )
    .await?;
    Ok(rows.into_iter().collect())
}

fn text(row: &SqliteRow, column: usize) -> Result<String, StoreError> {
    Ok(String::from_utf8_lossy(&get::<Vec<u8>>(row, column)?).into_owned())
}

fn optional_text(row: &SqliteRow, column: usize) -> Result<Option<String>, StoreError> {
    Ok(get::<Option<Vec<u8>>>(row, column)?
        .map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
}
