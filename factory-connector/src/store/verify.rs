//! Reading the whole ledger for its verification.

use std::collections::HashMap;

use sqlx::{Connection as _, SqliteConnection, sqlite::SqliteRow};
use tokio::task::JoinHandle;

use super::{
    StoreError,
    load::{all, get, unsigned},
};
use crate::ledger::{
    CheckedEntry, Hash, StoredConsent, StoredEntry, StoredHead, StoredReport, StoredStatement, Surroundings,
    Verification, Verifier,
};

/// Entries read at once.
const BLOCK: i64 = 4000;
/// Texts are read as bytes: one that was damaged is a finding, not a failure.
const ENTRIES: &str = "SELECT CAST(e.recipient AS BLOB), e.number, e.recorded_at, e.report_id, CAST(e.content AS BLOB), \
    e.hash, r.id, r.writer_id, r.epoch, r.sequence, r.created_at, CAST(r.recipients AS BLOB), CAST(r.body AS BLOB), \
    r.salt FROM ledger_entry e LEFT JOIN report r ON r.id = e.report_id WHERE (e.recipient, e.number) > (CAST(? AS TEXT), ?) \
    ORDER BY e.recipient, e.number LIMIT ?";

/// Reads every chain from its beginning and looks for any change, deletion or reordering. Everything signed must be
/// signed with the trusted key, where one is given.
///
/// # Errors
/// [`StoreError`] where the tables cannot be read.
pub async fn verify_ledger(
    connection: &mut SqliteConnection,
    trusted_key: Option<Hash>,
) -> Result<Verification, StoreError> {
    // One view of everything, while the connector goes on writing.
    let mut view = connection.begin().await.map_err(StoreError::while_doing("read the ledger"))?;
    let mut verifier = Verifier::new(surroundings(&mut view, trusted_key).await?);
    let mut last: (Vec<u8>, i64, Hash) = (Vec::new(), 0, Hash::default());
    let mut under_way: Option<JoinHandle<Vec<CheckedEntry>>> = None;
    loop {
        let block = block(&mut view, &last.0, last.1).await?;
        let next = block.last().map(|entry| (entry.recipient.clone(), entry.number, entry.stored_hash()));
        let checking = next.is_some().then(|| {
            let previous = previous_hashes(&verifier, &block, &last);
            tokio::task::spawn_blocking(move || check(&block, &previous))
        });
        if let Some(done) = std::mem::replace(&mut under_way, checking) {
            take(&mut verifier, done).await?;
        }
        let Some(next) = next else { break };
        last = next;
    }
    Ok(verifier.finish())
}

async fn take(verifier: &mut Verifier, checking: JoinHandle<Vec<CheckedEntry>>) -> Result<(), StoreError> {
    let checked = checking.await.map_err(|error| StoreError::Unreadable {
        what: "ledger",
        reason: format!("the verification stopped: {error}"),
    })?;
    checked.into_iter().for_each(|entry| verifier.take(entry));
    Ok(())
}

/// Each entry by itself, on all processors.
fn check(block: &[StoredEntry], previous: &[Hash]) -> Vec<CheckedEntry> {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let share = block.len().div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        let parts: Vec<_> = block
            .chunks(share)
            .zip(previous.chunks(share))
            .map(|(entries, hashes)| {
                scope.spawn(move || {
                    entries.iter().zip(hashes).map(|(entry, hash)| entry.check(hash)).collect::<Vec<_>>()
                })
            })
            .collect();
        parts
            .into_iter()
            .flat_map(|part| part.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    })
}

/// The stored hash of the entry before each.
fn previous_hashes(verifier: &Verifier, block: &[StoredEntry], last: &(Vec<u8>, i64, Hash)) -> Vec<Hash> {
    let mut before: (&[u8], Hash) = (&last.0, last.2);
    let mut hashes = Vec::with_capacity(block.len());
    for entry in block {
        let is_first = before.0 != entry.recipient;
        hashes.push(if is_first { verifier.start_of(&entry.recipient) } else { before.1 });
        before = (&entry.recipient, entry.stored_hash());
    }
    hashes
}

async fn block(
    connection: &mut SqliteConnection,
    recipient: &[u8],
    number: i64,
) -> Result<Vec<StoredEntry>, StoreError> {
    let rows = sqlx::query(ENTRIES)
        .bind(recipient.to_vec())
        .bind(number)
        .bind(BLOCK)
        .fetch_all(connection)
        .await
        .map_err(StoreError::while_doing("read the ledger"))?;
    rows.iter().map(entry).collect()
}

fn entry(row: &SqliteRow) -> Result<StoredEntry, StoreError> {
    let report_id: Option<i64> = get(row, 6)?;
    let report = report_id.map(|_| -> Result<StoredReport, StoreError> {
        Ok(StoredReport {
            data_set_writer_id: get(row, 7)?,
            epoch: get(row, 8)?,
            sequence: get(row, 9)?,
            created_at: get(row, 10)?,
            recipients: get(row, 11)?,
            body: get(row, 12)?,
            salt: get(row, 13)?,
        })
    });
    Ok(StoredEntry {
        recipient: get(row, 0)?,
        number: get(row, 1)?,
        recorded_at: get(row, 2)?,
        report_id: get(row, 3)?,
        content: get(row, 4)?,
        hash: get(row, 5)?,
        report: report.transpose()?,
    })
}

async fn surroundings(
    connection: &mut SqliteConnection,
    trusted_key: Option<Hash>,
) -> Result<Surroundings, StoreError> {
    let factory = all(connection, "SELECT factory_id FROM identity", |row| get::<String>(row, 0)).await?.pop();
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

async fn consents(connection: &mut SqliteConnection) -> Result<HashMap<(String, u32), StoredConsent>, StoreError> {
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
    Ok(get::<Option<Vec<u8>>>(row, column)?.map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
}
