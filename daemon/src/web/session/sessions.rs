//! Sessions: opened, the user of a cookie, and signing out.

use std::{
    sync::Arc,
    time::{Duration, SystemTime},
};

use axum::{extract::FromRequestParts, http::request::Parts};
use axum_extra::extract::cookie::{Cookie, SameSite};
use base64::{Engine, engine::general_purpose::URL_SAFE_NO_PAD};
use parking_lot::Mutex;
use rand::RngCore;

use super::{
    accounts::{AccountChange, Accounts, AccountsError, SessionId, StoredSession},
    credentials::Caller,
    hashing::{HashingError, PasswordHashing},
    known_cookies::KnownCookies,
    session_config::SessionConfig,
    sign_in_gate::{SignInGate, busy},
    webauthn::{AssertionState, OpenChallenges, RegistrationState},
};
use crate::{
    Confidential,
    sealing::Sealer,
    web::{
        problem::Problem,
        shares::{FairShares, StrangerShares},
    },
};

/// Header that carries the CSRF token of a session with every change.
pub const CSRF_HEADER: &str = "x-csrf-token";

/// Precision of a session's last use; noting each request would be a write for each.
const USE_PRECISION: Duration = Duration::from_secs(60);

/// Sessions of a user at once; one more ends the one that was used longest ago.
const SESSIONS_PER_USER_MAX: usize = 32;

/// Sessions over the daemon's accounts: signs users in and out. Clones share everything.
pub struct Sessions<A: Accounts> {
    inner: Arc<Inner<A>>,
}

struct Inner<A> {
    config: SessionConfig,
    accounts: A,
    gate: SignInGate,
    hashing: PasswordHashing,
    sealer: Sealer,
    shares: FairShares,
    strangers: StrangerShares,
    known_cookies: KnownCookies,
    registrations: Mutex<OpenChallenges<RegistrationState>>,
    assertions: Mutex<OpenChallenges<AssertionState>>,
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
    /// `hashing`; `sealer` seals the secrets of second factors.
    #[must_use]
    pub fn new(
        config: SessionConfig,
        accounts: A,
        hashing: PasswordHashing,
        sealer: Sealer,
    ) -> Self {
        let gate = SignInGate::new(config.throttle.clone());
        let shares = FairShares::new(config.shares.clone());
        let registrations = Mutex::new(OpenChallenges::new(config.challenge_lifetime));
        let assertions = Mutex::new(OpenChallenges::new(config.challenge_lifetime));
        let inner = Inner {
            config,
            accounts,
            gate,
            hashing,
            sealer,
            shares,
            strangers: StrangerShares::default(),
            known_cookies: KnownCookies::default(),
            registrations,
            assertions,
        };
        Self { inner: Arc::new(inner) }
    }

    /// Challenges of passkeys that are being made.
    pub(super) fn registrations(&self) -> &Mutex<OpenChallenges<RegistrationState>> {
        &self.inner.registrations
    }

    /// Challenges of sign-ins that wait for a passkey.
    pub(super) fn assertions(&self) -> &Mutex<OpenChallenges<AssertionState>> {
        &self.inner.assertions
    }

    pub(super) fn sealer(&self) -> &Sealer {
        &self.inner.sealer
    }

    pub(super) fn config(&self) -> &SessionConfig {
        &self.inner.config
    }

    pub(super) fn gate(&self) -> &SignInGate {
        &self.inner.gate
    }

    pub(super) fn shares(&self) -> &FairShares {
        &self.inner.shares
    }

    /// Returns the shares of requests without a session.
    pub(crate) fn strangers(&self) -> &StrangerShares {
        &self.inner.strangers
    }

    pub(super) fn known_cookies(&self) -> &KnownCookies {
        &self.inner.known_cookies
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
            self.inner.accounts.delete_session(&id, None).await?;
            return Ok(None);
        }
        let principal = self.inner.accounts.principal(&session.user_name).await?;
        if principal.is_some() && session.last_used_at + USE_PRECISION <= now {
            self.inner.accounts.touch_session(&id, now).await?;
        }
        if principal.is_some()
            && !self.known_cookies().has(&id)
            && let Ok(address) = session.address.parse()
        {
            // The places from which people signed in before the daemon's start are known by their sessions.
            self.gate().remember(address, &session.user_name);
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

impl<A: Accounts> Sessions<A> {
    /// Returns true if this is the password of a user that there is.
    pub(super) async fn is_password(
        &self,
        user_name: &str,
        password: Confidential<String>,
    ) -> Result<bool, Problem> {
        let hash = self.accounts().password_hash(user_name).await.map_err(internal)?;
        self.hashing().verify(hash, password).await.map_err(not_hashed)
    }

    /// Opens a session; the one that the browser had before ends.
    pub(super) async fn open_session(
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
        self.known_cookies().add(&session.id);
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

    /// Ends a session; the cookie that removes the browser's goes into the answer.
    ///
    /// # Errors
    /// A [`Problem`] when the store fails.
    pub async fn sign_out(
        &self,
        user: &SignedIn<A::Principal>,
    ) -> Result<Cookie<'static>, Problem> {
        let end = self.accounts().delete_session(&user.session, signs_out(&user.user_name));
        end.await.map_err(internal)?;
        Ok(self.cookie(String::new(), Duration::ZERO))
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

const fn signs_out(user_name: &str) -> Option<AccountChange<'_>> {
    Some(AccountChange { by: user_name, operation: "signOut" })
}
