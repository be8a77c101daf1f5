//! Opening of the SQLite database, its migrations, and the start of transactions.

use std::{
    path::Path,
    time::{Duration, Instant},
};

use sqlx::{
    Connection as _, SqlSafeStr, SqlitePool,
    migrate::{Migration, MigrationType, Migrator},
    sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous},
};

use super::{error::StoreError, work::Work};

const MIGRATIONS: [(i64, &str, &str); 28] = [
    (1, "house", include_str!("../../migrations/sqlite/0001_house.sql")),
    (2, "tools by publisher", include_str!("../../migrations/sqlite/0002_tools_by_publisher.sql")),
    (3, "leases", include_str!("../../migrations/sqlite/0003_leases.sql")),
    (4, "entitlement", include_str!("../../migrations/sqlite/0004_entitlement.sql")),
    (5, "network owners", include_str!("../../migrations/sqlite/0005_network_owners.sql")),
    (6, "ledger witness", include_str!("../../migrations/sqlite/0006_ledger_witness.sql")),
    (7, "past releases", include_str!("../../migrations/sqlite/0007_past_releases.sql")),
    (8, "accesses", include_str!("../../migrations/sqlite/0008_accesses.sql")),
    (10, "revocations", include_str!("../../migrations/sqlite/0010_revocations.sql")),
    (11, "sight", include_str!("../../migrations/sqlite/0011_sight.sql")),
    (30, "audit", include_str!("../../migrations/sqlite/0030_audit.sql")),
    (31, "removals", include_str!("../../migrations/sqlite/0031_removals.sql")),
    (32, "recipients named", include_str!("../../migrations/sqlite/0032_recipients_named.sql")),
    (33, "sessions", include_str!("../../migrations/sqlite/0033_sessions.sql")),
    (34, "second factors", include_str!("../../migrations/sqlite/0034_second_factors.sql")),
    (35, "signed messages", include_str!("../../migrations/sqlite/0035_signed_messages.sql")),
    (36, "opaque ids", include_str!("../../migrations/sqlite/0036_opaque_ids.sql")),
    (37, "fair shares", include_str!("../../migrations/sqlite/0037_fair_shares.sql")),
    (
        38,
        "sealed second factors",
        include_str!("../../migrations/sqlite/0038_sealed_second_factors.sql"),
    ),
    (39, "passkeys", include_str!("../../migrations/sqlite/0039_passkeys.sql")),
    (40, "revoked access", include_str!("../../migrations/sqlite/0040_revoked_access.sql")),
    (41, "room", include_str!("../../migrations/sqlite/0041_room.sql")),
    (42, "turns", include_str!("../../migrations/sqlite/0042_turns.sql")),
    (
        43,
        "shares of the record",
        include_str!("../../migrations/sqlite/0043_shares_of_the_record.sql"),
    ),
    (
        44,
        "facts of the record",
        include_str!("../../migrations/sqlite/0044_facts_of_the_record.sql"),
    ),
    (45, "former users", include_str!("../../migrations/sqlite/0045_former_users.sql")),
    (
        46,
        "ended collaborations",
        include_str!("../../migrations/sqlite/0046_ended_collaborations.sql"),
    ),
    (
        47,
        "former users of records",
        include_str!("../../migrations/sqlite/0047_former_users_of_records.sql"),
    ),
];

/// Reads of pages and exports at once; more would only share the same disk. An organisation has turns for four of them
/// ([`daemon::web::shares`]); its changes look up single rows beside.
const READERS_MAX: u32 = 6;
/// Reads that wait for no page: of sessions, sign-in, enrolments and ingest, each for a moment, and those of tasks that
/// read for nobody in particular, one each at a time: progress, receipts, overdue parts, users of the broker. Live
/// streams read none: what they send is in memory.
const RESERVED_MAX: u32 = 4;
/// Time within which all that a page reads has to be read: a page that asks for more gives its reader back to others.
const PAGE_READS_MAX: Duration = Duration::from_secs(5);
/// Steps of SQLite's machine between two looks at the clock: a millisecond at most where a disk is fast.
const STEPS_PER_LOOK: i32 = 1_000;
/// Time to wait for the lock of a command that writes beside the running platform.
const BUSY_TIMEOUT: Duration = Duration::from_secs(10);
/// Room for the statements of ingest and of pages at once; an evicted one is compiled again.
const STATEMENTS_CACHED_MAX: usize = 256;

/// The platform's database. Clones share the connections.
#[derive(Debug, Clone)]
pub struct Store {
    /// One connection: SQLite has one writer, and waiting for it here is fairer and cheaper than in
    /// its lock.
    writer: SqlitePool,
    readers: SqlitePool,
    /// Connections that no page reads by, however many there are.
    reserved: SqlitePool,
}

/// Reading side of the platform's database. Clones share the connections.
#[derive(Debug, Clone)]
pub struct StoreReader {
    pool: SqlitePool,
    /// Time within which a unit of work has to end its statements; none where it may take its time.
    reads_max: Option<Duration>,
}

