//! Second factors of people at the pages.

use daemon::web::session::StoredSecondFactor;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    error::StoreError,
    query::{all, optional, query},
    row::{Columns as _, document, signed},
};

/// Repository of second factors; written beside the connector's transactions, as users are.
pub struct SecondFactors<'c>(pub(super) &'c mut SqliteConnection);

impl SecondFactors<'_> {
    /// Looks the second factor of a person up.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(
        &mut self,
        user_name: &str,
    ) -> Result<Option<StoredSecondFactor>, StoreError> {
        let query =
            query("SELECT * FROM second_factor WHERE user_name = ?").bind(user_name.to_owned());
        optional(self.0, query, "look a second factor up", factor).await
    }

    /// Lists the names of those who have confirmed codes of an app, or passkeys.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn confirmed(&mut self) -> Result<Vec<String>, StoreError> {
        let query = query(
            "SELECT user_name FROM second_factor WHERE is_confirmed = 1
                           UNION SELECT user_name FROM passkey",
        );
        all(self.0, query, "list second factors", |row| row.column("user_name")).await
    }

    /// Stores the second factor of a person in place of another.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn put(
        &mut self,
        user_name: &str,
        factor: &StoredSecondFactor,
    ) -> Result<(), StoreError> {
        let sql = "INSERT OR REPLACE INTO second_factor
                       (user_name, secret, sealed_secret, is_confirmed, last_step, recovery_digests)
                   VALUES (?, x'', ?, ?, ?, ?)";
        query(sql)
            .bind(user_name.to_owned())
            .bind(factor.sealed_secret.clone())
            .bind(factor.is_confirmed)
            .bind(signed(factor.last_step))
            .bind(document(&factor.recovery_digests))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("store a second factor"))?;
        Ok(())
    }

    /// Stores recovery codes of a person in place of others; codes of an app stay as they are.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn put_recovery_digests(
        &mut self,
        user_name: &str,
        digests: &[String],
    ) -> Result<(), StoreError> {
        let mut factor = self.lookup(user_name).await?.unwrap_or_default();
        digests.clone_into(&mut factor.recovery_digests);
        self.put(user_name, &factor).await
    }

    /// Removes recovery codes of a person who has neither codes of an app nor passkeys.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn remove_unused(&mut self, user_name: &str) -> Result<(), StoreError> {
        let sql = "DELETE FROM second_factor WHERE user_name = ?1 AND is_confirmed = 0
                   AND NOT EXISTS (SELECT 1 FROM passkey WHERE passkey.user_name = ?1)";
        query(sql)
            .bind(user_name.to_owned())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("remove recovery codes"))?;
        Ok(())
    }

    /// Removes the second factor of a person; false if there was none.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn remove(&mut self, user_name: &str) -> Result<bool, StoreError> {
        let done = query("DELETE FROM second_factor WHERE user_name = ?")
            .bind(user_name.to_owned())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("remove a second factor"))?;
        Ok(done.rows_affected() > 0)
    }

    /// Notes that the code of a time step was used; false if this or a later one had been.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn use_time_step(&mut self, user_name: &str, step: u64) -> Result<bool, StoreError> {
        let sql = "UPDATE second_factor SET last_step = ? WHERE user_name = ? AND last_step < ?";
        let done = query(sql)
            .bind(signed(step))
            .bind(user_name.to_owned())
            .bind(signed(step))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("use a code up"))?;
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
        let Some(factor) = self.lookup(user_name).await? else { return Ok(false) };
        let before = document(&factor.recovery_digests);
        let left: Vec<_> =
            factor.recovery_digests.into_iter().filter(|one| one != digest).collect();
        let after = document(&left);
        if after == before {
            return Ok(false);
        }
        // Of two requests with the same code, one finds other codes than it has read.
        let sql = "UPDATE second_factor SET recovery_digests = ?
                   WHERE user_name = ? AND recovery_digests = ?";
        let done = query(sql)
            .bind(after)
            .bind(user_name.to_owned())
            .bind(before)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("use a recovery code up"))?;
        Ok(done.rows_affected() > 0)
    }
}

fn factor(row: &SqliteRow) -> Result<StoredSecondFactor, StoreError> {
    Ok(StoredSecondFactor {
        sealed_secret: row.column("sealed_secret")?,
        is_confirmed: row.flag("is_confirmed")?,
        last_step: row.number("last_step")?,
        recovery_digests: row.document("recovery_digests")?,
    })
}
