//! Cookie, lifetime and bounds of sessions.

use std::time::Duration;

use super::{
    throttle::ThrottleConfig,
    webauthn::{PasskeysUnavailable, RelyingParty},
};
use crate::web::shares::FairShareConfig;

/// Cookie, lifetime and bounds of sessions.
#[derive(Debug, Clone)]
pub struct SessionConfig {
    pub(super) cookie_name: String,
    /// True where pages are served over TLS: the cookie is then sent over TLS only.
    pub(super) is_secure: bool,
    /// Name of the daemon in authenticator apps.
    pub issuer: String,
    /// Time after which a session ends.
    pub lifetime: Duration,
    /// Time without a request after which a session ends. Open pages ask by themselves.
    pub idle_max: Duration,
    /// Limits of attempts to sign in.
    pub throttle: ThrottleConfig,
    /// Shares of people and organisations in requests, downloads and live streams.
    pub shares: FairShareConfig,
    /// Interval at which a live stream checks that its session has not ended.
    pub stream_check_interval: Duration,
    /// Domain and origin of the pages for passkeys, or the reason why there are none.
    pub relying_party: Result<RelyingParty, PasskeysUnavailable>,
    /// Time in which an authenticator has to answer.
    pub challenge_lifetime: Duration,
}

impl SessionConfig {
    /// Twelve hours, one without use, the default throttle; live streams end within five seconds after
    /// their session.
    ///
    /// Cookies know no ports, so the name of the cookie is the daemon's with its port. Over TLS it
    /// begins with `__Host-`: browsers take such a cookie from this host over TLS alone. Passkeys are for
    /// pages at `public_url`.
    #[must_use]
    pub fn new(
        daemon: &str,
        issuer: impl Into<String>,
        is_secure: bool,
        port: u16,
        public_url: &str,
    ) -> Self {
        let prefix = if is_secure { "__Host-" } else { "" };
        Self {
            cookie_name: format!("{prefix}{daemon}_{port}"),
            is_secure,
            issuer: issuer.into(),
            lifetime: Duration::from_secs(12 * 3600),
            idle_max: Duration::from_secs(3600),
            throttle: ThrottleConfig::default(),
            shares: FairShareConfig::default(),
            stream_check_interval: Duration::from_secs(5),
            relying_party: RelyingParty::of(public_url),
            challenge_lifetime: Duration::from_secs(120),
        }
    }

    /// Returns the name of the session's cookie.
    #[must_use]
    pub fn cookie_name(&self) -> &str {
        &self.cookie_name
    }
}
