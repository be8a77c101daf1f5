//! Removal of old values and of reports that no chain refers to any more.

use asi_model::DateTime;
use rusqlite::Connection;

use crate::store::statement::{id_list, run};

/// Reports whose values are emptied in one round. The coordinator serves nothing else meanwhile.
const VALUES_PER_ROUND: i64 = 2000;

/// Empties the values of finished reports that were made before `before`, after the report with the
/// number `after`. Returns the number of the last one; `None` when there are no more.
pub(in crate::store) fn empty_values(
    connection: &Connection,
    before: DateTime,
    after: i64,
) -> rusqlite::Result<Option<i64>> {
    let ids: Vec<i64> = connection
        .prepare_cached(
            "SELECT id FROM report
             WHERE id > ? AND created_at < ? AND state = 'DONE' AND body IS NOT NULL
             ORDER BY id LIMIT ?",
        )?
        .query_map((after, before.unix_micros(), VALUES_PER_ROUND), |row| row.get("id"))?
        .collect::<Result<_, _>>()?;
    if !ids.is_empty() {
        // The salt with the value: with it, a guessed value could be confirmed by the hash that
        // remains.
        run(
            connection,
            "UPDATE report SET body = NULL, salt = NULL
             WHERE id IN (SELECT value FROM json_each(?))",
            (id_list(&ids),),
        )?;
    }
    Ok(ids.last().copied())
}

/// Returns the time of the oldest report that is not finished, in microseconds since 1970.
pub(in crate::store) fn oldest_in_spool(connection: &Connection) -> rusqlite::Result<Option<i64>> {
    connection
        .prepare_cached(
            "SELECT min(created_at) AS oldest_at FROM report
             WHERE state IN ('WAITING', 'SENT', 'PARKED')",
        )?
        .query_row((), |row| row.get("oldest_at"))
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
