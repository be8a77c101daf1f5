//! Handle of the open file: one process at a time, tables up to date, restored copies recognised.

use std::{
    fs::{File, TryLockError},
    path::{Path, PathBuf},
    time::Duration,
};

use asi_model::{DateTime, FactoryId, InstanceId};
use rusqlite::Transaction;
use sqlx::{
    ConnectOptions as _, SqlitePool,
    sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous},
};
use uuid::Uuid;

use super::{
    Snapshot, Writes, commit,
    error::StoreError,
    identity::{Start, StoreIdentity, identify},
    load,
    migrations::migrate,
    place::{host_of, place_of},
    session::{ReaderPools, Readers, StoreSession},
    write_connection::WriteConnection,
};

const DATABASE_FILE: &str = "connector.sqlite";
const LOCK_FILE: &str = "connector.lock";
const GENERATION_FILE: &str = "generation";
/// Readers of pages wait for each other here and never delay the writer; pages need few.
const READERS_MAX: u32 = 4;
/// Readers apart from those of pages, so that nobody stops reports or sign-in by asking for much.
const RESERVED_READERS_MAX: u32 = 2;
/// Time to wait for the lock of a command that changes users beside the running connector.
const BUSY_TIMEOUT: Duration = Duration::from_secs(10);
/// Rows that are read before they are taken: reader and taker are threads, and seldom wait for each
/// other so. Most queries yield fewer.
const ROWS_AHEAD: usize = 1024;
/// Size to which the write-ahead log is cut back after a checkpoint, in bytes.
const LOG_BYTES: &str = "67108864";

/// The open file. Its own session and the writing connection serve its owner alone.
pub struct Store {
    writer: WriteConnection,
    /// Sees each transaction once it is committed, and waits for no other reader.
    session: StoreSession,
    readers: Readers,
    identity: StoreIdentity,
    directory: PathBuf,
    /// Locked as long as the store is open; a second connector is refused by it.
    _lock: File,
}

impl Store {
    /// Opens the store in a folder, making it where it is missing.
    ///
    /// # Errors
    /// [`StoreError`] where the folder is in use, belongs to another factory, or cannot be read and
    /// written.
    pub async fn open(
        directory: &Path,
        factory_id: &FactoryId,
        now: DateTime,
    ) -> Result<Self, StoreError> {
        let access = |path: &Path| {
            let path = path.to_owned();
            move |source| StoreError::Access { path, source }
        };
        // Before the file is opened: a second connector must not even bring its tables up to date.
        let lock = lock(directory)?;
        let mut session = Self::connect(directory).await?;
        let generation_file = directory.join(GENERATION_FILE);
        let known = std::fs::read_to_string(&generation_file).ok();
        let instance_id =
            InstanceId::new(Uuid::new_v4().to_string()).expect("a UUID makes an instance id");
        let start = Start {
            known_generation: known.as_deref(),
            instance_id,
            place: place_of(&lock).map_err(access(directory))?,
            host: host_of(directory),
            at: now,
        };
        let identity = identify(session.connection(), factory_id, start).await?;
        std::fs::write(&generation_file, identity.instance_id.as_str())
            .map_err(access(&generation_file))?;
        let database = directory.join(DATABASE_FILE);
        let pools = ReaderPools {
            pages: open_readers(&database, READERS_MAX).await?,
            sign_in: open_readers(&database, RESERVED_READERS_MAX).await?,
            spool: open_readers(&database, RESERVED_READERS_MAX).await?,
        };
        Ok(Self {
            writer: WriteConnection::open(&database, BUSY_TIMEOUT, LOG_BYTES)?,
            session,
            readers: Readers::new(pools),
            identity,
            directory: directory.to_owned(),
            _lock: lock,
        })
    }

    /// Opens the store beside a running connector, for a command that reads or that changes users
    /// or the enrolment.
    ///
    /// # Errors
    /// [`StoreError`] where the file cannot be opened, or its tables not be brought up to date.
    pub async fn connect(directory: &Path) -> Result<StoreSession, StoreError> {
        let mut connection = options(&directory.join(DATABASE_FILE))
            .create_if_missing(true)
            .connect()
            .await
            .map_err(StoreError::while_doing("open the store"))?;
        migrate(&mut connection).await?;
        Ok(StoreSession::new(connection))
    }

    /// Returns factory, place and lease of the store.
    #[must_use]
    pub const fn identity(&self) -> &StoreIdentity {
        &self.identity
    }

    /// Returns the folder of the store.
    #[must_use]
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// Returns connections for pages to read.
    #[must_use]
    pub fn readers(&self) -> Readers {
        self.readers.clone()
    }

    /// Reads through the owner's connection.
    pub const fn read(&mut self) -> &mut StoreSession {
        &mut self.session
    }

    /// Reads everything that the connector has in memory.
    ///
    /// # Errors
    /// [`StoreError`] where a table or a document cannot be read.
    pub async fn load(&mut self) -> Result<Snapshot, StoreError> {
        load::load(&mut self.session).await
    }

    /// Writes everything or nothing.
    ///
    /// # Errors
    /// [`StoreError::Write`]; then nothing was written.
    pub async fn commit(&mut self, writes: Writes) -> Result<(), StoreError> {
        let action = "write a transaction";
        let work = move |connection: &Transaction<'_>| {
            commit::write(connection, &writes).map_err(StoreError::while_writing(action))
        };
        self.writer.transact(action, work).await
    }

    /// Closes the file in good order.
    pub async fn close(self) {
        self.readers.close().await;
        self.session.close().await;
        self.writer.close().await;
    }
}

async fn open_readers(database: &Path, connections_max: u32) -> Result<SqlitePool, StoreError> {
    SqlitePoolOptions::new()
        .max_connections(connections_max)
        // The limit of a page is none for an export that gets the connection next.
        .after_release(|connection, _| {
            Box::pin(async move {
                connection.lock_handle().await?.remove_progress_handler();
                Ok(true)
            })
        })
        // So that nothing is written beside the one connection that writes.
        .connect_with(options(database).read_only(true))
        .await
        .map_err(StoreError::while_doing("open the store for reading"))
}

fn options(database: &Path) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(database)
        .journal_mode(SqliteJournalMode::Wal)
        .synchronous(SqliteSynchronous::Full)
        .foreign_keys(true)
        .busy_timeout(BUSY_TIMEOUT)
        .row_buffer_size(ROWS_AHEAD)
        .pragma("journal_size_limit", LOG_BYTES)
        .disable_statement_logging()
}

fn lock(directory: &Path) -> Result<File, StoreError> {
    let path = directory.join(LOCK_FILE);
    let access = |source| StoreError::Access { path: path.clone(), source };
    let file =
        File::options().create(true).truncate(false).write(true).open(&path).map_err(access)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(StoreError::InUse { path: directory.to_owned() }),
        Err(TryLockError::Error(source)) => Err(access(source)),
    }
}
