//! A chain as an audit file, which others check against a checkpoint that they kept.

use asi_model::OrganisationId;
use ledger::{
    LedgerKey, LogStart,
    audit::{AuditEntry, AuditStart},
};
use serde_json::value::RawValue;
use sqlx::{SqliteConnection, sqlite::SqliteRow};
use transparency_log::{LeafRange, VerifierKey};

use super::{heads, logs, logs::stored_anchor};
use crate::store::{
    error::StoreError,
    query::{all, optional, query},
    row::{Columns as _, signed},
};

/// Entries read at once.
const BLOCK: i64 = 1000;
const READ: &str = "read the ledger for an audit";

/// The last checkpoint of a chain's log, with the key that verifies it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogCheckpoint {
    /// A C2SP signed note.
    pub note: String,
    pub key: VerifierKey,
}

/// Reads the leaves of a log before the entries that its chain still has; `None` without a log.
pub(super) async fn leaves_before(
    connection: &mut SqliteConnection,
    recipient: &OrganisationId,
) -> Result<Option<(LogStart, LeafRange)>, StoreError> {
    let sql = "SELECT start FROM ledger_log WHERE recipient = ? AND start <> ''";
    let query_start = query(sql).bind(recipient.to_string());
    let start: Option<LogStart> =
        optional(connection, query_start, READ, |row| row.document("start")).await?;
    let Some(start) = start else { return Ok(None) };
    let anchor = stored_anchor(connection, recipient).await?;
    let leaves = start
        .leaves_before(anchor.as_ref())
        .ok_or("the anchor is not one of the log")
        .map_err(StoreError::unreadable("anchor"))?;
    Ok(Some((start, leaves)))
}

/// Begins an audit file, with a checkpoint over all entries: the stored one, or else a new one that
/// the key signs; none where there is neither.
pub(super) async fn start(
    connection: &mut SqliteConnection,
    recipient: &OrganisationId,
    key: Option<&LedgerKey>,
) -> Result<Option<AuditStart>, StoreError> {
    let found = leaves_before(connection, recipient).await?;
    let Some((start, leaves)) = found else { return Ok(None) };
    let heads = heads::load(connection).await?;
    let mut logs = logs::load(connection, &heads).await?;
    let log = logs.get_mut(recipient);
    let checkpoint = log.and_then(|log| {
        if log.has_grown() {
            log.sign_checkpoint(key?);
        }
        log.checkpoint().map(str::to_owned)
    });
    Ok(Some(AuditStart {
        log_start: start.canonical(),
        // The first leaf is no entry.
        number: start.number + leaves.end() - 1,
        leaves: leaves.hashes().iter().map(hex::encode).collect(),
        checkpoint,
    }))
}

pub(super) async fn entries(
    connection: &mut SqliteConnection,
    recipient: &OrganisationId,
    after: u64,
) -> Result<Vec<AuditEntry>, StoreError> {
    let sql = "SELECT e.content, r.body, r.salt, r.sent_at, r.message_id, r.receipted_at
               FROM ledger_entry e LEFT JOIN report r ON r.id = e.report_id
               WHERE e.recipient = ? AND e.number > ? ORDER BY e.number LIMIT ?";
    let query = query(sql).bind(recipient.to_string()).bind(signed(after)).bind(BLOCK);
    all(connection, query, READ, entry).await
}

pub(super) async fn checkpoint(
    connection: &mut SqliteConnection,
    recipient: &OrganisationId,
) -> Result<Option<LogCheckpoint>, StoreError> {
    let sql = "SELECT l.start, l.checkpoint, h.public_key
               FROM ledger_log l JOIN ledger_head h ON h.recipient = l.recipient
               WHERE l.recipient = ? AND l.checkpoint <> ''";
    let read = |row: &SqliteRow| {
        let start: LogStart = row.document("start")?;
        let key: Vec<u8> = row.column("public_key")?;
        let key = key
            .try_into()
            .ok()
            .and_then(|key| start.verifier(&key).ok())
            .ok_or("this is no Ed25519 key")
            .map_err(StoreError::unreadable("public_key"))?;
        Ok(LogCheckpoint { note: row.column("checkpoint")?, key })
    };
    optional(connection, query(sql).bind(recipient.to_string()), READ, read).await
}

fn entry(row: &SqliteRow) -> Result<AuditEntry, StoreError> {
    let report = row.column::<Option<String>>("body")?.map(RawValue::from_string).transpose();
    Ok(AuditEntry {
        entry: row.column("content")?,
        report: report.map_err(StoreError::unreadable("body"))?,
        salt: row.column::<Option<Vec<u8>>>("salt")?.map(hex::encode),
        sent_at: row.time_option("sent_at")?,
        message_id: row.parsed_option("message_id")?,
        delivered_at: row.time_option("receipted_at")?,
    })
}
