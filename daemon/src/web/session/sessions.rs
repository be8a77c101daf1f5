//! Sessions: sign-in, sign-out, and the user of a cookie.

use std::{
    sync::Arc,
    time::{Duration, SystemTime},
};

use axum::{
    extract::FromRequestParts,
    http::{StatusCode, request::Parts},
};
use axum_extra::extract::cookie::{Cookie, SameSite};
use base64::{Engine, engine::general_purpose::URL_SAFE_NO_PAD};
use rand::RngCore;

use super::{
    accounts::{Accounts, AccountsError, SessionId, StoredSession},
    credentials::{Caller, SignIn},
    hashing::{HashingError, PasswordHashing},
    sign_in_gate::{SignInGate, busy, count},
    throttle::ThrottleConfig,
};
use crate::web::problem::Problem;

/// Header that carries the CSRF token of a session with every change.
pub const CSRF_HEADER: &str = "x-csrf-token";

/// Cookie, lifetime and bounds of sessions.
#[derive(Debug, Clone)]
pub struct SessionConfig {
    /// The cookie's name. Cookies know no ports, so daemons that may share a host need different
    /// names.
    pub cookie_name: String,
    /// True where pages are served over TLS: the cookie is then sent over TLS only.
    pub is_secure: bool,
    /// Time after which a session ends.
    pub lifetime: Duration,
    /// Limits of attempts to sign in.
    pub throttle: ThrottleConfig,
    /// Interval at which a live stream checks that its session has not ended.
    pub stream_check_interval: Duration,
}

impl SessionConfig {
    /// Twelve hours, the default throttle; live streams end within five seconds after their
    /// session.
    #[must_use]
    pub fn new(cookie_name: impl Into<String>, is_secure: bool) -> Self {
        Self {
            cookie_name: cookie_name.into(),
            is_secure,
            lifetime: Duration::from_secs(12 * 3600),
            throttle: ThrottleConfig::default(),
            stream_check_interval: Duration::from_secs(5),
        }
    }
}

/// Sessions over the daemon's accounts: signs users in and out. Clones share everything.
pub struct Sessions<A: Accounts> {
    inner: Arc<Inner<A>>,
}

struct Inner<A> {
    config: SessionConfig,
    accounts: A,
    gate: SignInGate,
    hashing: PasswordHashing,
}

/// Signed-in user of a request; an extractor for handlers.
#[derive(Clone)]
pub struct SignedIn<P> {
    /// Id of the session, to end it.
    pub session: SessionId,
    pub principal: P,
    /// Token that requests with changes must carry in `x-csrf-token`; pages get it with their user.
    pub csrf_token: String,
}

impl<P: std::fmt::Debug> std::fmt::Debug for SignedIn<P> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SignedIn").field("principal", &self.principal).finish_non_exhaustive()
    }
}

impl<P: Clone + Send + Sync + 'static, S: Send + Sync> FromRequestParts<S> for SignedIn<P> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        parts.extensions.get::<Self>().cloned().ok_or_else(Problem::unauthorized)
    }
}

impl<A: Accounts> Clone for Sessions<A> {
    fn clone(&self) -> Self {
        Self { inner: Arc::clone(&self.inner) }
    }
}

impl<A: Accounts> std::fmt::Debug for Sessions<A> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Sessions").field("config", &self.inner.config).finish_non_exhaustive()
    }
}

impl<A: Accounts> Sessions<A> {
    /// Returns sessions over the daemon's accounts. All that hashes passwords in the daemon shares
    /// `hashing`.
    #[must_use]
    pub fn new(config: SessionConfig, accounts: A, hashing: PasswordHashing) -> Self {
        let gate = SignInGate::new(config.throttle.clone());
        Self { inner: Arc::new(Inner { config, accounts, gate, hashing }) }
    }

    pub(super) fn config(&self) -> &SessionConfig {
        &self.inner.config
    }

    /// Returns the accounts of the daemon.
    #[must_use]
    pub fn accounts(&self) -> &A {
        &self.inner.accounts
    }

    /// Returns the work of hashing, for new passwords.
    #[must_use]
    pub fn hashing(&self) -> &PasswordHashing {
        &self.inner.hashing
    }