impl StoreReader {
    /// Begins a unit of work that only reads, on one consistent state. A statement of a page that takes too long
    /// fails with [`StoreError::TooExpensive`].
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn read(&self) -> Result<Work, StoreError> {
        let failed = StoreError::during("begin to read");
        let mut begun = self.pool.begin().await.map_err(&failed)?;
        if let Some(reads_max) = self.reads_max {
            let end = Instant::now() + reads_max;
            let mut handle = begun.lock_handle().await.map_err(failed)?;
            handle.set_progress_handler(STEPS_PER_LOOK, move || Instant::now() < end);
        }
        Ok(Work::new(begun))
    }
}

impl Store {
    /// Opens the file, making it where there is none, and brings it to this version's form.
    ///
    /// # Errors
    /// [`StoreError::Open`] and [`StoreError::Migrate`].
    pub async fn open(path: &Path) -> Result<Self, StoreError> {
        let options = SqliteConnectOptions::new()
            .filename(path)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            // What was settled with the broker must survive a power cut.
            .synchronous(SqliteSynchronous::Full)
            .foreign_keys(true)
            .busy_timeout(BUSY_TIMEOUT)
            .statement_cache_capacity(STATEMENTS_CACHED_MAX)
            // 32 MiB; negative numbers are in KiB.
            .pragma("cache_size", "-32768")
            .pragma("temp_store", "memory");
        let failed = |source| StoreError::Open { path: path.to_owned(), source };
        let writer = SqlitePoolOptions::new()
            // SQLite has one writer. Units of work queue here, in order, and not at its lock.
            .max_connections(1)
            // A full disk makes SQLite roll back by itself, which the driver takes for an open
            // transaction for ever.
            .before_acquire(|connection, _| {
                Box::pin(async move { Ok(!connection.is_in_transaction()) })
            })
            .connect_with(options.clone())
            .await
            .map_err(failed)?;
        migrator(i64::MAX).run(&writer).await.map_err(StoreError::Migrate)?;
        // Beside the writer: with a write-ahead log reading waits for no transaction.
        let options = options.read_only(true).pragma("query_only", "true");
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS_MAX)
            // The limit of a page is none for a download that gets the connection next.
            .after_release(|connection, _| {
                Box::pin(async move {
                    connection.lock_handle().await?.remove_progress_handler();
                    Ok(true)
                })
            })
            .connect_with(options.clone())
            .await
            .map_err(failed)?;
        let reserved = SqlitePoolOptions::new()
            .max_connections(RESERVED_MAX)
            .connect_with(options)
            .await
            .map_err(failed)?;
        Ok(Self { writer, readers, reserved })
    }

    /// Begins a unit of work that may write.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn begin(&self) -> Result<Work, StoreError> {
        // IMMEDIATE takes the write lock at once, so that no statement fails half-way for lack of
        // it.
        let begun = self.writer.begin_with("BEGIN IMMEDIATE").await;
        begun.map(Work::new).map_err(StoreError::during("begin a transaction"))
    }

    /// Begins a unit of work that only reads, on one consistent state.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn read(&self) -> Result<Work, StoreError> {
        self.reader().read().await
    }

    /// Returns what reads the store and cannot change it.
    #[must_use]
    pub fn reader(&self) -> StoreReader {
        StoreReader { pool: self.readers.clone(), reads_max: None }
    }

    /// Returns what reads for pages: each has to be read within some seconds.
    #[must_use]
    pub fn page_reader(&self) -> StoreReader {
        StoreReader { reads_max: Some(PAGE_READS_MAX), ..self.reader() }
    }

    /// Returns what reads for sign-in, sessions, ingest and the platform's own tasks: it waits for no reads of pages.
    #[must_use]
    pub fn reserved_reader(&self) -> StoreReader {
        StoreReader { pool: self.reserved.clone(), reads_max: None }
    }

    /// Empties the write-ahead log, which has the pages of before, as far as nobody else reads them.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn empty_log(&self) -> Result<(), StoreError> {
        let emptied = sqlx::query("PRAGMA wal_checkpoint(TRUNCATE)").fetch_all(&self.writer).await;
        emptied.map(drop).map_err(StoreError::during("empty the write-ahead log"))
    }

    /// Closes all connections; what is committed stays.
    pub async fn close(&self) {
        self.readers.close().await;
        self.reserved.close().await;
        self.writer.close().await;
    }
}

/// The migrations up to a version.
fn migrator(newest: i64) -> Migrator {
    let wanted = MIGRATIONS.into_iter().filter(|(version, ..)| *version <= newest);
    let migrations = wanted.map(|(version, name, sql)| {
        Migration::new(version, name.into(), MigrationType::Simple, sql.into_sql_str(), false)
    });
    Migrator::with_migrations(migrations.collect())
}

#[cfg(test)]
mod tests;
