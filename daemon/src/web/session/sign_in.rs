//! Signing in: name and password, then a second factor where one is on, then a session.

use axum::http::StatusCode;
use axum_extra::extract::cookie::Cookie;

use super::{
    accounts::{Accounts, SessionId, StoredSession},
    credentials::{Caller, SignIn},
    second_factor::ActiveFactors,
    sessions::{Sessions, SignedIn, internal, now, random_token, signs_out},
    sign_in_gate::count,
};
use crate::web::problem::{Problem, SecondFactorKind, SecondFactorNeeded};

/// Sessions of a user at once; one more ends the one that was used longest ago.
const SESSIONS_PER_USER_MAX: usize = 32;

/// Outcome of looking at credentials.
enum Decision<P> {
    Right(P),
    Wrong,
    /// Name and password are right, and there is no second factor where one is needed.
    FactorNeeded(SecondFactorNeeded),
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
        let principal = match self.decide(sign_in).await {
            Ok(Decision::Right(principal)) => principal,
            Ok(Decision::Wrong) => {
                drop(open);
                count("refused");
                tracing::warn!(client = %caller.address, "An attempt to sign in was refused.");
                return Err(wrong_credentials());
            }
            Ok(Decision::FactorNeeded(needed)) => {
                // Given back, but failures are not forgotten: else this would be the way to try as
                // many codes as one likes.
                open.withdrawn();
                count("code_needed");
                return Err(factor_needed(needed));
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

    async fn decide(&self, sign_in: &SignIn) -> Result<Decision<A::Principal>, Problem> {
        let user_name = sign_in.user_name.as_str();
        if !self.is_password(user_name, sign_in.password.clone()).await? {
            return Ok(Decision::Wrong);
        }
        let factors = self.second_factors(user_name).await?;
        if factors.is_any() {
            let is_right = match (&sign_in.code, &sign_in.passkey) {
                (Some(code), _) => self.is_code(user_name, code).await?,
                (None, Some(passkey)) => self.is_passkey(user_name, passkey).await?,
                (None, None) => {
                    return Ok(Decision::FactorNeeded(self.needed(user_name, &factors)?));
                }
            };
            if !is_right {
                return Ok(Decision::Wrong);
            }
        }
        let principal = self.accounts().principal(user_name).await.map_err(internal)?;
        Ok(principal.map_or(Decision::Wrong, Decision::Right))
    }

    /// Names the second factors of a user, with a challenge for the passkeys.
    fn needed(
        &self,
        user_name: &str,
        factors: &ActiveFactors,
    ) -> Result<SecondFactorNeeded, Problem> {
        let mut needed = SecondFactorNeeded { kinds: Vec::new(), passkey_options: None };
        if factors.has_codes {
            needed.kinds.push(SecondFactorKind::Code);
        }
        if !factors.passkeys.is_empty() {
            needed.kinds.push(SecondFactorKind::Passkey);
            needed.passkey_options = self.passkey_options(user_name, &factors.passkeys)?;
        }
        Ok(needed)
    }

    async fn open_session(
        &self,
        caller: &Caller,
        user_name: &str,
    ) -> Result<(Cookie<'static>, StoredSession), Problem> {
        if let Some(former) = caller.cookies.get(self.config().cookie_name()) {
            let former = SessionId::of(former.value());
            self.accounts()
                .delete_session(&former, signs_out(user_name))
                .await
                .map_err(internal)?;
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
            self.accounts()
                .delete_session(&session.id, signs_out(user_name))
                .await
                .map_err(internal)?;
        }
        Ok(())
    }
}

fn wrong_credentials() -> Problem {
    let detail = "User name, password or second factor is wrong.";
    Problem::new(StatusCode::UNAUTHORIZED, "WRONG_CREDENTIALS", detail)
}

/// Returns the problem of a sign-in that needs a second factor, too.
fn factor_needed(needed: SecondFactorNeeded) -> Problem {
    let detail = match needed.kinds[..] {
        [SecondFactorKind::Passkey] => "Signing in needs a passkey, or a recovery code.",
        [SecondFactorKind::Code] => {
            "Signing in needs a code from the authenticator app, or a recovery code."
        }
        _ => "Signing in needs a passkey, a code from the authenticator app, or a recovery code.",
    };
    Problem {
        second_factor: Some(Box::new(needed)),
        ..Problem::new(StatusCode::UNAUTHORIZED, "SECOND_FACTOR_NEEDED", detail)
    }
}
