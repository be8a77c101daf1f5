//! Input of a sign-in: credentials from the body, and facts about the caller.

use std::{fmt, net::IpAddr};

use axum::{
    extract::FromRequestParts,
    http::{header::USER_AGENT, request::Parts},
};
use axum_extra::extract::CookieJar;
use serde::{Deserialize, Deserializer};
use utoipa::ToSchema;

use crate::{
    Confidential,
    web::{client_address::ClientAddress, problem::Problem},
};

/// Longest name of a user in bytes.
const USER_NAME_BYTES_MAX: usize = 256;
/// Longest description of a browser that is kept, in characters.
const USER_AGENT_CHARS_MAX: usize = 200;

/// Name of a user, as sent by anybody.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UserName(String);

/// A name is too long to be anybody's.
#[derive(Debug, thiserror::Error)]
#[error("a user name has at most {USER_NAME_BYTES_MAX} bytes")]
pub struct UserNameError;

impl UserName {
    /// Takes a name of at most 256 bytes.
    ///
    /// # Errors
    /// [`UserNameError`].
    pub fn new(name: String) -> Result<Self, UserNameError> {
        if name.len() > USER_NAME_BYTES_MAX { Err(UserNameError) } else { Ok(Self(name)) }
    }

    /// Returns the name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl<'de> Deserialize<'de> for UserName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::new(String::deserialize(deserializer)?).map_err(serde::de::Error::custom)
    }
}

/// Assertion of a passkey as a browser sent it: `AuthenticationResponseJSON` of WebAuthn Level 3.
#[derive(Clone, Deserialize)]
#[serde(transparent)]
pub struct PasskeyAssertion(serde_json::Value);

impl PasskeyAssertion {
    pub(super) fn json(&self) -> String {
        self.0.to_string()
    }
}

impl fmt::Debug for PasskeyAssertion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("<assertion of a passkey>")
    }
}

/// User name, password and second factor.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SignIn {
    #[schema(value_type = String)]
    pub user_name: UserName,
    #[schema(value_type = String, format = Password)]
    pub password: Confidential<String>,
    /// A code from the authenticator app or a recovery code, for people with a second factor.
    #[serde(default)]
    #[schema(value_type = Option<String>)]
    pub code: Option<Confidential<String>>,
    /// Assertion of a passkey in place of a code: `AuthenticationResponseJSON` of WebAuthn Level 3.
    #[serde(default)]
    #[schema(value_type = Option<Object>)]
    pub passkey: Option<PasskeyAssertion>,
}

/// Origin of a sign-in: address, browser and cookies. An extractor for handlers.
#[derive(Debug, Clone)]
pub struct Caller {
    pub address: IpAddr,
    /// Browser as it calls itself, cut to 200 characters.
    pub user_agent: String,
    pub cookies: CookieJar,
}

impl<S: Send + Sync> FromRequestParts<S> for Caller {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let ClientAddress(address) = ClientAddress::from_request_parts(parts, state).await?;
        let user_agent = parts.headers.get(USER_AGENT).and_then(|value| value.to_str().ok());
        Ok(Self {
            address,
            user_agent: user_agent.unwrap_or("").chars().take(USER_AGENT_CHARS_MAX).collect(),
            cookies: CookieJar::from_headers(&parts.headers),
        })
    }
}
