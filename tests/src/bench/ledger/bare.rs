//! Bare SQLite: as many rows of as many bytes in as many transactions, with the connector's settings and its blocks of
//! rows, but in tables with nothing but a primary key and with bodies made beforehand.

use std::time::{Duration, Instant};

use sqlx::{
    AssertSqlSafe, ConnectOptions as _, Connection as _, SqliteConnection,
    sqlite::{SqliteConnectOptions, SqliteJournalMode, SqliteSynchronous},
};

use super::{FIELDS, REQUESTS, Rows, Written};

/// Rows of one statement.
const BLOCK: usize = 100;

/// How long these rows take in so many transactions.
pub(super) async fn appends(written: &Written, transactions: usize) -> anyhow::Result<Duration> {
    let folder = tempfile::tempdir()?;
    let options = SqliteConnectOptions::new()
        .filename(folder.path().join("bare.db"))
        .create_if_missing(true)
        .journal_mode(SqliteJournalMode::Wal)
        .synchronous(SqliteSynchronous::Full)
        .disable_statement_logging();
    let mut connection = SqliteConnection::connect_with(&options).await?;
    for table in ["report", "entry", "value"] {
        let create = format!("CREATE TABLE {table} (id INTEGER PRIMARY KEY, body BLOB NOT NULL) STRICT");
        sqlx::query(AssertSqlSafe(create)).execute(&mut connection).await?;
    }
    let tables = [("report", written.reports), ("entry", written.entries), ("value", written.values)];
    let mut next = [1_i64; 3];
    let began = Instant::now();
    for _ in 0..transactions {
        let mut transaction = connection.begin_with("BEGIN IMMEDIATE").await?;
        for ((table, rows), next) in tables.into_iter().zip(&mut next) {
            write(&mut transaction, table, rows, transactions, next).await?;
        }
        // The values of the fields are overwritten, as a state is.
        next[2] %= i64::try_from(REQUESTS * FIELDS)?;
        transaction.commit().await?;
    }
    let took = began.elapsed();
    connection.close().await?;
    Ok(took)
}

/// The rows of one transaction.
async fn write(
    connection: &mut SqliteConnection,
    table: &str,
    rows: Rows,
    transactions: usize,
    next: &mut i64,
) -> anyhow::Result<()> {
    let body = vec![b'x'; rows.bytes / rows.count.max(1)];
    let mut rest = rows.count / transactions;
    while rest > 0 {
        let block = rest.min(BLOCK);
        rest -= block;
        let statement =
            format!("INSERT OR REPLACE INTO {table} (id, body) VALUES {}", vec!["(?, ?)"; block].join(", "));
        let mut query = sqlx::query(AssertSqlSafe(statement));
        for _ in 0..block {
            query = query.bind(*next).bind(body.clone());
            *next += 1;
        }
        query.execute(&mut *connection).await?;
    }
    Ok(())
}
