//! Identity of the store: the factory it belongs to, the place where it is in use, and the lease.

use asi_model::{DateTime, FactoryId, InstanceId, PlaceId};
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    error::StoreError,
    query::{optional, query},
    row::Columns as _,
    statement::run,
};

/// Identity of an open store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoreIdentity {
    /// The factory that the store belongs to.
    pub factory_id: FactoryId,
    /// Numbers that were given since the file was written may be unknown to it: it is an older
    /// copy of the one that was used last, or was moved or copied to where it is used now, or its
    /// machine was restarted and may be a copy itself. Holds until every writer has begun a new
    /// epoch.
    pub is_restored: bool,
    /// Id of this start.
    pub instance_id: InstanceId,
    /// Place where the file is in use: no two living processes are at one place.
    pub place: PlaceId,
    /// The same place as people name it.
    pub host: String,
    /// The lease on the factory's identity was granted last at this place, and not refused since.
    pub was_lease_held: bool,
}

/// Facts of a start that are known before the store is read.
pub(super) struct Start<'a> {
    /// Generation in the file beside the database; `None` where that is missing.
    pub known_generation: Option<&'a str>,
    pub instance_id: InstanceId,
    pub place: PlaceId,
    pub host: String,
    pub at: DateTime,
}

/// Row of the table `identity`, which has exactly one.
struct StoredIdentity {
    factory_id: String,
    generation: String,
    place: Option<String>,
    must_begin_epochs: bool,
    leased_place: Option<String>,
}

impl StoredIdentity {
    /// Another generation than that of the file beside the database says that the database was
    /// exchanged for an older copy; another place, that both were moved or copied.
    fn is_restored(&self, start: &Start<'_>) -> bool {
        let is_exchanged = start.known_generation.is_none_or(|known| known != self.generation);
        let is_elsewhere = self.place.as_ref().is_some_and(|place| *place != start.place.as_str());
        is_exchanged || is_elsewhere || self.must_begin_epochs
    }
}

/// Reads or writes the identity, and marks this start in it.
///
/// # Errors
/// [`StoreError::ForeignFactory`], or where the table cannot be read or written.
pub(super) async fn identify(
    connection: &mut SqliteConnection,
    factory_id: &FactoryId,
    start: Start<'_>,
) -> Result<StoreIdentity, StoreError> {
    let query = query("SELECT * FROM identity");
    let stored = optional(connection, query, "read the store's identity", identity).await?;
    if let Some(foreign) = stored.as_ref().filter(|row| row.factory_id != factory_id.as_str()) {
        let (found, configured) = (foreign.factory_id.clone(), factory_id.to_string());
        return Err(StoreError::ForeignFactory { found, configured });
    }
    let is_restored = stored.as_ref().is_some_and(|stored| stored.is_restored(&start));
    let leased_place = stored.and_then(|stored| stored.leased_place);
    mark(connection, factory_id, &start, is_restored).await?;
    Ok(StoreIdentity {
        factory_id: factory_id.clone(),
        is_restored,
        instance_id: start.instance_id,
        was_lease_held: leased_place.is_some_and(|place| place == start.place.as_str()),
        place: start.place,
        host: start.host,
    })
}

fn identity(row: &SqliteRow) -> Result<StoredIdentity, StoreError> {
    Ok(StoredIdentity {
        factory_id: row.column("factory_id")?,
        generation: row.column("generation")?,
        place: row.column("place")?,
        must_begin_epochs: row.flag("must_begin_epochs")?,
        leased_place: row.column("leased_place")?,
    })
}

async fn mark(
    connection: &mut SqliteConnection,
    factory_id: &FactoryId,
    start: &Start<'_>,
    is_restored: bool,
) -> Result<(), StoreError> {
    let sql =
        "INSERT INTO identity (id, factory_id, generation, created_at, place, must_begin_epochs)
               VALUES (1, ?, ?, ?, ?, ?)
               ON CONFLICT (id) DO UPDATE SET
                   generation = excluded.generation, place = excluded.place,
                   must_begin_epochs = excluded.must_begin_epochs";
    query(sql)
        .bind(factory_id.as_str())
        .bind(start.instance_id.as_str())
        .bind(start.at.unix_micros())
        .bind(start.place.as_str())
        .bind(i64::from(is_restored))
        .execute(connection)
        .await
        .map_err(StoreError::while_doing("mark this start in the store"))?;
    Ok(())
}

/// Notes that every writer has begun a new epoch: from now on the store is as any other.
pub(super) fn end_restoration(connection: &Connection) -> rusqlite::Result<()> {
    run(connection, "UPDATE identity SET must_begin_epochs = 0", ()).map(drop)
}

/// Notes that the chains state what former versions emptied and removed.
pub(super) fn end_former_retention(connection: &Connection) -> rusqlite::Result<()> {
    run(connection, "UPDATE identity SET must_state_retention = 0", ()).map(drop)
}

/// Returns whether the chains do not state yet what former versions emptied and removed.
pub(super) async fn must_state_retention(
    connection: &mut SqliteConnection,
) -> Result<bool, StoreError> {
    let query = query("SELECT must_state_retention FROM identity");
    let flag = |row: &SqliteRow| row.flag("must_state_retention");
    Ok(optional(connection, query, "read the store's identity", flag).await?.unwrap_or(false))
}

/// Notes that the lease was granted at this place, or refused.
pub(super) fn write_lease(connection: &Connection, is_held: bool) -> rusqlite::Result<()> {
    run(connection, "UPDATE identity SET leased_place = iif(?, place, NULL)", (is_held,)).map(drop)
}
