//! Passwords of broker and machines, as the rows of enrolment and sources hold them: sealed, or in plain
//! text in a store of before.

use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    error::StoreError,
    query::{all, query},
    row::Columns as _,
};

/// Owner of a stored password.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PasswordHolder {
    /// The connector's user at the platform's broker.
    Broker,
    /// The user at a machine, by the id of its source.
    Source(String),
}

/// A password as stored.
pub struct StoredPassword {
    pub holder: PasswordHolder,
    /// Plain text of a store of before.
    pub plain: Option<String>,
    /// Text of `daemon::sealing`.
    pub sealed: Option<String>,
}

/// Repository of all passwords, to seal them again.
pub struct Passwords<'c>(pub(super) &'c mut SqliteConnection);

impl Passwords<'_> {
    /// Reads all passwords, sealed or not.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<Vec<StoredPassword>, StoreError> {
        let query = query(
            "SELECT NULL AS source_id, nullif(password, '') AS password, sealed_password FROM enrolment
             WHERE password <> '' OR sealed_password IS NOT NULL
             UNION ALL
             SELECT source_id, password, sealed_password FROM source
             WHERE password IS NOT NULL OR sealed_password IS NOT NULL",
        );
        all(self.0, query, "read the passwords", stored).await
    }

    /// Puts a sealed text, or none, in place of a password, and overwrites what was there. False where the
    /// password was changed meanwhile.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn replace(
        &mut self,
        former: &StoredPassword,
        sealed: Option<&str>,
    ) -> Result<bool, StoreError> {
        // What SQLite removes else stays in the page until something takes its place.
        let overwriting = query("PRAGMA secure_delete = ON").execute(&mut *self.0).await;
        overwriting.map_err(StoreError::while_doing("have removed passwords overwritten"))?;
        let (sql, id) = match &former.holder {
            PasswordHolder::Broker => (
                "UPDATE enrolment SET password = '', sealed_password = ?
                 WHERE ? IS NULL AND nullif(password, '') IS ? AND sealed_password IS ?",
                None,
            ),
            PasswordHolder::Source(id) => (
                "UPDATE source SET password = NULL, sealed_password = ?
                 WHERE source_id = ? AND password IS ? AND sealed_password IS ?",
                Some(id.clone()),
            ),
        };
        let updated = query(sql)
            .bind(sealed.map(str::to_owned))
            .bind(id)
            .bind(former.plain.clone())
            .bind(former.sealed.clone())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("store a sealed password"))?;
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

fn stored(row: &SqliteRow) -> Result<StoredPassword, StoreError> {
    let source_id: Option<String> = row.column("source_id")?;
    Ok(StoredPassword {
        holder: source_id.map_or(PasswordHolder::Broker, PasswordHolder::Source),
        plain: row.column("password")?,
        sealed: row.column("sealed_password")?,
    })
}
