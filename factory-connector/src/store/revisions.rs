//! The two newest revisions of a network.

use asi_model::{OperationNetworkId, messages::OperationNetworkMessage};
use sqlx::SqlitePool;

use super::{
    StoreError,
    load::{get, json},
};

/// A network's message in force and the one before it.
#[derive(Debug, Clone)]
pub struct Revisions {
    /// In force.
    pub current: OperationNetworkMessage,
    /// Before it, where there was one.
    pub previous: Option<OperationNetworkMessage>,
}

/// The two newest revisions of an active network.
///
/// # Errors
/// [`StoreError`] where the table or a document cannot be read.
pub async fn revisions(
    readers: &SqlitePool,
    id: &OperationNetworkId,
) -> Result<Option<Revisions>, StoreError> {
    let row =
        sqlx::query("SELECT message, previous_message FROM network WHERE operation_network_id = ?")
            .bind(id.as_str())
            .fetch_optional(readers)
            .await
            .map_err(StoreError::while_doing("read a network's revisions"))?;
    let Some(row) = row else { return Ok(None) };
    let (current, previous): (Option<String>, Option<String>) = (get(&row, 0)?, get(&row, 1)?);
    let Some(current) = current else { return Ok(None) };
    let previous = previous.map(|text| json(&text, "network")).transpose()?;
    Ok(Some(Revisions { current: json(&current, "network")?, previous }))
}
