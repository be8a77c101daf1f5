//! Parts of networks: what each factory was sent, and what became of it.

use std::str::FromStr;

use asi_model::{
    DateTime, FactoryId, MessageId, OperationNetworkId, OrganisationId, messages::Fault,
};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow, document, signed},
    scope::Scope,
};

/// Progress of a part of a network towards its factory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum PartState {
    /// On its way: the factory has not answered.
    Sent,
    /// In effect at the factory.
    Accepted,
    /// In effect there already.
    Unchanged,
    /// Refused by the factory's connector, with faults; what was in effect before still is.
    Rejected,
}

impl PartState {
    /// Returns the name in the store and in the API.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Sent => "SENT",
            Self::Accepted => "ACCEPTED",
            Self::Unchanged => "UNCHANGED",
            Self::Rejected => "REJECTED",
        }
    }
}

impl FromStr for PartState {
    type Err = &'static str;
    fn from_str(text: &str) -> Result<Self, &'static str> {
        [Self::Sent, Self::Accepted, Self::Unchanged, Self::Rejected]
            .into_iter()
            .find(|state| state.as_str() == text)
            .ok_or("it is no state of a part")
    }
}

/// The newest part that a factory was sent.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkPart {
    pub operation_network_id: OperationNetworkId,
    pub factory_id: FactoryId,
    /// The network's revision in which this part changed last.
    pub revision: u64,
    /// True where the part ends the network at the factory.
    pub is_withdrawal: bool,
    /// The part's network as JSON, compared to detect changes.
    pub document: String,
    /// The message it travelled in last.
    pub message_id: MessageId,
    /// State at the factory.
    pub state: PartState,
    /// Faults for which it was rejected.
    pub fault_list: Vec<Fault>,
    /// Time of the last transmission.
    pub sent_at: DateTime,
    /// Number of transmissions.
    pub sent_count: u32,
    /// Time of the next transmission, unless it is acknowledged before.
    pub resend_at: DateTime,
    pub acknowledged_at: Option<DateTime>,
}

/// A part as a viewer may know it.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenPart {
    pub part: NetworkPart,
    /// False where the viewer may know the factory's state and nothing more of the part.
    pub is_whole: bool,
}

/// Repository of parts of networks.
pub struct Parts<'w>(pub(super) &'w mut Connection);