    /// Checks a password and opens a session; the cookie goes into the answer.
    ///
    /// # Errors
    /// A [`Problem`]: 401 for a wrong name or password (without saying which), 429 after
    /// too many attempts, 503 when too many sign in at once.
    pub async fn sign_in(
        &self,
        caller: &Caller,
        sign_in: &SignIn,
    ) -> Result<(Cookie<'static>, SignedIn<A::Principal>), Problem> {
        let user_name = sign_in.user_name.as_str();
        let open = self.inner.gate.enter(caller.address, user_name).await?;
        let principal = match self.verified(sign_in).await {
            Ok(Some(principal)) => principal,
            Ok(None) => {
                drop(open);
                count("refused");
                tracing::warn!(client = %caller.address, "An attempt to sign in was refused.");
                return Err(wrong_credentials());
            }
            Err(problem) => {
                open.withdrawn();
                return Err(problem);
            }
        };
        open.succeeded();
        count("accepted");

        let token = random_token();
        let id = SessionId::of(&token);
        let session = StoredSession {
            id: id.clone(),
            user_name: user_name.to_owned(),
            csrf_token: random_token(),
            expires_at: now() + self.inner.config.lifetime,
        };
        self.inner.accounts.put_session(&session).await.map_err(internal)?;
        let signed_in = SignedIn { session: id, principal, csrf_token: session.csrf_token };
        Ok((self.cookie(token, self.inner.config.lifetime), signed_in))
    }

    /// Returns the user where name and password are right.
    async fn verified(&self, sign_in: &SignIn) -> Result<Option<A::Principal>, Problem> {
        let user_name = sign_in.user_name.as_str();
        let hash = self.inner.accounts.password_hash(user_name).await.map_err(internal)?;
        if !self.inner.hashing.verify(hash, sign_in.password.clone()).await.map_err(not_hashed)? {
            return Ok(None);
        }
        self.inner.accounts.principal(user_name).await.map_err(internal)
    }

    /// Ends a session; the cookie that removes the browser's goes into the answer.
    ///
    /// # Errors
    /// A [`Problem`] when the store fails.
    pub async fn sign_out(&self, session: &SessionId) -> Result<Cookie<'static>, Problem> {
        self.inner.accounts.delete_session(session).await.map_err(internal)?;
        Ok(self.cookie(String::new(), Duration::ZERO))
    }

    /// Returns the user whose session a cookie's token belongs to; `None` for an ended session.
    pub(super) async fn resume(
        &self,
        token: &str,
    ) -> Result<Option<SignedIn<A::Principal>>, AccountsError> {
        let id = SessionId::of(token);
        let Some(session) = self.inner.accounts.session(&id).await? else { return Ok(None) };
        if session.expires_at <= now() {
            self.inner.accounts.delete_session(&id).await?;
            return Ok(None);
        }
        let principal = self.inner.accounts.principal(&session.user_name).await?;
        Ok(principal.map(|principal| SignedIn {
            session: id,
            principal,
            csrf_token: session.csrf_token,
        }))
    }

    /// Waits for the check interval of streams; then returns true while the session of a cookie's
    /// token lasts.
    pub(super) async fn is_valid_after_pause(&self, token: &str) -> bool {
        tokio::time::sleep(self.inner.config.stream_check_interval).await;
        // A short failure of the store must not end sessions.
        self.resume(token).await.map_or(true, |signed_in| signed_in.is_some())
    }

    fn cookie(&self, token: String, max_age: Duration) -> Cookie<'static> {
        let seconds = i64::try_from(max_age.as_secs()).unwrap_or(i64::MAX);
        Cookie::build((self.inner.config.cookie_name.clone(), token))
            .path("/")
            .http_only(true)
            .same_site(SameSite::Strict)
            .secure(self.inner.config.is_secure)
            .max_age(time::Duration::seconds(seconds))
            .build()
    }
}

fn wrong_credentials() -> Problem {
    let detail = "User name or password is wrong.";
    Problem::new(StatusCode::UNAUTHORIZED, "WRONG_CREDENTIALS", detail)
}

/// Returns the problem of a password that was not checked.
fn not_hashed(error: HashingError) -> Problem {
    match error {
        HashingError::Busy => busy(),
        HashingError::Password(_) | HashingError::Broken => Problem::internal(&error),
    }
}

pub(super) fn internal(error: AccountsError) -> Problem {
    Problem::internal(error.0.as_ref())
}

/// Returns the time by which sessions end.
#[expect(clippy::disallowed_methods, reason = "the clock of sessions")]
fn now() -> SystemTime {
    SystemTime::now()
}

/// 256 random bits as text that fits cookies, headers and command lines.
#[must_use]
pub fn random_token() -> String {
    let mut bytes = [0_u8; 32];
    rand::rng().fill_bytes(&mut bytes);
    URL_SAFE_NO_PAD.encode(bytes)
}
