//! People who may sign in, at the pages and at the twin.

use asi_model::DateTime;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    error::StoreError,
    names::Named,
    query::{all, one, optional, query},
    row::Columns as _,
};

/// Rights of a person.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, utoipa::ToSchema,
)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum Role {
    /// Decides, maps and configures.
    Engineer,
    /// Enters values of operations.
    Operator,
    /// Reads without changing anything.
    Viewer,
}

impl Role {
    /// All roles, the one with the most rights first.
    pub const ALL: [Self; 3] = [Self::Engineer, Self::Operator, Self::Viewer];

    /// Returns the name in the store, the API and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Engineer => "ENGINEER",
            Self::Operator => "OPERATOR",
            Self::Viewer => "VIEWER",
        }
    }

    /// Returns the role with this name in upper or lower case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name().eq_ignore_ascii_case(name))
    }
}

impl Named for Role {
    const ALL: &'static [Self] = &Self::ALL;

    fn name(self) -> &'static str {
        self.name()
    }
}

/// A person who may sign in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct User {
    /// Name to sign in with.
    pub user_name: String,
    pub role: Role,
    /// Argon2id, as a PHC string.
    pub password_hash: String,
}

/// Repository of users.
///
/// Users are written through the same connection, beside the connector's transactions: no state in
/// memory depends on them, and the command line changes them while the connector runs.
pub struct Users<'c>(pub(super) &'c mut SqliteConnection);

impl Users<'_> {
    /// Looks a person up by name.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(&mut self, user_name: &str) -> Result<Option<User>, StoreError> {
        let query = query("SELECT * FROM user WHERE user_name = ?").bind(user_name.to_owned());
        optional(self.0, query, "look a user up", user).await
    }

    /// Reads all users, by name.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<Vec<User>, StoreError> {
        let query = query("SELECT * FROM user ORDER BY user_name");
        all(self.0, query, "list the users", user).await
    }

    /// Counts the people who may sign in.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn count(&mut self) -> Result<u64, StoreError> {
        let query = query("SELECT count(*) AS users FROM user");
        one(self.0, query, "count the users", |row| row.number("users")).await
    }

    /// Adds a person, or changes role and password of one.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn put(&mut self, user: &User, now: DateTime) -> Result<(), StoreError> {
        let sql =
            "INSERT INTO user (user_name, role, password_hash, changed_at) VALUES (?, ?, ?, ?)
                   ON CONFLICT (user_name) DO UPDATE SET
                       role = excluded.role, password_hash = excluded.password_hash,
                       changed_at = excluded.changed_at";
        query(sql)
            .bind(user.user_name.clone())
            .bind(user.role.name())
            .bind(user.password_hash.clone())
            .bind(now.unix_micros())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("store a user"))?;
        Ok(())
    }

    /// Removes a person; false if there was none.
    ///
    /// # Errors
    /// [`StoreError`] where the table cannot be written.
    pub async fn remove(&mut self, user_name: &str) -> Result<bool, StoreError> {
        let done = query("DELETE FROM user WHERE user_name = ?")
            .bind(user_name.to_owned())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::while_doing("remove a user"))?;
        Ok(done.rows_affected() > 0)
    }
}

fn user(row: &SqliteRow) -> Result<User, StoreError> {
    Ok(User {
        user_name: row.column("user_name")?,
        role: row.named("role")?,
        password_hash: row.column("password_hash")?,
    })
}
