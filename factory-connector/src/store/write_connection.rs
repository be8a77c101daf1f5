//! The one connection that writes, on a thread of its own.
//!
//! A transaction takes one trip to that thread and goes to its end there, even if its caller was
//! cancelled meanwhile: none is left open, and transactions are stored in the order of their calls.

use std::{
    panic::resume_unwind,
    path::Path,
    sync::mpsc,
    thread::{self, JoinHandle},
    time::Duration,
};

use rusqlite::{Connection, Transaction, TransactionBehavior};
use tokio::sync::oneshot;

use super::error::StoreError;

/// Cache of the connection, in KiB with a minus sign: enough for the ends of the indexes, which
/// every transaction touches.
const CACHE: i64 = -32_768;
/// Pages in the write-ahead log after which it is written back: pages that many transactions change
/// are written once.
const CHECKPOINT_PAGES: i64 = 8_000;
/// More statements than one transaction has.
const PREPARED_STATEMENTS: usize = 64;

type Job = Box<dyn FnOnce(&mut Connection) + Send>;

/// Connection that all transactions go through, on a thread of its own: SQLite has one writer.
pub(super) struct WriteConnection {
    /// Jobs run one at a time, in the order in which they were sent.
    jobs: mpsc::Sender<Job>,
    /// `None` after a panic has ended it.
    thread: Option<JoinHandle<()>>,
}

impl WriteConnection {
    /// Opens a file whose tables are up to date.
    ///
    /// # Errors
    /// [`StoreError`] where it cannot be opened.
    pub(super) fn open(
        database: &Path,
        busy_timeout: Duration,
        log_bytes: &str,
    ) -> Result<Self, StoreError> {
        let mut connection = connect(database, busy_timeout, log_bytes)
            .map_err(StoreError::while_writing("open the store"))?;
        let (jobs, queue) = mpsc::channel::<Job>();
        let thread = thread::Builder::new()
            .name("store".to_owned())
            .spawn(move || {
                while let Ok(job) = queue.recv() {
                    job(&mut connection);
                }
                if let Err((_, error)) = connection.close() {
                    tracing::warn!(
                        %error,
                        "The store could not be closed in good order; \
                         it will be recovered at the next start."
                    );
                }
            })
            .map_err(|source| StoreError::Access { path: database.to_owned(), source })?;
        Ok(Self { jobs, thread: Some(thread) })
    }

    /// Does all of the work or nothing of it. A transaction whose caller was cancelled still
    /// finishes.
    ///
    /// # Errors
    /// The error of the work, or of the transaction.
    pub(super) async fn transact<T: Send + 'static>(
        &mut self,
        action: &'static str,
        work: impl FnOnce(&Transaction<'_>) -> Result<T, StoreError> + Send + 'static,
    ) -> Result<T, StoreError> {
        let (answer, outcome) = oneshot::channel();
        let job = move |connection: &mut Connection| {
            // The caller may have been cancelled, and its receiver be gone.
            drop(answer.send(transaction(connection, action, work)));
        };
        if self.jobs.send(Box::new(job)).is_ok()
            && let Ok(outcome) = outcome.await
        {
            return outcome;
        }
        // The work panicked and took the thread with it: so does its caller.
        match self.thread.take().map(JoinHandle::join) {
            Some(Err(panic)) => resume_unwind(panic),
            _ => Err(StoreError::Closed),
        }
    }

    /// Ends the thread when everything is written.
    pub(super) async fn close(self) {
        drop(self.jobs);
        // Joining blocks: the thread may still be writing.
        drop(tokio::task::spawn_blocking(|| self.thread.map(JoinHandle::join)).await);
    }
}

