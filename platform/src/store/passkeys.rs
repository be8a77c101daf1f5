//! Passkeys of users.

use asi_model::DateTime;
use daemon::web::session::{PASSKEYS_MAX, PasskeyUse, StoredPasskey};

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow, signed},
};

/// Repository of passkeys.
pub struct Passkeys<'w>(pub(super) &'w mut Connection);

impl Passkeys<'_> {
    /// Reads the passkeys of a user, the oldest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of(&mut self, user_name: &str) -> Result<Vec<StoredPasskey>, StoreError> {
        let sql = "SELECT * FROM passkey WHERE user_name = $1 ORDER BY created_at, passkey_id";
        let rows = sqlx::query(sql).bind(user_name).fetch_all(&mut *self.0).await;
        rows.map_err(StoreError::during("list passkeys"))?.iter().map(read).collect()
    }

    /// Adds a passkey of a user. False where its credential is stored already, or the user has
    /// [`PASSKEYS_MAX`].
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown user.
    pub async fn add(
        &mut self,
        user_name: &str,
        passkey: &StoredPasskey,
    ) -> Result<bool, StoreError> {
        let sql = "INSERT INTO passkey (passkey_id, user_name, name, credential_id, user_handle,
                                        transports, static_state, dynamic_state, created_at)
                   SELECT $1, $2, $3, $4, $5, $6, $7, $8, $9
                   WHERE (SELECT count(*) FROM passkey WHERE user_name = $2) < $10
                   ON CONFLICT (credential_id) DO NOTHING";
        let done = sqlx::query(sql)
            .bind(&passkey.passkey_id)
            .bind(user_name)
            .bind(&passkey.name)
            .bind(&passkey.credential_id)
            .bind(passkey.user_handle.as_slice())
            .bind(i64::from(passkey.transports))
            .bind(&passkey.static_state)
            .bind(passkey.dynamic_state.as_slice())
            .bind(DateTime::from(passkey.created_at).ticks())
            .bind(signed(PASSKEYS_MAX as u64))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("add a passkey"))?;
        Ok(done.rows_affected() > 0)
    }

    /// Notes that a passkey was used; false if it was removed or used meanwhile.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn note_use(
        &mut self,
        user_name: &str,
        used: &PasskeyUse,
    ) -> Result<bool, StoreError> {
        let sql = "UPDATE passkey SET dynamic_state = $1, last_used_at = $2
                   WHERE passkey_id = $3 AND user_name = $4 AND dynamic_state = $5";
        let done = sqlx::query(sql)
            .bind(used.dynamic_state.as_slice())
            .bind(DateTime::from(used.at).ticks())
            .bind(&used.passkey_id)
            .bind(user_name)
            .bind(used.former_state.as_slice())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note the use of a passkey"))?;
        Ok(done.rows_affected() > 0)
    }

    /// Removes a passkey of a user; false if there was none.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn remove(&mut self, user_name: &str, passkey_id: &str) -> Result<bool, StoreError> {
        let done = sqlx::query("DELETE FROM passkey WHERE passkey_id = $1 AND user_name = $2")
            .bind(passkey_id)
            .bind(user_name)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("remove a passkey"))?;
        Ok(done.rows_affected() > 0)
    }

    /// Removes all passkeys of a user; false if there were none.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn remove_all(&mut self, user_name: &str) -> Result<bool, StoreError> {
        let done = sqlx::query("DELETE FROM passkey WHERE user_name = $1")
            .bind(user_name)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("remove passkeys"))?;
        Ok(done.rows_affected() > 0)
    }
}

fn read(row: &DatabaseRow) -> Result<StoredPasskey, StoreError> {
    let time = |time: DateTime| time::OffsetDateTime::from(time).into();
    Ok(StoredPasskey {
        passkey_id: row.column("passkey_id")?,
        name: row.column("name")?,
        credential_id: row.column("credential_id")?,
        user_handle: row.bytes("user_handle")?,
        transports: row.unsigned("transports")?,
        static_state: row.column("static_state")?,
        dynamic_state: row.bytes("dynamic_state")?,
        created_at: time(row.time("created_at")?),
        last_used_at: row.time_option("last_used_at")?.map(time),
    })
}