impl Parts<'_> {
    /// Stores a part in place of the factory's previous one.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn put(&mut self, part: &NetworkPart) -> Result<(), StoreError> {
        let sql = "INSERT INTO network_part (operation_network_id, factory_id, revision, is_withdrawal, document,
                       message_id, state, fault_list, sent_at, sent_count, resend_at, acknowledged_at)
                   VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12)
                   ON CONFLICT (operation_network_id, factory_id) DO UPDATE SET revision = excluded.revision,
                       is_withdrawal = excluded.is_withdrawal, document = excluded.document,
                       message_id = excluded.message_id, state = excluded.state, fault_list = excluded.fault_list,
                       sent_at = excluded.sent_at, sent_count = excluded.sent_count,
                       resend_at = excluded.resend_at, acknowledged_at = excluded.acknowledged_at";
        sqlx::query(sql)
            .bind(part.operation_network_id.as_str())
            .bind(part.factory_id.as_str())
            .bind(signed(part.revision))
            .bind(i64::from(part.is_withdrawal))
            .bind(&part.document)
            .bind(part.message_id.as_str())
            .bind(part.state.as_str())
            .bind(document(&part.fault_list))
            .bind(part.sent_at.ticks())
            .bind(i64::from(part.sent_count))
            .bind(part.resend_at.ticks())
            .bind(part.acknowledged_at.map(DateTime::ticks))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a part"))?;
        Ok(())
    }

    /// Lets everything that is in effect at a factory be sent once more, as when another connector
    /// speaks for it.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn send_again(
        &mut self,
        factory: &FactoryId,
        now: DateTime,
    ) -> Result<(), StoreError> {
        let sql = "UPDATE network_part SET state = 'SENT', sent_count = 0, resend_at = $2
                   WHERE factory_id = $1 AND state != 'REJECTED'";
        sqlx::query(sql)
            .bind(factory.as_str())
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("send parts again"))?;
        Ok(())
    }

    /// Lists the parts of a network for the platform's own use, by factory.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_network(
        &mut self,
        network: &OperationNetworkId,
    ) -> Result<Vec<NetworkPart>, StoreError> {
        let rows = sqlx::query(
            "SELECT * FROM network_part WHERE operation_network_id = $1 ORDER BY factory_id",
        )
        .bind(network.as_str())
        .fetch_all(&mut *self.0)
        .await
        .map_err(StoreError::during("list parts"))?;
        rows.iter().map(read).collect()
    }

    /// Lists the parts of a network that the viewer may know of, by factory.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn seen(
        &mut self,
        scope: &Scope,
        network: &OperationNetworkId,
    ) -> Result<Vec<SeenPart>, StoreError> {
        let sql = "SELECT p.*, COALESCE(r.is_whole, 1) AS is_whole FROM network_part p
                   LEFT JOIN network_part_reader r ON r.operation_network_id = p.operation_network_id
                       AND r.factory_id = p.factory_id AND r.organisation_id = $1
                   WHERE p.operation_network_id = $2
                     AND (CAST($1 AS TEXT) IS NULL OR r.is_whole IS NOT NULL)
                   ORDER BY p.factory_id";
        let rows = sqlx::query(sql)
            .bind(scope.member())
            .bind(network.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list parts for a viewer"))?;
        rows.iter()
            .map(|row| {
                let is_whole = row.unsigned::<u8>("is_whole")? != 0;
                Ok(SeenPart { part: read(row)?, is_whole })
            })
            .collect()
    }

    /// Lists the organisations that may know of a factory's part, by id: those that may know the
    /// whole of it, and those that may know the state alone.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn readers(
        &mut self,
        network: &OperationNetworkId,
        factory: &FactoryId,
    ) -> Result<(Vec<OrganisationId>, Vec<OrganisationId>), StoreError> {
        let sql = "SELECT organisation_id, is_whole FROM network_part_reader
                   WHERE operation_network_id = $1 AND factory_id = $2 ORDER BY organisation_id";
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .bind(factory.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list the readers of a part"))?;
        let (mut whole, mut others) = (Vec::new(), Vec::new());
        for row in &rows {
            let is_whole = row.unsigned::<u8>("is_whole")? != 0;
            if is_whole { &mut whole } else { &mut others }.push(row.parsed("organisation_id")?);
        }
        Ok((whole, others))
    }

    /// Returns the part of a factory that a message carried, or that belongs to a network.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_answer(
        &mut self,
        factory: &FactoryId,
        message: &MessageId,
        network: Option<&OperationNetworkId>,
    ) -> Result<Option<NetworkPart>, StoreError> {
        let sql = "SELECT * FROM network_part WHERE factory_id = $1
                   AND (message_id = $2 OR operation_network_id = $3) ORDER BY message_id = $2 DESC LIMIT 1";
        let row = sqlx::query(sql)
            .bind(factory.as_str())
            .bind(message.as_str())
            .bind(network.map(OperationNetworkId::as_str))
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("find the part of an answer"))?;
        row.as_ref().map(read).transpose()
    }

    /// Parts that nobody has answered in time and that are not waiting to be sent anyway, most
    /// overdue first. A part sent at a time yet to come was sent by a clock that has been set back
    /// since, and counts as overdue.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn overdue(
        &mut self,
        now: DateTime,
        limit: u32,
    ) -> Result<Vec<NetworkPart>, StoreError> {
        let sql = "SELECT p.* FROM network_part p WHERE p.state = 'SENT' AND (p.resend_at <= $1 OR p.sent_at > $1)
                   AND NOT EXISTS (SELECT 1 FROM outbox o WHERE o.message_id = p.message_id)
                   AND NOT EXISTS (SELECT 1 FROM factory f
                       WHERE f.factory_id = p.factory_id AND f.removed_at IS NOT NULL)
                   ORDER BY p.resend_at LIMIT $2";
        let rows = sqlx::query(sql)
            .bind(now.ticks())
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("find overdue parts"))?;
        rows.iter().map(read).collect()
    }
}

fn read(row: &DatabaseRow) -> Result<NetworkPart, StoreError> {
    Ok(NetworkPart {
        operation_network_id: row.parsed("operation_network_id")?,
        factory_id: row.parsed("factory_id")?,
        revision: row.unsigned("revision")?,
        is_withdrawal: row.unsigned::<u8>("is_withdrawal")? != 0,
        document: row.column("document")?,
        message_id: row.parsed("message_id")?,
        state: row.parsed("state")?,
        fault_list: row.json("fault_list")?,
        sent_at: row.time("sent_at")?,
        sent_count: row.unsigned("sent_count")?,
        resend_at: row.time("resend_at")?,
        acknowledged_at: row.time_option("acknowledged_at")?,
    })
}