fn connect(
    database: &Path,
    busy_timeout: Duration,
    log_bytes: &str,
) -> rusqlite::Result<Connection> {
    let connection = Connection::open(database)?;
    // Commands beside a running connector write users and the enrolment.
    connection.busy_timeout(busy_timeout)?;
    connection.pragma_update(None, "journal_mode", "WAL")?;
    // Messages are settled after their commit, so it has to survive a loss of power. NORMAL may
    // lose the last transactions of a write-ahead log.
    connection.pragma_update(None, "synchronous", "FULL")?;
    // Off by default, and a setting of each connection.
    connection.pragma_update(None, "foreign_keys", true)?;
    connection.pragma_update(None, "journal_size_limit", log_bytes)?;
    connection.pragma_update(None, "cache_size", CACHE)?;
    connection.pragma_update(None, "wal_autocheckpoint", CHECKPOINT_PAGES)?;
    connection.set_prepared_statement_cache_capacity(PREPARED_STATEMENTS);
    Ok(connection)
}

fn transaction<T>(
    connection: &mut Connection,
    action: &'static str,
    work: impl FnOnce(&Transaction<'_>) -> Result<T, StoreError>,
) -> Result<T, StoreError> {
    // The write lock at once: a transaction that begins by reading can find it taken when it
    // writes, and then has to begin again.
    let transaction = connection
        .transaction_with_behavior(TransactionBehavior::Immediate)
        .map_err(StoreError::while_writing("begin a transaction"))?;
    // Dropped without a commit it is rolled back.
    let outcome = work(&transaction)?;
    transaction.commit().map_err(StoreError::while_writing(action))?;
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG_BYTES: &str = "1000000";

    fn open(folder: &Path) -> WriteConnection {
        WriteConnection::open(&folder.join("test.db"), Duration::from_secs(1), LOG_BYTES)
            .expect("opened")
    }

    async fn execute(
        writer: &mut WriteConnection,
        statements: &'static str,
    ) -> Result<(), StoreError> {
        let work = move |transaction: &Transaction<'_>| {
            transaction.execute_batch(statements).map_err(StoreError::while_writing("test"))
        };
        writer.transact("test", work).await
    }

    async fn count(writer: &mut WriteConnection) -> i64 {
        let count = |transaction: &Transaction<'_>| {
            let sql = "SELECT count(*) AS count FROM number";
            let count = transaction.query_row(sql, (), |row| row.get("count"));
            count.map_err(StoreError::while_writing("count"))
        };
        writer.transact("count", count).await.expect("counted")
    }

    #[tokio::test]
    async fn a_failed_transaction_leaves_nothing_and_the_connection_works_on() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut writer = open(folder.path());
        execute(&mut writer, "CREATE TABLE number (value INTEGER PRIMARY KEY)")
            .await
            .expect("a table");
        let problem = execute(
            &mut writer,
            "INSERT INTO number VALUES (1), (2); INSERT INTO number VALUES (2)",
        )
        .await;
        let cause =
            std::error::Error::source(&problem.expect_err("taken")).map(ToString::to_string);
        assert!(cause.is_some_and(|cause| cause.contains("UNIQUE")));
        assert_eq!(count(&mut writer).await, 0);
        execute(&mut writer, "INSERT INTO number VALUES (1), (2)").await.expect("written");
        assert_eq!(count(&mut writer).await, 2);
        writer.close().await;
    }

    #[tokio::test]
    async fn a_transaction_of_a_cancelled_caller_is_written_before_the_next() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut writer = open(folder.path());
        execute(&mut writer, "CREATE TABLE number (value INTEGER PRIMARY KEY)")
            .await
            .expect("a table");
        let rows = "WITH RECURSIVE n(value) AS (
                        SELECT 1 UNION ALL SELECT value + 1 FROM n WHERE value < 100000)
                    INSERT INTO number SELECT value FROM n";
        let given_up = tokio::time::timeout(Duration::ZERO, execute(&mut writer, rows)).await;
        assert!(given_up.is_err(), "the transaction takes longer than nothing");
        assert_eq!(count(&mut writer).await, 100_000);
    }

    #[tokio::test]
    #[should_panic(expected = "a fault in the work")]
    async fn a_panic_of_the_work_reaches_its_caller() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut writer = open(folder.path());
        drop(
            writer
                .transact("panic", |_| -> Result<(), StoreError> { panic!("a fault in the work") })
                .await,
        );
    }
}
