//! Second factors of users.

use daemon::{sealing::StoredSecret, web::session::StoredSecondFactor};

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow, document, signed},
};

/// Repository of second factors.
pub struct SecondFactors<'w>(pub(super) &'w mut Connection);

impl SecondFactors<'_> {
    /// Looks the second factor of a user up.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(
        &mut self,
        user_name: &str,
    ) -> Result<Option<StoredSecondFactor>, StoreError> {
        let row = sqlx::query("SELECT * FROM second_factor WHERE user_name = $1")
            .bind(user_name)
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a second factor up"))?;
        row.as_ref().map(read).transpose()
    }

    /// Stores the second factor of a user in place of another.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown user.
    pub async fn put(
        &mut self,
        user_name: &str,
        factor: &StoredSecondFactor,
    ) -> Result<(), StoreError> {
        let sql = "INSERT OR REPLACE INTO second_factor
                       (user_name, secret, sealed_secret, is_confirmed, last_step, recovery_digests)
                   VALUES ($1, x'', $2, $3, $4, $5)";
        sqlx::query(sql)
            .bind(user_name)
            .bind(&factor.sealed_secret)
            .bind(factor.is_confirmed)
            .bind(signed(factor.last_step))
            .bind(document(&factor.recovery_digests))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a second factor"))?;
        Ok(())
    }

    /// Reads the secrets of all users by name, sealed or, in a store of before, in plain hexadecimal.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn secrets(&mut self) -> Result<Vec<StoredSecret<String>>, StoreError> {
        let sql =
            "SELECT user_name, nullif(hex(secret), '') AS plain, sealed_secret FROM second_factor
                   WHERE secret <> x'' OR sealed_secret IS NOT NULL";
        let rows = sqlx::query(sql).fetch_all(&mut *self.0).await;
        let rows = rows.map_err(StoreError::during("read the secrets of second factors"))?;
        let stored = |row: &DatabaseRow| {
            Ok(StoredSecret {
                holder: row.column("user_name")?,
                plain: row.column::<Option<String>>("plain")?.map(Into::into),
                sealed: row.column("sealed_secret")?,
            })
        };
        rows.iter().map(stored).collect()
    }

    /// Puts a sealed secret, or none, in place of a user's, and overwrites what was there. False where it
    /// was changed meanwhile.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn replace_secret(
        &mut self,
        former: &StoredSecret<String>,
        sealed: Option<&str>,
    ) -> Result<bool, StoreError> {
        // What SQLite removes else stays in the page until something takes its place.
        sqlx::query("PRAGMA secure_delete = ON")
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("have removed secrets overwritten"))?;
        let sql = "UPDATE second_factor SET secret = x'', sealed_secret = $1
                   WHERE user_name = $2 AND nullif(hex(secret), '') IS $3 AND sealed_secret IS $4";
        let done = sqlx::query(sql)
            .bind(sealed)
            .bind(&former.holder)
            .bind(former.plain.as_ref().map(|plain| plain.expose().as_str()))
            .bind(&former.sealed)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a sealed secret"))?;
        Ok(done.rows_affected() > 0)
    }

    /// Stores recovery codes of a user in place of others; codes of an app stay as they are.
    ///
    /// # Errors
    /// [`StoreError`], as for an unknown user.
    pub async fn put_recovery_digests(
        &mut self,
        user_name: &str,
        digests: &[String],
    ) -> Result<(), StoreError> {
        let mut factor = self.lookup(user_name).await?.unwrap_or_default();
        digests.clone_into(&mut factor.recovery_digests);
        self.put(user_name, &factor).await
    }

    /// Removes recovery codes of a user who has neither codes of an app nor passkeys.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn remove_unused(&mut self, user_name: &str) -> Result<(), StoreError> {
        let sql = "DELETE FROM second_factor WHERE user_name = $1 AND is_confirmed = 0
                   AND NOT EXISTS (SELECT 1 FROM passkey WHERE passkey.user_name = $1)";
        sqlx::query(sql)
            .bind(user_name)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("remove recovery codes"))?;
        Ok(())
    }

    /// Removes the second factor of a user; false if there was none.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn remove(&mut self, user_name: &str) -> Result<bool, StoreError> {
        let done = sqlx::query("DELETE FROM second_factor WHERE user_name = $1")
            .bind(user_name)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("remove a second factor"))?;
        Ok(done.rows_affected() > 0)
    }

    /// Notes that the code of a time step was used; false if this or a later one had been.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn use_time_step(&mut self, user_name: &str, step: u64) -> Result<bool, StoreError> {
        let sql = "UPDATE second_factor SET last_step = $2 WHERE user_name = $1 AND last_step < $2";
        let done = sqlx::query(sql)
            .bind(user_name)
            .bind(signed(step))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("use a code up"))?;
        Ok(done.rows_affected() > 0)
    }

    /// Uses a recovery code up; false if there is none with this digest.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn use_recovery_code(
        &mut self,
        user_name: &str,
        digest: &str,
    ) -> Result<bool, StoreError> {
        let Some(mut factor) = self.lookup(user_name).await? else { return Ok(false) };
        let count = factor.recovery_digests.len();
        factor.recovery_digests.retain(|one| one != digest);
        if factor.recovery_digests.len() == count {
            return Ok(false);
        }
        self.put(user_name, &factor).await?;
        Ok(true)
    }
}

fn read(row: &DatabaseRow) -> Result<StoredSecondFactor, StoreError> {
    Ok(StoredSecondFactor {
        sealed_secret: row.column("sealed_secret")?,
        is_confirmed: row.column("is_confirmed")?,
        last_step: row.unsigned("last_step")?,
        recovery_digests: row.json("recovery_digests")?,
    })
}
