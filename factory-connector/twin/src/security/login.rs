//! Sign-in of users: names and passwords through the connector's [`Authenticator`], roles in the
//! session's token.

use std::{
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

use super::throttle::Throttle;
use crate::{
    access::Authenticator,
    config::SecurityConfig,
    session_token::{token_of, user_of},
};

/// Time limit of a password check.
const AUTHENTICATION_TIMEOUT: Duration = Duration::from_secs(10);
/// Longest user name and password checked, in bytes. Any client may send one before it is known.
const CREDENTIAL_BYTES_MAX: usize = 1024;
/// The stack's id of the policy for anonymous users.
const ANONYMOUS_POLICY_ID: &str = "anonymous";

/// Authenticates users.
pub(crate) struct Login {
    authenticator: Arc<dyn Authenticator>,
    throttle: Mutex<Throttle>,
    allow_anonymous: bool,
}

impl Login {
    /// Creates the sign-in with its throttle.
    pub fn new(authenticator: Arc<dyn Authenticator>, config: &SecurityConfig) -> Self {
        Self {
            authenticator,
            throttle: Mutex::new(Throttle::new(config.login_failures_max, config.login_window())),
            allow_anonymous: config.allow_anonymous_unencrypted,
        }
    }

    fn refuse(user: &str, reason: &'static str) -> Error {
        tracing::warn!(user.name = user, reason, "The twin refused a sign-in.");
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

    async fn authenticate_username_identity_token(
        &self,
        _endpoint: &ServerEndpoint,
        username: &str,
        password: &Password,
    ) -> Result<UserToken, Error> {
        if username.len() > CREDENTIAL_BYTES_MAX || password.get().len() > CREDENTIAL_BYTES_MAX {
            return Err(Self::refuse("", "the credentials are too long"));
        }
        if !self.throttle.lock().may_try(username, Instant::now()) {
            return Err(Self::refuse(username, "too many wrong attempts"));
        }
        let authentication = self.authenticator.authenticate(username, password.get());
        match tokio::time::timeout(AUTHENTICATION_TIMEOUT, authentication).await {
            Ok(Some(role)) => {
                self.throttle.lock().succeeded(username);
                count("accepted");
                tracing::info!(user.name = username, %role, "A user signed in to the twin.");
                Ok(token_of(username, role))
            }
            Ok(None) => {
                self.throttle.lock().failed(username, Instant::now());
                Err(Self::refuse(username, "the user name or password is wrong"))
            }
            Err(_) => Err(Self::refuse(username, "checking the password took too long")),
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
