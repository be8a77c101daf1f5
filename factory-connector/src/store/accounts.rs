//! People who may sign in, at the pages and at the twin.

use std::collections::HashMap;

use asi_model::DateTime;
use sqlx::{Row as _, SqliteConnection, SqlitePool};

use super::StoreError;

/// What a person may do.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, utoipa::ToSchema,
)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum Role {
    /// Decides, maps, configures.
    Engineer,
    /// Enters values.
    Operator,
    /// Looks.
    Viewer,
}

impl Role {
    /// All roles.
    pub const ALL: [Self; 3] = [Self::Engineer, Self::Operator, Self::Viewer];

    /// The name in the store, the API and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Engineer => "ENGINEER",
            Self::Operator => "OPERATOR",
            Self::Viewer => "VIEWER",
        }
    }

    /// The role with this name, whatever its case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name().eq_ignore_ascii_case(name))
    }
}

/// A person who may sign in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct User {
    /// The name to sign in with.
    pub user_name: String,
    /// What the person may do.
    pub role: Role,
    /// Argon2id, as a PHC string.
    pub password_hash: String,
}

/// The person with this name.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn user(readers: &SqlitePool, user_name: &str) -> Result<Option<User>, StoreError> {
    let row = sqlx::query("SELECT user_name, role, password_hash FROM user WHERE user_name = ?")
        .bind(user_name)
        .fetch_optional(readers)
        .await
        .map_err(StoreError::while_doing("look a user up"))?;
    row.map(|row| {
        let role: String = row.try_get(1).map_err(StoreError::while_doing("read a column"))?;
        Ok(User {
            user_name: row.try_get(0).map_err(StoreError::while_doing("read a column"))?,
            role: Role::from_name(&role).ok_or_else(|| StoreError::Unreadable {
                what: "user",
                reason: format!("there is no role {role}"),
            })?,
            password_hash: row.try_get(2).map_err(StoreError::while_doing("read a column"))?,
        })
    })
    .transpose()
}

/// Everybody with role and password, by name.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn everybody(
    readers: &SqlitePool,
) -> Result<HashMap<String, (String, String)>, StoreError> {
    let rows = sqlx::query("SELECT user_name, role, password_hash FROM user")
        .fetch_all(readers)
        .await
        .map_err(StoreError::while_doing("list the users"))?;
    rows.iter()
        .map(|row| Ok((row.try_get(0)?, (row.try_get(1)?, row.try_get(2)?))))
        .collect::<Result<_, sqlx::Error>>()
        .map_err(StoreError::while_doing("read a column"))
}

/// How many people may sign in.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn count_users(connection: &mut SqliteConnection) -> Result<i64, StoreError> {
    sqlx::query("SELECT count(*) FROM user")
        .fetch_one(connection)
        .await
        .and_then(|row| row.try_get(0))
        .map_err(StoreError::while_doing("count the users"))
}

/// Adds a person, or changes role and password.
///
/// # Errors
/// [`StoreError`] where the table cannot be written.
pub async fn put_user(
    connection: &mut SqliteConnection,
    user: &User,
    now: DateTime,
) -> Result<(), StoreError> {
    sqlx::query(
        "INSERT INTO user (user_name, role, password_hash, changed_at) VALUES (?, ?, ?, ?) \
         ON CONFLICT (user_name) DO UPDATE SET role = excluded.role, password_hash = excluded.password_hash, \
         changed_at = excluded.changed_at",
    )
    .bind(&user.user_name)
    .bind(user.role.name())
    .bind(&user.password_hash)
    .bind(now.unix_micros())
    .execute(connection)
    .await
    .map_err(StoreError::while_doing("store a user"))?;
    Ok(())
}

/// Removes a person; false where there was none.
///
/// # Errors
/// [`StoreError`] where the table cannot be written.
pub async fn remove_user(
    connection: &mut SqliteConnection,
    user_name: &str,
) -> Result<bool, StoreError> {
    let done = sqlx::query("DELETE FROM user WHERE user_name = ?")
        .bind(user_name)
        .execute(connection)
        .await
        .map_err(StoreError::while_doing("remove a user"))?;
    Ok(done.rows_affected() > 0)
}

/// Everybody who may sign in, without passwords.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn users(connection: &mut SqliteConnection) -> Result<Vec<(String, String)>, StoreError> {
    let rows = sqlx::query("SELECT user_name, role FROM user ORDER BY user_name")
        .fetch_all(connection)
        .await
        .map_err(StoreError::while_doing("list the users"))?;
    rows.iter()
        .map(|row| Ok((row.try_get(0)?, row.try_get(1)?)))
        .collect::<Result<_, sqlx::Error>>()
        .map_err(StoreError::while_doing("read a column"))
}
