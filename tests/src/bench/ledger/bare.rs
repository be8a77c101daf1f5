//! Bare SQLite: the same rows in the same transactions into the same tables, by prepared statements
//! on the thread that has them already.

use std::{
    path::Path,
    time::{Duration, Instant},
};

use connector_state::Writes;
use rusqlite::{Connection, TransactionBehavior, params};

/// The file of the connector's store.
const DATABASE_FILE: &str = "connector.sqlite";

/// A second writer of a store.
pub(super) struct BareStore(Connection);

impl BareStore {
    /// Opens a database with the connector's settings.
    pub fn open(folder: &Path) -> anyhow::Result<Self> {
        let connection = Connection::open(folder.join(DATABASE_FILE))?;
        connection.pragma_update(None, "synchronous", "FULL")?;
        connection.pragma_update(None, "foreign_keys", true)?;
        connection.pragma_update(None, "cache_size", -32_768)?;
        connection.pragma_update(None, "wal_autocheckpoint", 8_000)?;
        Ok(Self(connection))
    }

    /// Writes what reports bring with them; answers how long it took.
    pub fn commit(&mut self, changes: &Writes) -> anyhow::Result<Duration> {
        let began = Instant::now();
        let transaction = self.0.transaction_with_behavior(TransactionBehavior::Immediate)?;
        write(&transaction, changes)?;
        transaction.commit()?;
        Ok(began.elapsed())
    }
}

fn write(transaction: &Connection, changes: &Writes) -> rusqlite::Result<()> {
    let mut statement = transaction.prepare_cached(
        "INSERT INTO field_value (field_id, gate, transform) VALUES (?, ?, ?) \
             ON CONFLICT (field_id) DO UPDATE SET gate = excluded.gate, transform = excluded.transform",
    )?;
    for (id, row) in &changes.fields.values {
        statement.execute(params![id, row.gate, row.transform])?;
    }
    let mut statement =
        transaction.prepare_cached("UPDATE writer SET next_sequence = ? WHERE id = ?")?;
    for (id, row) in &changes.writers.changed {
        statement.execute(params![row.next_sequence, id])?;
    }
    let mut statement = transaction.prepare_cached(
        "INSERT INTO report (id, message, writer_id, epoch, sequence, state, created_at, recipients, bytes, body, \
             salt) VALUES (?, ?, ?, ?, ?, 'WAITING', ?, ?, ?, ?, ?)",
    )?;
    for row in &changes.reports.queued {
        let created_at = row.created_at.unix_micros();
        let recipients = serde_json::to_string(&row.recipients).expect("names serialise");
        let (writer, bytes) = (row.data_set_writer_id, row.body.len() as i64);
        statement.execute(params![
            row.id,
            row.message,
            writer,
            row.epoch,
            row.sequence,
            created_at,
            recipients,
            bytes,
            &*row.body,
            row.salt
        ])?;
    }
    let mut statement = transaction.prepare_cached(
        "INSERT INTO ledger_entry (recipient, number, recorded_at, report_id, content, hash) \
             VALUES (?, ?, ?, ?, ?, ?)",
    )?;
    for (entry, report) in &changes.ledger.entries {
        let (recipient, recorded_at) = (entry.recipient.as_str(), entry.recorded_at.unix_micros());
        let number = entry.number as i64;
        statement.execute(params![
            recipient,
            number,
            recorded_at,
            report,
            entry.content,
            entry.hash
        ])?;
    }
    let mut statement = transaction.prepare_cached(
        "UPDATE ledger_head SET number = ?, hash = ?, signature = ? WHERE recipient = ?",
    )?;
    for head in &changes.ledger.heads {
        let number = head.number as i64;
        statement.execute(params![number, head.hash, head.signature, head.recipient.as_str()])?;
    }
    Ok(())
}
