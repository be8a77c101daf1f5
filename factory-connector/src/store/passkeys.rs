//! Passkeys of people at the pages.

use asi_model::DateTime;
use daemon::web::session::{PASSKEYS_MAX, PasskeyUse, StoredPasskey};
use sqlx::{Connection as _, SqliteConnection, sqlite::SqliteRow};

use super::{
    error::StoreError,
    query::{all, query},
    row::{Columns as _, signed},
    second_factors::SecondFactors,
};

/// Repository of passkeys; written beside the connector's transactions, as users are.
pub struct Passkeys<'c>(pub(super) &'c mut SqliteConnection);

impl Passkeys<'_> {
    /// Reads the passkeys of a person, the oldest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of(&mut self, user_name: &str) -> Result<Vec<StoredPasskey>, StoreError> {
        let sql = "SELECT * FROM passkey WHERE user_name = ? ORDER BY created_at, passkey_id";
        all(self.0, query(sql).bind(user_name.to_owned()), "list passkeys", passkey).await
    }

    /// Adds a passkey of a person, with recovery codes in place of others where there are new ones. False
    /// where its credential is stored already, or the person has [`PASSKEYS_MAX`].
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be written.
    pub async fn add(
        &mut self,
        user_name: &str,
        passkey: &StoredPasskey,
        recovery_digests: Option<&[String]>,
    ) -> Result<bool, StoreError> {
        let during = StoreError::while_doing("add a passkey");
        let mut transaction = self.0.begin().await.map_err(during)?;
        let sql = "INSERT INTO passkey (passkey_id, user_name, name, credential_id, user_handle,
                                        transports, static_state, dynamic_state, created_at)
                   SELECT ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9
                   WHERE (SELECT count(*) FROM passkey WHERE user_name = ?2) < ?10
                   ON CONFLICT (credential_id) DO NOTHING";
        let done = query(sql)
            .bind(passkey.passkey_id.clone())
            .bind(user_name.to_owned())
            .bind(passkey.name.clone())
            .bind(passkey.credential_id.clone())
            .bind(passkey.user_handle.to_vec())
            .bind(i64::from(passkey.transports))
            .bind(passkey.static_state.clone())
            .bind(passkey.dynamic_state.to_vec())
            .bind(DateTime::from(passkey.created_at).unix_micros())
            .bind(signed(PASSKEYS_MAX as u64))
            .execute(&mut *transaction)
            .await
            .map_err(StoreError::while_doing("add a passkey"))?;
        let is_new = done.rows_affected() > 0;
        if is_new && let Some(digests) = recovery_digests {
            let mut factors = SecondFactors(&mut transaction);
            factors.put_recovery_digests(user_name, digests).await?;
        }
        transaction.commit().await.map_err(StoreError::while_doing("add a passkey"))?;
        Ok(is_new)
    }

    /// Notes that a passkey was used; false if it was removed or used meanwhile.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn note_use(
        &mut self,
        user_name: &str,
        used: &PasskeyUse,
    ) -> Result<bool, StoreError> {
        let sql = "UPDATE passkey SET dynamic_state = ?, last_used_at = ?
                   WHERE passkey_id = ? AND user_name = ? AND dynamic_state = ?";
        let done = query(sql)
            .bind(used.dynamic_state.to_vec())
            .bind(DateTime::from(used.at).unix_micros())
            .bind(used.passkey_id.clone())
            .bind(user_name.to_owned())
            .bind(used.former_state.to_vec())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("note the use of a passkey"))?;
        Ok(done.rows_affected() > 0)
    }

    /// Removes a passkey of a person, and the recovery codes where nothing else needs them; false if there
    /// was none.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be written.
    pub async fn remove(&mut self, user_name: &str, passkey_id: &str) -> Result<bool, StoreError> {
        let during = StoreError::while_doing("remove a passkey");
        let mut transaction = self.0.begin().await.map_err(during)?;
        let done = query("DELETE FROM passkey WHERE passkey_id = ? AND user_name = ?")
            .bind(passkey_id.to_owned())
            .bind(user_name.to_owned())
            .execute(&mut *transaction)
            .await
            .map_err(StoreError::while_doing("remove a passkey"))?;
        SecondFactors(&mut transaction).remove_unused(user_name).await?;
        transaction.commit().await.map_err(StoreError::while_doing("remove a passkey"))?;
        Ok(done.rows_affected() > 0)
    }

    /// Removes all passkeys of a person; false if there were none.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn remove_all(&mut self, user_name: &str) -> Result<bool, StoreError> {
        let done = query("DELETE FROM passkey WHERE user_name = ?")
            .bind(user_name.to_owned())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("remove passkeys"))?;
        Ok(done.rows_affected() > 0)
    }
}

fn passkey(row: &SqliteRow) -> Result<StoredPasskey, StoreError> {
    let time = |time: DateTime| time::OffsetDateTime::from(time).into();
    Ok(StoredPasskey {
        passkey_id: row.column("passkey_id")?,
        name: row.column("name")?,
        credential_id: row.column("credential_id")?,
        user_handle: row.bytes("user_handle")?,
        transports: row.number("transports")?,
        static_state: row.column("static_state")?,
        dynamic_state: row.bytes("dynamic_state")?,
        created_at: time(row.time("created_at")?),
        last_used_at: row.time_option("last_used_at")?.map(time),
    })
}
