//! Sign-in of users: names and passwords through the connector's [`Authenticator`], roles in the
//! session's token. The authenticator counts attempts together with those of the pages; the throttle here bounds what a
//! client may ask of it.

use std::{
    net::{IpAddr, SocketAddr},
    sync::Arc,
    time::{Duration, Instant},
};

use async_trait::async_trait;
use opcua_stack::opcua::{
    server::{
        ServerEndpoint,
        authenticator::{
            AuthManager, CoreServerPermissions, Password, UserToken, user_pass_security_policy_id,
        },
    },
    types::{Error, MessageSecurityMode, StatusCode, UAString, UserTokenPolicy, UserTokenType},
};
use parking_lot::Mutex;
use tokio::sync::Semaphore;

use super::{connections::network_of, throttle::Throttle};
use crate::{
    access::{Authenticator, Role, SignInRefusal},
    config::SecurityConfig,
    session_token::{token_of, user_of},
};

/// Time limit of a password check, with the wait for its turn.
const AUTHENTICATION_TIMEOUT: Duration = Duration::from_secs(10);
/// Password checks at the same time. Each takes a core for tens of milliseconds, and 19 MiB.
const CHECKS_AT_ONCE_MAX: usize = 2;
/// Password checks that run or wait. Those beyond are refused at once.
const CHECKS_MAX: usize = 32;
/// Longest user name and password checked, in bytes. Any client may send one before it is known.
const CREDENTIAL_BYTES_MAX: usize = 1024;
/// The stack's id of the policy for anonymous users.
const ANONYMOUS_POLICY_ID: &str = "anonymous";

/// Authenticates users.
pub(crate) struct Login {
    authenticator: Arc<dyn Authenticator>,
    throttle: Mutex<Throttle>,
    checks: Semaphore,
    waiting: Semaphore,
    allow_anonymous: bool,
}

impl Login {
    /// Creates the sign-in with its throttle.
    pub fn new(authenticator: Arc<dyn Authenticator>, config: &SecurityConfig) -> Self {
        Self {
            authenticator,
            throttle: Mutex::new(Throttle::new(config.login_failures_max, config.login_window())),
            checks: Semaphore::new(CHECKS_AT_ONCE_MAX),
            waiting: Semaphore::new(CHECKS_MAX),
            allow_anonymous: config.allow_anonymous_unencrypted,
        }
    }

    /// Checks a password when it is its turn; `None` where that took too long or too many wait.
    async fn check(
        &self,
        username: &str,
        password: &Password,
        client: Option<IpAddr>,
    ) -> Option<Result<Role, SignInRefusal>> {
        let _place = self.waiting.try_acquire().ok()?;
        let check = async {
            let _turn = self.checks.acquire().await.expect("the semaphore is never closed");
            self.authenticator.authenticate(username, password.get(), client).await
        };
        tokio::time::timeout(AUTHENTICATION_TIMEOUT, check).await.ok()
    }

    /// Refuses a sign-in. Its name is not logged: people type passwords into the wrong box.
    fn refuse(user: &str, address: Option<SocketAddr>, reason: &'static str) -> Error {
        tracing::warn!(
            user.name_length = user.chars().count(),
            peer.address = address.map(tracing::field::display),
            reason,
            "The twin refused a sign-in."
        );
        count("refused");
        // The client does not learn whether the name or the password was wrong, or that attempts are
        // throttled.
        Error::new(StatusCode::BadIdentityTokenRejected, "the user name or password is wrong")
    }
}

fn count(outcome: &'static str) {
    metrics::counter!("twin_sign_ins_total", "outcome" => outcome).increment(1);
}

fn is_encrypted(endpoint: &ServerEndpoint) -> bool {
    endpoint.message_security_mode() != MessageSecurityMode::None
}

#[async_trait]
impl AuthManager for Login {
    async fn authenticate_anonymous_token(&self, endpoint: &ServerEndpoint) -> Result<(), Error> {
        if self.allow_anonymous && !is_encrypted(endpoint) {
            return Ok(());
        }
        count("refused");
        Err(Error::new(
            StatusCode::BadIdentityTokenRejected,
            "sign in with a user name and password",
        ))
    }

    async fn authenticate_username_identity_token_from(
        &self,
        _endpoint: &ServerEndpoint,
        username: &str,
        password: &Password,
        address: Option<SocketAddr>,
    ) -> Result<UserToken, Error> {
        let refuse = |reason| Self::refuse(username, address, reason);
        if username.len() > CREDENTIAL_BYTES_MAX || password.get().len() > CREDENTIAL_BYTES_MAX {
            return Err(refuse("the credentials are too long"));
        }
        let network = address.map(|address| network_of(address.ip()));
        if !self.throttle.lock().begin(username, network, Instant::now()) {
            return Err(refuse("too many wrong attempts"));
        }
        match self.check(username, password, address.map(|address| address.ip())).await {
            Some(Ok(role)) => {
                self.throttle.lock().succeeded(username, network);
                count("accepted");
                tracing::info!(user.name = username, %role, "A user signed in to the twin.");
                Ok(token_of(username, role))
            }
            Some(Err(refusal)) => {
                if refusal != SignInRefusal::WrongCredentials {
                    self.throttle.lock().take_back(username, network);
                }
                if refusal == SignInRefusal::SecondFactorImpossible {
                    // The name is right, and an engineer has to know whom this is about.
                    tracing::warn!(user.name = username, "A user cannot sign in to the twin.");
                }
                Err(refuse(refusal.reason()))
            }
            None => {
                self.throttle.lock().take_back(username, network);
                Err(refuse("too many passwords wait for their check"))
            }
        }
    }

    fn user_token_policies(&self, endpoint: &ServerEndpoint) -> Vec<UserTokenPolicy> {
        let policy = |policy_id: UAString, token_type| UserTokenPolicy {
            policy_id,
            token_type,
            issued_token_type: UAString::null(),
            issuer_endpoint_url: UAString::null(),
            security_policy_uri: UAString::null(),
        };
        if is_encrypted(endpoint) {
            vec![policy(user_pass_security_policy_id(endpoint), UserTokenType::UserName)]
        } else if self.allow_anonymous {
            // A password would not be encrypted.
            vec![policy(ANONYMOUS_POLICY_ID.into(), UserTokenType::Anonymous)]
        } else {
            Vec::new()
        }
    }

    fn core_permissions(&self, token: &UserToken) -> CoreServerPermissions {
        CoreServerPermissions { read_diagnostics: user_of(token).role.may_write() }
    }
}

#[cfg(test)]
mod tests;
