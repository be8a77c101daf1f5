//! Users and their sessions.

use std::{fmt, str::FromStr};

use asi_model::{DateTime, OrganisationId};
use daemon::web::session::{PasswordHash, SessionId, StoredSession};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow},
};

/// Role of a user.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum Role {
    /// Runs the platform: organisations, factories, collaborations, dead letters.
    Administrator,
    /// Edits networks and requests of the own organisation's collaborations.
    Planner,
    Viewer,
}

impl Role {
    const ALL: [Self; 3] = [Self::Administrator, Self::Planner, Self::Viewer];

    /// Returns the name in the store and in the API.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Administrator => "ADMINISTRATOR",
            Self::Planner => "PLANNER",
            Self::Viewer => "VIEWER",
        }
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl FromStr for Role {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|role| role.as_str().eq_ignore_ascii_case(text)).ok_or_else(
            || format!("a role is ADMINISTRATOR, PLANNER or VIEWER, but this is {text:?}"),
        )
    }
}

/// A user account without its password.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct User {
    /// The name to sign in with.
    pub user_name: String,
    pub role: Role,
    /// Organisation for which the user looks and acts; administrators may have none.
    pub organisation_id: Option<OrganisationId>,
}

/// Repository of users and sessions.
pub struct Users<'w>(pub(super) &'w mut Connection);

impl Users<'_> {
    /// Adds or replaces a user; its sessions end when the password changes.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown organisation.
    pub async fn put(
        &mut self,
        user: &User,
        password: &PasswordHash,
        now: DateTime,
    ) -> Result<(), StoreError> {
        let sql =
            "INSERT INTO user_account (user_name, password_hash, role, organisation_id, created_at)
                   VALUES ($1, $2, $3, $4, $5)
                   ON CONFLICT (user_name) DO UPDATE SET password_hash = excluded.password_hash,
                       role = excluded.role, organisation_id = excluded.organisation_id";
        sqlx::query(sql)
            .bind(&user.user_name)
            .bind(password.as_str())
            .bind(user.role.as_str())
            .bind(user.organisation_id.as_ref().map(OrganisationId::as_str))
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a user"))?;
        sqlx::query("DELETE FROM session WHERE user_name = $1")
            .bind(&user.user_name)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("end a user's sessions"))?;
        Ok(())
    }

    /// Returns true for the name of a person who has left.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn has_left(&mut self, user_name: &str) -> Result<bool, StoreError> {
        let found = sqlx::query("SELECT 1 FROM former_user WHERE user_name = $1")
            .bind(user_name)
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("ask who has left"))?;
        Ok(found.is_some())
    }

    /// Counts the users.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn count(&mut self) -> Result<i64, StoreError> {
        sqlx::query_scalar("SELECT COUNT(*) FROM user_account")
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("count users"))
    }

    /// Lists all users, by name.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(&mut self) -> Result<Vec<User>, StoreError> {
        let rows = sqlx::query("SELECT * FROM user_account ORDER BY user_name")
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list users"))?;
        rows.iter().map(|row| read(row).map(|(user, _)| user)).collect()
    }

    /// Looks a user up.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(
        &mut self,
        user_name: &str,
    ) -> Result<Option<(User, PasswordHash)>, StoreError> {
        let row = sqlx::query("SELECT * FROM user_account WHERE user_name = $1")
            .bind(user_name)
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a user up"))?;
        row.as_ref().map(read).transpose()
    }

    /// Stores a session and forgets those that have ended.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn put_session(
        &mut self,
        session: &StoredSession,
        now: DateTime,
    ) -> Result<(), StoreError> {
        sqlx::query("DELETE FROM session WHERE expires_at <= $1")
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget ended sessions"))?;
        let sql =
            "INSERT INTO session (session_id, user_name, csrf_token, started_at, last_used_at,
                       expires_at, address, user_agent)
                   VALUES ($1, $2, $3, $4, $5, $6, $7, $8)";
        sqlx::query(sql)
            .bind(session.id.as_str())
            .bind(&session.user_name)
            .bind(&session.csrf_token)
            .bind(DateTime::from(session.started_at).ticks())
            .bind(DateTime::from(session.last_used_at).ticks())
            .bind(DateTime::from(session.expires_at).ticks())
            .bind(&session.address)
            .bind(&session.user_agent)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a session"))?;
        Ok(())
    }

    /// Looks a session up.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn session(&mut self, id: &SessionId) -> Result<Option<StoredSession>, StoreError> {
        let row = sqlx::query("SELECT * FROM session WHERE session_id = $1")
            .bind(id.as_str())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a session up"))?;
        row.as_ref().map(read_session).transpose()
    }

    /// Returns the sessions of a user.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn sessions_of(&mut self, user_name: &str) -> Result<Vec<StoredSession>, StoreError> {
        let rows = sqlx::query("SELECT * FROM session WHERE user_name = $1")
            .bind(user_name)
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list a user's sessions"))?;
        rows.iter().map(read_session).collect()
    }

    /// Notes that a session was used.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn touch_session(&mut self, id: &SessionId, at: DateTime) -> Result<(), StoreError> {
        sqlx::query("UPDATE session SET last_used_at = $2 WHERE session_id = $1")
            .bind(id.as_str())
            .bind(at.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note the use of a session"))?;
        Ok(())
    }

    /// Gives a user another password and ends all sessions of the user but one.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn set_password(
        &mut self,
        user_name: &str,
        password: &PasswordHash,
        kept: &SessionId,
    ) -> Result<(), StoreError> {
        sqlx::query("UPDATE user_account SET password_hash = $2 WHERE user_name = $1")
            .bind(user_name)
            .bind(password.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a password"))?;
        sqlx::query("DELETE FROM session WHERE user_name = $1 AND session_id <> $2")
            .bind(user_name)
            .bind(kept.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("end a user's other sessions"))?;
        Ok(())
    }

    /// Forgets a session.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn delete_session(&mut self, id: &SessionId) -> Result<(), StoreError> {
        sqlx::query("DELETE FROM session WHERE session_id = $1")
            .bind(id.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget a session"))?;
        Ok(())
    }
}

fn read_session(row: &DatabaseRow) -> Result<StoredSession, StoreError> {
    let time = |name| row.time(name).map(|time| time::OffsetDateTime::from(time).into());
    Ok(StoredSession {
        id: SessionId::from_stored(row.column("session_id")?),
        user_name: row.column("user_name")?,
        csrf_token: row.column("csrf_token")?,
        started_at: time("started_at")?,
        last_used_at: time("last_used_at")?,
        expires_at: time("expires_at")?,
        address: row.column("address")?,
        user_agent: row.column("user_agent")?,
    })
}

fn read(row: &DatabaseRow) -> Result<(User, PasswordHash), StoreError> {
    let user = User {
        user_name: row.column("user_name")?,
        role: row.parsed("role")?,
        organisation_id: row.parsed_option("organisation_id")?,
    };
    Ok((user, PasswordHash::from_stored(row.column("password_hash")?)))
}
