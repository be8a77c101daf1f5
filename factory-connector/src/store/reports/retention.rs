//! Removal of old values and of reports that no chain refers to any more.

use asi_model::{DateTime, OrganisationId};
use connector_state::use_cases::retain::OldReport;
use ledger::SequenceRange;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use crate::store::{
    error::StoreError,
    query::{all, one, query},
    row::Columns as _,
    statement::{id_list, run, write_ids},
};

/// Reports whose values are emptied in one round. The coordinator serves nothing else meanwhile.
const VALUES_PER_ROUND: i64 = 2000;
const READ: &str = "read old reports";

/// Reads finished reports with values that were made before `before`, after the report with the
/// number `after`; a bounded number at a time.
pub(super) async fn old_reports(
    connection: &mut SqliteConnection,
    before: DateTime,
    after: i64,
) -> Result<Vec<OldReport>, StoreError> {
    let sql = "SELECT id, message, writer_id, epoch, sequence, recipients FROM report
               WHERE id > ? AND created_at < ? AND state = 'DONE' AND body IS NOT NULL
               ORDER BY id LIMIT ?";
    let query = query(sql).bind(after).bind(before.unix_micros()).bind(VALUES_PER_ROUND);
    all(connection, query, READ, old).await
}

fn old(row: &SqliteRow) -> Result<OldReport, StoreError> {
    Ok(OldReport {
        id: row.column("id")?,
        message: row.column("message")?,
        data_set_writer_id: row.number("writer_id")?,
        epoch: row.number("epoch")?,
        sequence: row.number("sequence")?,
        recipients: row.document("recipients")?,
    })
}

/// Reads which reports have no values, as ranges of sequence numbers with their recipients.
pub(in crate::store) async fn emptied(
    connection: &mut SqliteConnection,
) -> Result<Vec<(SequenceRange, Vec<OrganisationId>)>, StoreError> {
    // Neighbouring numbers have the same distance from their place in the order.
    let sql = "SELECT writer_id, epoch, recipients, min(sequence) AS first, max(sequence) AS last
               FROM (SELECT writer_id, epoch, recipients, sequence,
                         sequence - row_number() OVER (
                             PARTITION BY writer_id, epoch, recipients ORDER BY sequence) AS run
                     FROM report WHERE body IS NULL)
               GROUP BY writer_id, epoch, recipients, run ORDER BY 1, 2, 4";
    let range = |row: &SqliteRow| {
        let range = SequenceRange {
            data_set_writer_id: row.number("writer_id")?,
            epoch: row.number("epoch")?,
            first_sequence: row.number("first")?,
            last_sequence: row.number("last")?,
        };
        Ok((range, row.document("recipients")?))
    };
    all(connection, query(sql), READ, range).await
}

/// Empties the values of reports.
pub(in crate::store) fn empty_values(
    connection: &Connection,
    reports: &[i64],
) -> rusqlite::Result<()> {
    // The salt with the value: with it, a guessed value could be confirmed by the hash that remains.
    write_ids(
        connection,
        "UPDATE report SET body = NULL, salt = NULL
         WHERE id IN (SELECT value FROM json_each(?))",
        reports,
    )
}

/// Returns the time of the oldest report that is not finished.
pub(in crate::store) async fn oldest_in_spool(
    connection: &mut SqliteConnection,
) -> Result<Option<DateTime>, StoreError> {
    let sql = "SELECT min(created_at) AS oldest_at FROM report
               WHERE state IN ('WAITING', 'SENT', 'PARKED')";
    one(connection, query(sql), READ, |row| row.time_option("oldest_at")).await
}

/// Removes those of the reports that are finished and that no ledger entry refers to.
pub(in crate::store) fn remove_unreferenced(
    connection: &Connection,
    reports: &[i64],
) -> rusqlite::Result<()> {
    run(
        connection,
        "DELETE FROM report WHERE id IN (SELECT value FROM json_each(?)) AND state = 'DONE'
             AND NOT EXISTS (SELECT 1 FROM ledger_entry e WHERE e.report_id = report.id)",
        (id_list(reports),),
    )
    .map(drop)
}
