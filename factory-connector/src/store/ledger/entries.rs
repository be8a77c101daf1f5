//! Entries of the chains, each with the report and the precision that explain it.

use std::collections::BTreeMap;

use asi_model::DateTime;
use disclosure::{DecisionBasis, Statement};
use ledger::LinkedEntry;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    basis,
    precision::Precisions,
    selection::{EntryRange, LedgerFilter, selection},
};
use crate::store::{
    error::StoreError,
    query::all,
    row::{Columns as _, signed},
    statement::write_rows,
};

/// An entry with everything that explains it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LedgerRow {
    /// Number in the recipient's chain, from 1.
    pub number: u64,
    /// The hashed text.
    pub content: String,
    /// Hash of the text and of the entry before, hexadecimal.
    pub hash: String,
    /// The DataSetMessage that left, until retention empties it.
    pub report: Option<String>,
    /// Id of the message in which the report left last.
    pub message_id: Option<String>,
    /// Time at which the broker accepted the report last.
    pub sent_at: Option<DateTime>,
    /// Time at which the platform receipted the report.
    pub delivered_at: Option<DateTime>,
    /// Precision under each consent that the entry names, by field, as partners read it.
    pub precision: BTreeMap<String, Statement>,
    /// Documents that a recorded decision is based on, where the text only commits to them.
    pub basis: Option<DecisionBasis>,
}

/// Reads the entries of a chain that a filter selects.
pub(super) async fn read(
    connection: &mut SqliteConnection,
    recipient: &str,
    filter: &LedgerFilter,
    window: EntryRange,
    limit: u32,
    precisions: &mut Precisions,
) -> Result<Vec<LedgerRow>, StoreError> {
    let mut sql = selection(recipient, filter, window, limit);
    let mut rows = all(connection, sql.build(), "read the ledger", entry).await?;
    for row in &mut rows {
        row.precision = precisions.of(connection, &row.content, row.report.as_deref()).await?;
        row.basis = basis::of_entry(connection, &row.content).await?;
    }
    Ok(rows)
}

fn entry(row: &SqliteRow) -> Result<LedgerRow, StoreError> {
    Ok(LedgerRow {
        number: row.column::<i64>("number")?.unsigned_abs(),
        content: row.column("content")?,
        hash: hex::encode(row.column::<Vec<u8>>("hash")?),
        report: row.column("body")?,
        message_id: row.column("message_id")?,
        sent_at: row.time_option("sent_at")?,
        delivered_at: row.time_option("receipted_at")?,
        precision: BTreeMap::new(),
        basis: None,
    })
}

/// Stores new entries, each with the number of the report it is about.
pub(in crate::store) fn write(
    connection: &Connection,
    entries: &[(LinkedEntry, Option<i64>)],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO ledger_entry (recipient, number, recorded_at, report_id, content, hash)
         VALUES (?, ?, ?, ?, ?, ?)",
        entries,
        |(entry, report_id)| {
            (
                entry.recipient.as_str(),
                signed(entry.number),
                entry.recorded_at.unix_micros(),
                report_id,
                &entry.content,
                &entry.hash,
            )
        },
    )
}
