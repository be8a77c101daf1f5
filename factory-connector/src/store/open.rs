//! Opening the file: one process at a time, tables up to date, restored copies recognised.

use std::{
    fs::{File, TryLockError},
    path::{Path, PathBuf},
    time::Duration,
};

use asi_model::{DateTime, FactoryId, InstanceId, PlaceId};
use sqlx::{
    ConnectOptions as _, Connection as _, Row as _, SqlSafeStr as _, SqliteConnection, SqlitePool,
    migrate::{Migration, MigrationType, Migrator},
    sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous},
};
use uuid::Uuid;

use super::{
    StoreError,
    place::{host_of, place_of},
    writer::Writer,
};

/// The migrations, oldest first. They only go forward and never change after a release.
const MIGRATIONS: &[(i64, &str, &str)] = &[
    (1, "initial", include_str!("../../migrations/0001_initial.sql")),
    (10, "mapping versions", include_str!("../../migrations/0010_mapping_versions.sql")),
    (20, "policies", include_str!("../../migrations/0020_policies.sql")),
    (21, "previous revision", include_str!("../../migrations/0021_previous_revision.sql")),
    (30, "operator entries", include_str!("../../migrations/0030_operator_entries.sql")),
    (31, "revocations", include_str!("../../migrations/0031_revocations.sql")),
    (32, "ledger ends", include_str!("../../migrations/0032_ledger_ends.sql")),
    (33, "ledger lookup", include_str!("../../migrations/0033_ledger_lookup.sql")),
    (40, "places", include_str!("../../migrations/0040_places.sql")),
];

const DATABASE_FILE: &str = "connector.sqlite";
const LOCK_FILE: &str = "connector.lock";
const GENERATION_FILE: &str = "generation";
const READERS_MAX: u32 = 4;
const BUSY_TIMEOUT: Duration = Duration::from_secs(10);
/// The write-ahead log is cut back to this after a checkpoint, in bytes.
const LOG_BYTES: &str = "67108864";

/// Who a store belongs to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity {
    /// The factory.
    pub factory_id: FactoryId,
    /// What was numbered since the file was written may be unknown to it: it is an older copy of
    /// the one that was used last, or was moved or copied to where it is used now, or its machine
    /// was started anew and may be a copy itself. Holds until every writer has begun a new epoch.
    pub is_restored: bool,
    /// This start.
    pub instance_id: InstanceId,
    /// Where the file is in use: no two living processes are at one place.
    pub place: PlaceId,
    /// The same for people.
    pub host: String,
    /// The lease on the factory's identity was granted last at this place, and not refused since.
    pub was_lease_held: bool,
}

/// The open file. Its first two connections are the desk's alone.
pub struct Store {
    pub(super) writer: Writer,
    /// Sees what was written last, and waits for no other reader.
    pub(super) reader: SqliteConnection,
    pub(super) readers: SqlitePool,
    identity: Identity,
    directory: PathBuf,
    /// Held as long as the store is open; a second connector finds it locked.
    _lock: File,
}

impl Store {
    /// Opens the store in a folder, making both where they are missing.
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
        std::fs::create_dir_all(directory).map_err(access(directory))?;
        let lock = lock(directory)?;
        let database = directory.join(DATABASE_FILE);
        let mut reader = options(&database)
            .create_if_missing(true)
            .connect()
            .await
            .map_err(StoreError::while_doing("open the store"))?;
        migrator().run(&mut reader).await?;
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
        let identity = identify(&mut reader, factory_id, start).await?;
        std::fs::write(&generation_file, identity.instance_id.as_str())
            .map_err(access(&generation_file))?;
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS_MAX)
            .connect_with(options(&database).read_only(true))
            .await
            .map_err(StoreError::while_doing("open the store for reading"))?;
        let writer = Writer::open(&database, BUSY_TIMEOUT, LOG_BYTES)?;
        Ok(Self { writer, reader, readers, identity, directory: directory.to_owned(), _lock: lock })
    }

    /// Opens the store beside a running connector, for a command that reads or changes people.
    ///
    /// # Errors
    /// [`StoreError`] where there is no store.
    pub async fn connect(directory: &Path) -> Result<SqliteConnection, StoreError> {
        let mut connection = options(&directory.join(DATABASE_FILE))
            .create_if_missing(true)
            .connect()
            .await
            .map_err(StoreError::while_doing("open the store"))?;
        migrator().run(&mut connection).await?;
        Ok(connection)
    }

    /// Whose the store is.
    #[must_use]
    pub const fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The folder.
    #[must_use]
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// Connections for reading.
    #[must_use]
    pub fn readers(&self) -> SqlitePool {
        self.readers.clone()
    }

    /// Closes the file in good order.
    pub async fn close(self) {
        self.readers.close().await;
        // What is left open is closed by the thread that writes, or recovered at the next start.
        drop(self.reader.close().await);
        self.writer.close().await;
    }
}

