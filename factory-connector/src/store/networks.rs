//! Operation networks: the newest message of each, and the one before.

use asi_model::{OperationNetworkId, messages::OperationNetworkMessage};
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    NetworkRow, StoredNetwork,
    error::StoreError,
    names::Named,
    query::{all, optional, query},
    row::{Columns as _, signed},
    statement::write_rows,
};

/// State of a network. A withdrawn one stays as a tombstone without a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NetworkState {
    Active,
    Withdrawn,
}

impl Named for NetworkState {
    const ALL: &'static [Self] = &[Self::Active, Self::Withdrawn];

    fn name(self) -> &'static str {
        match self {
            Self::Active => "ACTIVE",
            Self::Withdrawn => "WITHDRAWN",
        }
    }
}

/// The two newest revisions of an active network.
#[derive(Debug, Clone)]
pub struct Revisions {
    /// The message in force.
    pub current: OperationNetworkMessage,
    /// The message before it; `None` for a network that was never changed.
    pub previous: Option<OperationNetworkMessage>,
}

/// Repository of operation networks.
pub struct Networks<'c>(pub(super) &'c mut SqliteConnection);

impl Networks<'_> {
    /// Reads all networks, withdrawn ones included.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<Vec<StoredNetwork>, StoreError> {
        let sql = "SELECT operation_network_id, revision, message, received_at FROM network";
        all(self.0, query(sql), "read the networks", network).await
    }

    /// Reads the two newest revisions of a network; `None` for an unknown or withdrawn one.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn revisions(
        &mut self,
        id: &OperationNetworkId,
    ) -> Result<Option<Revisions>, StoreError> {
        let sql = "SELECT message, previous_message FROM network WHERE operation_network_id = ?";
        let query = query(sql).bind(id.as_str());
        let found = optional(self.0, query, "read a network's revisions", |row| {
            let current = row.document_option("message")?;
            let previous = row.document_option("previous_message")?;
            Ok(current.map(|current| Revisions { current, previous }))
        });
        Ok(found.await?.flatten())
    }
}

fn network(row: &SqliteRow) -> Result<StoredNetwork, StoreError> {
    Ok(StoredNetwork {
        operation_network_id: row.parsed("operation_network_id")?,
        revision: row.number("revision")?,
        message: row.document_option("message")?,
        received_at: row.time("received_at")?,
    })
}

/// Stores new revisions and withdrawals.
pub(super) fn write(connection: &Connection, networks: &[NetworkRow]) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO network (operation_network_id, revision, state, message, received_at)
         VALUES (?, ?, ?, ?, ?)
         ON CONFLICT (operation_network_id) DO UPDATE SET
             revision = excluded.revision, state = excluded.state,
             previous_message = iif(excluded.message IS NULL, NULL, network.message),
             message = excluded.message, received_at = excluded.received_at",
        networks,
        |network| {
            let state = match network.message {
                Some(_) => NetworkState::Active,
                None => NetworkState::Withdrawn,
            };
            (
                network.operation_network_id.as_str(),
                signed(network.revision),
                state.name(),
                &network.message,
                network.received_at.unix_micros(),
            )
        },
    )
}
