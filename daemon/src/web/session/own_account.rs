//! One's own account: the password, and the sessions.

use std::time::{Duration, SystemTime};

use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use time::OffsetDateTime;
use utoipa::ToSchema;

use super::{
    accounts::{AccountChange, Accounts, SessionId, StoredSession},
    credentials::Caller,
    hashing::HashingError,
    password::{PasswordError, PasswordPolicy},
    second_factor::wrong,
    sessions::{Sessions, SignedIn, internal, not_hashed, now},
};
use crate::{Confidential, web::problem::Problem};

/// Time from a sign-in in which second factors may be changed, and accounts ended.
const RECENT: Duration = Duration::from_secs(600);

/// Present and new password.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct PasswordChange {
    #[schema(value_type = String, format = Password)]
    pub present_password: Confidential<String>,
    /// At least ten characters.
    #[schema(value_type = String, format = Password)]
    pub new_password: Confidential<String>,
}

/// Sessions of a person, the one used last first.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SessionList {
    pub items: Vec<SessionSummary>,
}

/// A session, told to its owner or to an administrator.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SessionSummary {
    /// Name by which the session is ended; nobody can use the session with it.
    pub session_id: String,
    /// True for the session that asks.
    pub is_present: bool,
    /// Address from which the person signed in.
    pub address: String,
    /// Browser as it calls itself.
    pub user_agent: String,
    #[serde(with = "time::serde::rfc3339")]
    #[schema(value_type = String, format = DateTime)]
    pub started_at: OffsetDateTime,
    /// Last use, to the minute. An open page uses its session.
    #[serde(with = "time::serde::rfc3339")]
    #[schema(value_type = String, format = DateTime)]
    pub last_used_at: OffsetDateTime,
}

impl SessionSummary {
    fn of(session: &StoredSession, present: &SessionId) -> Self {
        Self {
            session_id: session.id.as_str().to_owned(),
            is_present: session.id == *present,
            address: session.address.clone(),
            user_agent: session.user_agent.clone(),
            started_at: to_the_second(session.started_at),
            last_used_at: to_the_second(session.last_used_at),
        }
    }
}

fn to_the_second(time: SystemTime) -> OffsetDateTime {
    let time = OffsetDateTime::from(time);
    time.replace_nanosecond(0).unwrap_or(time)
}

impl<A: Accounts> Sessions<A> {
    /// Lists the sessions of a user; `present` is the one that asks.
    ///
    /// # Errors
    /// A [`Problem`] when the store fails.
    pub async fn list(&self, user_name: &str, present: &SessionId) -> Result<SessionList, Problem> {
        let mut sessions = self.live_sessions(user_name).await?;
        sessions.sort_by_key(|session| std::cmp::Reverse(session.last_used_at));
        let items = sessions.iter().map(|session| SessionSummary::of(session, present));
        Ok(SessionList { items: items.collect() })
    }

    /// Ends a session of a user.
    ///
    /// # Errors
    /// A [`Problem`]: 404 where the user has no such session.
    pub async fn end(
        &self,
        user_name: &str,
        session_id: &str,
        change: AccountChange<'_>,
    ) -> Result<(), Problem> {
        let id = SessionId::from_stored(session_id.to_owned());
        let session = self.accounts().session(&id).await.map_err(internal)?;
        if session.is_none_or(|session| session.user_name != user_name) {
            return Err(Problem::not_found("such session"));
        }
        self.accounts().delete_session(&id, Some(change)).await.map_err(internal)
    }

    /// Gives the user another password; the user's other sessions end.
    ///
    /// # Errors
    /// A [`Problem`]: 422 for a wrong or a weak password, and those of a sign-in.
    pub async fn change_password(
        &self,
        caller: &Caller,
        user: &SignedIn<A::Principal>,
        change: PasswordChange,
    ) -> Result<(), Problem> {
        let present = change.present_password;
        self.check_password_at(caller, &user.user_name, present, "/presentPassword").await?;
        let policy = PasswordPolicy::default();
        let hash = match self.hashing().hash(change.new_password, policy).await {
            Ok(hash) => hash,
            Err(HashingError::Password(
                error @ (PasswordError::TooShort { .. } | PasswordError::TooLong { .. }),
            )) => return Err(wrong("/newPassword", "PASSWORD_REFUSED", &format!("{error}."))),
            Err(error) => return Err(not_hashed(error)),
        };
        let (accounts, name) = (self.accounts(), &user.user_name);
        accounts.set_password(name, &hash, &user.session).await.map_err(internal)?;
        tracing::info!(user.name = name, "A person changed the own password.");
        Ok(())
    }

    /// Checks that a person with a second factor signed in a short time ago, and so showed it: who has found an open
    /// page and knows the password adds and removes no factor.
    pub(super) async fn check_recent(
        &self,
        user_name: &str,
        session: &SessionId,
    ) -> Result<(), Problem> {
        if !self.second_factors(user_name).await?.is_any() {
            return Ok(());
        }
        self.check_signed_in_lately(session, "Second factors are changed").await
    }

    /// Checks that the person of a session signed in a short time ago: an open page is not enough for what cannot be
    /// undone. `what` begins the sentence that says so.
    ///
    /// # Errors
    /// A [`Problem`]: 403 where it is longer ago.
    pub async fn check_signed_in_lately(
        &self,
        session: &SessionId,
        what: &'static str,
    ) -> Result<(), Problem> {
        let stored = self.accounts().session(session).await.map_err(internal)?;
        let age = stored.and_then(|stored| now().duration_since(stored.started_at).ok());
        if age.is_some_and(|age| age <= RECENT) {
            return Ok(());
        }
        let detail =
            format!("{what} within ten minutes of a sign-in. Sign in again, then try once more.");
        Err(Problem::new(StatusCode::FORBIDDEN, "SIGN_IN_AGAIN", detail))
    }

    /// Checks the password of a person who is signed in; attempts count as those to sign in.
    pub(super) async fn check_password(
        &self,
        caller: &Caller,
        user_name: &str,
        password: Confidential<String>,
    ) -> Result<(), Problem> {
        self.check_password_at(caller, user_name, password, "/password").await
    }

    async fn check_password_at(
        &self,
        caller: &Caller,
        user_name: &str,
        password: Confidential<String>,
        pointer: &str,
    ) -> Result<(), Problem> {
        let open = self.gate().enter(caller.address, user_name).await?;
        let checked = open.unless_displaced(self.is_password(user_name, password)).await;
        match checked {
            Ok(true) => {
                open.succeeded();
                Ok(())
            }
            Ok(false) => Err(wrong(pointer, "WRONG_PASSWORD", "The password is wrong.")),
            Err(problem) => {
                open.withdrawn();
                Err(problem)
            }
        }
    }
}
