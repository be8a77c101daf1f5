//! Messages as they came. Storing one says whether it is new: repeats are discarded in the
//! transaction of their effect.

use std::collections::HashSet;

use asi_model::{DateTime, MessageId};
use sqlx::QueryBuilder;

use super::{
    database::{Connection, Database},
    error::StoreError,
    row::Columns,
};

/// A message that arrived.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewInboxMessage {
    /// Its id; unique per address.
    pub message_id: MessageId,
    /// Type of the message, for example `ua-data`.
    pub message_type: String,
    /// Time of arrival at the platform.
    pub received_at: DateTime,
    /// Its body, unpacked.
    pub body: String,
}

/// Repository of messages as they came.
pub struct InboxMessages<'w>(pub(super) &'w mut Connection);

/// Five parameters each, well below the 32766 of SQLite; larger statements gain nothing.
const ROWS_PER_STATEMENT: usize = 200;

impl InboxMessages<'_> {
    /// Stores messages of one address; returns the ids of those that are new.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn store(
        &mut self,
        address: &str,
        messages: &[NewInboxMessage],
    ) -> Result<HashSet<MessageId>, StoreError> {
        let mut new = HashSet::with_capacity(messages.len());
        for chunk in messages.chunks(ROWS_PER_STATEMENT) {
            let mut query = QueryBuilder::<Database>::new(
                "INSERT INTO inbox_message (address, message_id, message_type, received_at, body) ",
            );
            query.push_values(chunk, |mut row, message| {
                row.push_bind(address)
                    .push_bind(message.message_id.as_str())
                    .push_bind(&message.message_type)
                    .push_bind(message.received_at.ticks())
                    .push_bind(&message.body);
            });
            // The unique index decides, so that two messages with one id in a batch count once as
            // well.
            query.push(" ON CONFLICT (address, message_id) DO NOTHING RETURNING message_id");
            let rows = query
                .build()
                .fetch_all(&mut *self.0)
                .await
                .map_err(StoreError::during("store messages"))?;
            for row in &rows {
                new.insert(row.parsed("message_id")?);
            }
        }
        Ok(new)
    }

    /// Forgets one message, so that it may be taken again.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn forget_one(&mut self, address: &str, message_id: &str) -> Result<(), StoreError> {
        sqlx::query("DELETE FROM inbox_message WHERE address = $1 AND message_id = $2")
            .bind(address)
            .bind(message_id)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget a message"))?;
        Ok(())
    }

    /// Forgets messages that arrived before a time, at most `limit` at once; how many.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn forget(&mut self, before: DateTime, limit: u32) -> Result<u64, StoreError> {
        let sql = "DELETE FROM inbox_message WHERE inbox_message_id IN (
                       SELECT inbox_message_id FROM inbox_message WHERE received_at < $1 LIMIT $2)";
        let result = sqlx::query(sql)
            .bind(before.ticks())
            .bind(i64::from(limit))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget old messages"))?;
        Ok(result.rows_affected())
    }
}