fn options(database: &Path) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(database)
        .journal_mode(SqliteJournalMode::Wal)
        .synchronous(SqliteSynchronous::Full)
        .foreign_keys(true)
        .busy_timeout(BUSY_TIMEOUT)
        .pragma("journal_size_limit", LOG_BYTES)
        .disable_statement_logging()
}

fn migrator() -> Migrator {
    let migrations = MIGRATIONS.iter().map(|&(version, name, sql)| {
        Migration::new(version, name.into(), MigrationType::Simple, sql.into_sql_str(), false)
    });
    Migrator::with_migrations(migrations.collect())
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

/// What is known of a start before the store is read.
struct Start<'a> {
    known_generation: Option<&'a str>,
    instance_id: InstanceId,
    place: PlaceId,
    host: String,
    at: DateTime,
}

/// Reads or writes the identity, and marks this start in it. A generation that differs from the one
/// in the file beside the database tells that the database was exchanged for an older copy; another
/// place, that both were moved or copied.
async fn identify(
    connection: &mut SqliteConnection,
    factory_id: &FactoryId,
    start: Start<'_>,
) -> Result<Identity, StoreError> {
    let Start { known_generation, instance_id, place, host, at } = start;
    let failed = || StoreError::while_doing("read the store's identity");
    let stored = sqlx::query(
        "SELECT factory_id, generation, place, must_begin_epochs, leased_place FROM identity",
    )
    .fetch_optional(&mut *connection)
    .await
    .map_err(failed())?;
    let (is_restored, was_lease_held) = match stored {
        None => (false, false),
        Some(row) => {
            let found: String = row.try_get(0).map_err(failed())?;
            let generation: String = row.try_get(1).map_err(failed())?;
            let former: Option<String> = row.try_get(2).map_err(failed())?;
            let must_begin_epochs: i64 = row.try_get(3).map_err(failed())?;
            let leased: Option<String> = row.try_get(4).map_err(failed())?;
            if found != factory_id.as_str() {
                return Err(StoreError::ForeignFactory { found, wanted: factory_id.to_string() });
            }
            let is_exchanged = known_generation.is_none_or(|known| known != generation);
            let is_elsewhere = former.is_some_and(|former| former != place.as_str());
            (
                is_exchanged || is_elsewhere || must_begin_epochs != 0,
                leased.is_some_and(|at| at == place.as_str()),
            )
        }
    };
    sqlx::query(
        "INSERT INTO identity (id, factory_id, generation, created_at, place, must_begin_epochs) \
         VALUES (1, ?, ?, ?, ?, ?) ON CONFLICT (id) DO UPDATE SET generation = excluded.generation, \
         place = excluded.place, must_begin_epochs = excluded.must_begin_epochs",
    )
    .bind(factory_id.as_str())
    .bind(instance_id.as_str())
    .bind(at.unix_micros())
    .bind(place.as_str())
    .bind(i64::from(is_restored))
    .execute(connection)
    .await
    .map_err(StoreError::while_doing("mark this start in the store"))?;
    Ok(Identity {
        factory_id: factory_id.clone(),
        is_restored,
        instance_id,
        place,
        host,
        was_lease_held,
    })
}
