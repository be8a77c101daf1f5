//! Secrets as the rows of enrolment, sources and second factors hold them: sealed, or in plain text in a
//! store of before.

use daemon::sealing::StoredSecret;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    error::StoreError,
    query::{all, query},
    row::Columns as _,
};

/// Row with a secret.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SecretHolder {
    /// The connector's user at the platform's broker.
    Broker,
    /// The user at a machine, by the id of its source.
    Source(String),
    /// The second factor of a person at the pages, by name. Its text is the secret in hexadecimal.
    SecondFactor(String),
}

/// Repository of all secrets, to seal them again.
pub struct SecretRows<'c>(pub(super) &'c mut SqliteConnection);

impl SecretRows<'_> {
    /// Reads all secrets, sealed or not.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<Vec<StoredSecret<SecretHolder>>, StoreError> {
        let query = query(
            "SELECT NULL AS source_id, NULL AS user_name, nullif(password, '') AS plain,
                 sealed_password AS sealed FROM enrolment
             WHERE password <> '' OR sealed_password IS NOT NULL
             UNION ALL
             SELECT source_id, NULL, password, sealed_password FROM source
             WHERE password IS NOT NULL OR sealed_password IS NOT NULL
             UNION ALL
             SELECT NULL, user_name, nullif(hex(secret), ''), sealed_secret FROM second_factor
             WHERE secret <> x'' OR sealed_secret IS NOT NULL",
        );
        all(self.0, query, "read the secrets", stored).await
    }

    /// Puts a sealed text, or none, in place of a secret, and overwrites what was there. False where the
    /// secret was changed meanwhile.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn replace(
        &mut self,
        former: &StoredSecret<SecretHolder>,
        sealed: Option<&str>,
    ) -> Result<bool, StoreError> {
        // What SQLite removes else stays in the page until something takes its place.
        let overwriting = query("PRAGMA secure_delete = ON").execute(&mut *self.0).await;
        overwriting.map_err(StoreError::while_doing("have removed secrets overwritten"))?;
        let (sql, id) = match &former.holder {
            SecretHolder::Broker => (
                "UPDATE enrolment SET password = '', sealed_password = ?
                 WHERE ? IS NULL AND nullif(password, '') IS ? AND sealed_password IS ?",
                None,
            ),
            SecretHolder::Source(id) => (
                "UPDATE source SET password = NULL, sealed_password = ?
                 WHERE source_id = ? AND password IS ? AND sealed_password IS ?",
                Some(id.clone()),
            ),
            SecretHolder::SecondFactor(user) => (
                "UPDATE second_factor SET secret = x'', sealed_secret = ?
                 WHERE user_name = ? AND nullif(hex(secret), '') IS ? AND sealed_secret IS ?",
                Some(user.clone()),
            ),
        };
        let updated = query(sql)
            .bind(sealed.map(str::to_owned))
            .bind(id)
            .bind(former.plain.as_ref().map(|plain| plain.expose().clone()))
            .bind(former.sealed.clone())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("store a sealed secret"))?;
        Ok(updated.rows_affected() > 0)
    }

    /// Empties the write-ahead log, which has the pages of before, as far as nobody else reads them.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn empty_log(&mut self) -> Result<(), StoreError> {
        let emptied = query("PRAGMA wal_checkpoint(TRUNCATE)").fetch_all(&mut *self.0).await;
        emptied.map(drop).map_err(StoreError::while_doing("empty the write-ahead log"))
    }
}

fn stored(row: &SqliteRow) -> Result<StoredSecret<SecretHolder>, StoreError> {
    let source_id: Option<String> = row.column("source_id")?;
    let user_name: Option<String> = row.column("user_name")?;
    let plain: Option<String> = row.column("plain")?;
    let of_user = user_name.map(SecretHolder::SecondFactor);
    Ok(StoredSecret {
        holder: of_user.or(source_id.map(SecretHolder::Source)).unwrap_or(SecretHolder::Broker),
        plain: plain.map(Into::into),
        sealed: row.column("sealed")?,
    })
}
