//! The enrolment at the platform: address and credential of its broker.

use asi_model::DateTime;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    error::StoreError,
    query::{optional, query},
    row::Columns as _,
};

/// Access to the platform's broker, as enrolment yielded it.
#[derive(Clone, PartialEq, Eq)]
pub struct Enrolment {
    /// The factory that was enrolled.
    pub factory_id: String,
    /// Address of the broker.
    pub broker_url: String,
    /// Profile of the broker as JSON: the mapping of logical addresses to its own.
    pub profile: String,
    /// The connector's user at the broker.
    pub user_name: String,
    /// Sealed password; none where no key opened it and it was removed, or before the first start of a
    /// version that seals.
    pub sealed_password: Option<String>,
    /// Root of the broker's certificate; none for a root of the system.
    pub root_certificate_pem: Option<String>,
}

impl std::fmt::Debug for Enrolment {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Enrolment")
            .field("factory_id", &self.factory_id)
            .field("broker_url", &self.broker_url)
            .field("user_name", &self.user_name)
            .finish_non_exhaustive()
    }
}

/// Repository of the one enrolment, which is made before the connector runs.
pub struct Enrolments<'c>(pub(super) &'c mut SqliteConnection);

impl Enrolments<'_> {
    /// Reads the enrolment; none before the first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn current(&mut self) -> Result<Option<Enrolment>, StoreError> {
        let query = query("SELECT * FROM enrolment WHERE id = 1");
        optional(self.0, query, "read the enrolment", enrolment).await
    }

    /// Stores an enrolment in place of the one before.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn put(&mut self, enrolment: &Enrolment, now: DateTime) -> Result<(), StoreError> {
        let sql = "INSERT INTO enrolment (id, factory_id, broker_url, profile, user_name, password,
                       sealed_password, root_certificate_pem, enrolled_at)
                   VALUES (1, ?, ?, ?, ?, '', ?, ?, ?)
                   ON CONFLICT (id) DO UPDATE SET
                       factory_id = excluded.factory_id, broker_url = excluded.broker_url,
                       profile = excluded.profile, user_name = excluded.user_name,
                       password = excluded.password,
                       sealed_password = excluded.sealed_password,
                       root_certificate_pem = excluded.root_certificate_pem,
                       enrolled_at = excluded.enrolled_at";
        query(sql)
            .bind(enrolment.factory_id.clone())
            .bind(enrolment.broker_url.clone())
            .bind(enrolment.profile.clone())
            .bind(enrolment.user_name.clone())
            .bind(enrolment.sealed_password.clone())
            .bind(enrolment.root_certificate_pem.clone())
            .bind(now.unix_micros())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("store the enrolment"))?;
        Ok(())
    }
}

fn enrolment(row: &SqliteRow) -> Result<Enrolment, StoreError> {
    Ok(Enrolment {
        factory_id: row.column("factory_id")?,
        broker_url: row.column("broker_url")?,
        profile: row.column("profile")?,
        user_name: row.column("user_name")?,
        sealed_password: row.column("sealed_password")?,
        root_certificate_pem: row.column("root_certificate_pem")?,
    })
}
