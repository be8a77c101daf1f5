//! Sessions: their configuration, and the user of a cookie.

use std::{
    sync::Arc,
    time::{Duration, SystemTime},
};

use axum::{extract::FromRequestParts, http::request::Parts};
use axum_extra::extract::cookie::{Cookie, SameSite};
use base64::{Engine, engine::general_purpose::URL_SAFE_NO_PAD};
use rand::RngCore;

use super::{
    accounts::{Accounts, AccountsError, SessionId, StoredSession},
    hashing::{HashingError, PasswordHashing},
    sign_in_gate::{SignInGate, busy},
    throttle::ThrottleConfig,
};
use crate::web::problem::Problem;

/// Header that carries the CSRF token of a session with every change.
pub const CSRF_HEADER: &str = "x-csrf-token";

/// Precision of a session's last use; noting each request would be a write for each.
const USE_PRECISION: Duration = Duration::from_secs(60);

/// Cookie, lifetime and bounds of sessions.
#[derive(Debug, Clone)]
pub struct SessionConfig {
    cookie_name: String,
    /// True where pages are served over TLS: the cookie is then sent over TLS only.
    is_secure: bool,
    /// Name of the daemon in authenticator apps.
    pub issuer: String,
    /// Time after which a session ends.
    pub lifetime: Duration,
    /// Time without a request after which a session ends. Open pages ask by themselves.
    pub idle_max: Duration,
    /// Limits of attempts to sign in.
    pub throttle: ThrottleConfig,
    /// Interval at which a live stream checks that its session has not ended.
    pub stream_check_interval: Duration,
}

impl SessionConfig {
    /// Twelve hours, one without use, the default throttle; live streams end within five seconds after
    /// their session.
    ///
    /// Cookies know no ports, so the name of the cookie is the daemon's with its port. Over TLS it
    /// begins with `__Host-`: browsers take such a cookie from this host over TLS alone.
    #[must_use]
    pub fn new(daemon: &str, issuer: impl Into<String>, is_secure: bool, port: u16) -> Self {
        let prefix = if is_secure { "__Host-" } else { "" };
        Self {
            cookie_name: format!("{prefix}{daemon}_{port}"),
            is_secure,
            issuer: issuer.into(),
            lifetime: Duration::from_secs(12 * 3600),
            idle_max: Duration::from_secs(3600),
            throttle: ThrottleConfig::default(),
            stream_check_interval: Duration::from_secs(5),
        }
    }

    /// Returns the name of the session's cookie.
    #[must_use]
    pub fn cookie_name(&self) -> &str {
        &self.cookie_name
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
    pub user_name: String,
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

    pub(super) fn gate(&self) -> &SignInGate {
        &self.inner.gate
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

    /// Returns the user whose session a cookie's token belongs to; `None` for an ended session.
    pub(super) async fn resume(
        &self,
        token: &str,
    ) -> Result<Option<SignedIn<A::Principal>>, AccountsError> {
        let id = SessionId::of(token);
        let Some(session) = self.inner.accounts.session(&id).await? else { return Ok(None) };
        let now = now();
        if self.has_ended(&session, now) {
            self.inner.accounts.delete_session(&id).await?;
            return Ok(None);
        }
        let principal = self.inner.accounts.principal(&session.user_name).await?;
        if principal.is_some() && session.last_used_at + USE_PRECISION <= now {
            self.inner.accounts.touch_session(&id, now).await?;
        }
        Ok(principal.map(|principal| SignedIn {
            session: id,
            user_name: session.user_name,
            principal,
            csrf_token: session.csrf_token,
        }))
    }

    /// Returns the sessions of a user that have not ended.
    pub(super) async fn live_sessions(
        &self,
        user_name: &str,
    ) -> Result<Vec<StoredSession>, Problem> {
        let mut sessions = self.inner.accounts.sessions_of(user_name).await.map_err(internal)?;
        let now = now();
        sessions.retain(|session| !self.has_ended(session, now));
        Ok(sessions)
    }

    fn has_ended(&self, session: &StoredSession, now: SystemTime) -> bool {
        session.expires_at <= now || session.last_used_at + self.inner.config.idle_max <= now
    }

    /// Waits for the check interval of streams; then returns true while the session of a cookie's
    /// token lasts.
    pub(super) async fn is_valid_after_pause(&self, token: &str) -> bool {
        tokio::time::sleep(self.inner.config.stream_check_interval).await;
        // A short failure of the store must not end sessions.
        self.resume(token).await.map_or(true, |signed_in| signed_in.is_some())
    }

    pub(super) fn cookie(&self, token: String, max_age: Duration) -> Cookie<'static> {
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

/// Returns the problem of a password that was not checked.
pub(super) fn not_hashed(error: HashingError) -> Problem {
    match error {
        HashingError::Busy => busy(),
        HashingError::Password(_) | HashingError::Broken => Problem::internal(&error),
    }
}

pub(super) fn internal(error: AccountsError) -> Problem {
    Problem::internal(error.0.as_ref())
}

/// Returns the time by which sessions end and codes change.
#[expect(clippy::disallowed_methods, reason = "the clock of sessions")]
pub(super) fn now() -> SystemTime {
    SystemTime::now()
}

/// 256 random bits as text that fits cookies, headers and command lines.
#[must_use]
pub fn random_token() -> String {
    let mut bytes = [0_u8; 32];
    rand::rng().fill_bytes(&mut bytes);
    URL_SAFE_NO_PAD.encode(bytes)
}
