//! Signing in and out.

use std::time::Duration;

use axum::http::StatusCode;
use axum_extra::extract::cookie::Cookie;

use super::{
    accounts::{Accounts, SessionId, StoredSession},
    credentials::{Caller, SignIn},
    second_factor::code_needed,
    sessions::{Sessions, SignedIn, internal, not_hashed, now, random_token},
    sign_in_gate::count,
};
use crate::{Confidential, web::problem::Problem};

/// Sessions of a user at once; one more ends the one that was used longest ago.
const SESSIONS_PER_USER_MAX: usize = 32;

/// Outcome of looking at credentials.
enum Verdict<P> {
    Right(P),
    Wrong,
    /// Name and password are right, and there is no code where one is needed.
    CodeNeeded,
}

impl<A: Accounts> Sessions<A> {
    /// Checks credentials and opens a session; the cookie goes into the answer. The session that the
    /// browser had before ends.
    ///
    /// # Errors
    /// A [`Problem`]: 401 for a wrong name, password or code (without saying which) and for a code that
    /// is missing, 429 after too many attempts, 503 when too many sign in at once.
    pub async fn sign_in(
        &self,
        caller: &Caller,
        sign_in: &SignIn,
    ) -> Result<(Cookie<'static>, SignedIn<A::Principal>), Problem> {
        let user_name = sign_in.user_name.as_str();
        let open = self.gate().enter(caller.address, user_name).await?;
        let principal = match self.verdict(sign_in).await {
            Ok(Verdict::Right(principal)) => principal,
            Ok(Verdict::Wrong) => {
                drop(open);
                count("refused");
                tracing::warn!(client = %caller.address, "An attempt to sign in was refused.");
                return Err(wrong_credentials());
            }
            Ok(Verdict::CodeNeeded) => {
                // Given back, but failures are not forgotten: else this would be the way to try as
                // many codes as one likes.
                open.withdrawn();
                count("code_needed");
                return Err(code_needed());
            }
            Err(problem) => {
                open.withdrawn();
                return Err(problem);
            }
        };
        open.succeeded();
        count("accepted");
        let (cookie, session) = self.open_session(caller, user_name).await?;
        let signed_in = SignedIn {
            session: session.id,
            user_name: session.user_name,
            principal,
            csrf_token: session.csrf_token,
        };
        Ok((cookie, signed_in))
    }

    async fn verdict(&self, sign_in: &SignIn) -> Result<Verdict<A::Principal>, Problem> {
        let user_name = sign_in.user_name.as_str();
        if !self.is_password(user_name, sign_in.password.clone()).await? {
            return Ok(Verdict::Wrong);
        }
        if self.second_factor_state(user_name).await?.is_on {
            let Some(code) = &sign_in.code else { return Ok(Verdict::CodeNeeded) };
            if !self.is_code(user_name, code).await? {
                return Ok(Verdict::Wrong);
            }
        }
        let principal = self.accounts().principal(user_name).await.map_err(internal)?;
        Ok(principal.map_or(Verdict::Wrong, Verdict::Right))
    }

    /// Returns true if this is the password of a user that there is.
    pub(super) async fn is_password(
        &self,
        user_name: &str,
        password: Confidential<String>,
    ) -> Result<bool, Problem> {
        let hash = self.accounts().password_hash(user_name).await.map_err(internal)?;
        self.hashing().verify(hash, password).await.map_err(not_hashed)
    }

    async fn open_session(
        &self,
        caller: &Caller,
        user_name: &str,
    ) -> Result<(Cookie<'static>, StoredSession), Problem> {
        if let Some(former) = caller.cookies.get(self.config().cookie_name()) {
            let former = SessionId::of(former.value());
            self.accounts().delete_session(&former).await.map_err(internal)?;
        }
        self.make_room(user_name).await?;
        let token = random_token();
        let now = now();
        let session = StoredSession {
            id: SessionId::of(&token),
            user_name: user_name.to_owned(),
            csrf_token: random_token(),
            started_at: now,
            last_used_at: now,
            expires_at: now + self.config().lifetime,
            address: caller.address.to_string(),
            user_agent: caller.user_agent.clone(),
        };
        self.accounts().put_session(&session).await.map_err(internal)?;
        Ok((self.cookie(token, self.config().lifetime), session))
    }

    /// Ends the sessions of a user that are used least, so that there is room for one more.
    async fn make_room(&self, user_name: &str) -> Result<(), Problem> {
        let mut sessions = self.live_sessions(user_name).await?;
        sessions.sort_by_key(|session| session.last_used_at);
        let surplus = (sessions.len() + 1).saturating_sub(SESSIONS_PER_USER_MAX);
        for session in &sessions[..surplus] {
            self.accounts().delete_session(&session.id).await.map_err(internal)?;
        }
        Ok(())
    }

    /// Ends a session; the cookie that removes the browser's goes into the answer.
    ///
    /// # Errors
    /// A [`Problem`] when the store fails.
    pub async fn sign_out(&self, session: &SessionId) -> Result<Cookie<'static>, Problem> {
        self.accounts().delete_session(session).await.map_err(internal)?;
        Ok(self.cookie(String::new(), Duration::ZERO))
    }
}

fn wrong_credentials() -> Problem {
    let detail = "User name, password or code is wrong.";
    Problem::new(StatusCode::UNAUTHORIZED, "WRONG_CREDENTIALS", detail)
}
