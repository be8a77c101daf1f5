//! Holders of credentials that were revoked and have not enrolled again.

use asi_model::DateTime;
use messaging::LogicalAddress;

use super::{database::Connection, error::StoreError, holder::Holder, row::Columns};

/// Code of messages that wait until their reader has access again.
const HELD: &str = "ACCESS_REVOKED";

/// Repository of revoked access.
pub struct RevokedAccess<'w>(pub(super) &'w mut Connection);

impl RevokedAccess<'_> {
    /// Records that a holder has no access any more. What waits for it stays where it is.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn revoke(&mut self, holder: &Holder, now: DateTime) -> Result<(), StoreError> {
        let sql = "INSERT INTO revoked_access (user_name, revoked_at) VALUES ($1, $2)
                   ON CONFLICT (user_name) DO NOTHING";
        sqlx::query(sql)
            .bind(holder.user_name())
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("record a revocation"))?;
        for address in holder.reads() {
            let sql =
                "UPDATE outbox SET parked_code = $2 WHERE address = $1 AND parked_code IS NULL";
            sqlx::query(sql)
                .bind(address.to_string())
                .bind(HELD)
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("hold messages back"))?;
        }
        Ok(())
    }

    /// Gives a holder access again. What waited for it is sent after all else.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn admit(&mut self, holder: &Holder) -> Result<(), StoreError> {
        let removed = sqlx::query("DELETE FROM revoked_access WHERE user_name = $1")
            .bind(holder.user_name())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("end a revocation"))?;
        if removed.rows_affected() == 0 {
            return Ok(());
        }
        for address in holder.reads() {
            // With new numbers: the link has gone past the old ones.
            for sql in [
                "INSERT INTO outbox (address, message_id, subject, correlation_id, created_at, time_to_live_ms,
                     content_encoding, body, attempts)
                 SELECT address, message_id, subject, correlation_id, created_at, time_to_live_ms, content_encoding,
                     body, attempts FROM outbox WHERE address = $1 AND parked_code = $2 ORDER BY outbox_id",
                "DELETE FROM outbox WHERE address = $1 AND parked_code = $2",
            ] {
                sqlx::query(sql)
                    .bind(address.to_string())
                    .bind(HELD)
                    .execute(&mut *self.0)
                    .await
                    .map_err(StoreError::during("send what was held back"))?;
            }
        }
        Ok(())
    }

    /// Returns when the access of the reader or writer of an address was revoked.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of(&mut self, address: &LogicalAddress) -> Result<Option<DateTime>, StoreError> {
        let Some(holder) = Holder::of(address) else { return Ok(None) };
        let row = sqlx::query("SELECT revoked_at FROM revoked_access WHERE user_name = $1")
            .bind(holder.user_name())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("ask for a revocation"))?;
        row.map(|row| row.time("revoked_at")).transpose()
    }

    /// Holds messages back that were just added for a holder without access.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub(super) async fn hold_new(
        &mut self,
        address: &LogicalAddress,
        message_id: &str,
    ) -> Result<(), StoreError> {
        if self.of(address).await?.is_none() {
            return Ok(());
        }
        let sql = "UPDATE outbox SET parked_code = $3
                   WHERE address = $1 AND message_id = $2 AND parked_code IS NULL";
        sqlx::query(sql)
            .bind(address.to_string())
            .bind(message_id)
            .bind(HELD)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("hold a message back"))?;
        Ok(())
    }
}
