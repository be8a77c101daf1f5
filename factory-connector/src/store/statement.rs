//! Statements of the writing connection, each prepared once.

use rusqlite::{Connection, Params};

/// Runs one statement with its parameters and returns the number of rows it changed.
pub(super) fn run(
    connection: &Connection,
    statement: &str,
    parameters: impl Params,
) -> rusqlite::Result<usize> {
    connection.prepare_cached(statement)?.execute(parameters)
}

/// Runs one statement for each of many rows; prepares nothing where there is none.
pub(super) fn write_rows<R, P: Params>(
    connection: &Connection,
    statement: &str,
    rows: impl IntoIterator<Item = R>,
    parameters: impl Fn(R) -> P,
) -> rusqlite::Result<()> {
    let mut rows = rows.into_iter().peekable();
    if rows.peek().is_none() {
        return Ok(());
    }
    let mut statement = connection.prepare_cached(statement)?;
    for row in rows {
        statement.execute(parameters(row))?;
    }
    Ok(())
}

/// Runs a statement on the rows with these ids, which it takes as one parameter for
/// `IN (SELECT value FROM json_each(?))`; nothing where there are none.
pub(super) fn write_ids(
    connection: &Connection,
    statement: &str,
    ids: &[i64],
) -> rusqlite::Result<()> {
    if ids.is_empty() {
        return Ok(());
    }
    run(connection, statement, (id_list(ids),)).map(drop)
}

/// Writes row ids as one JSON parameter for `IN (SELECT value FROM json_each(?))`.
pub(super) fn id_list(ids: &[i64]) -> String {
    serde_json::to_string(ids).expect("numbers serialise")
}
