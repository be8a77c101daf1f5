//! Interface of sessions to the store of the daemon.

use std::{fmt, time::SystemTime};

use async_trait::async_trait;
use sha2::{Digest, Sha256};

use super::password::PasswordHash;

/// Users and sessions in the owner's store.
#[async_trait]
pub trait Accounts: Send + Sync + 'static {
    /// Signed-in user: name, role, and all else that the daemon's handlers decide by.
    type Principal: Clone + Send + Sync + 'static;

    /// The hash of a user's password; `None` where there is no such user.
    async fn password_hash(&self, user_name: &str) -> Result<Option<PasswordHash>, AccountsError>;

    /// Returns the user as of now; `None` for an unknown or removed one.
    async fn principal(&self, user_name: &str) -> Result<Option<Self::Principal>, AccountsError>;

    /// Stores a new session; expired ones may be removed on the way.
    async fn put_session(&self, session: &StoredSession) -> Result<(), AccountsError>;

    /// Looks a session up.
    async fn session(&self, id: &SessionId) -> Result<Option<StoredSession>, AccountsError>;

    /// Forgets a session; it is no error if there is none.
    async fn delete_session(&self, id: &SessionId) -> Result<(), AccountsError>;
}

/// Failure of the daemon's account store, with the store's own error as source.
#[derive(Debug, thiserror::Error)]
#[error("the account store failed")]
pub struct AccountsError(#[source] pub Box<dyn std::error::Error + Send + Sync>);

impl AccountsError {
    /// Wraps the store's own error.
    pub fn new(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self(Box::new(error))
    }
}

/// Session as it is stored.
#[derive(Clone, PartialEq, Eq)]
pub struct StoredSession {
    /// The hash of its token.
    pub id: SessionId,
    pub user_name: String,
    /// Token that requests with changes must carry.
    pub csrf_token: String,
    pub expires_at: SystemTime,
}

impl fmt::Debug for StoredSession {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StoredSession").field("user_name", &self.user_name).finish_non_exhaustive()
    }
}

/// The SHA-256 of a session's token in hexadecimal: enough to find the session, not to take it
/// over.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct SessionId(String);

impl SessionId {
    /// The id of the session with this token.
    #[must_use]
    pub fn of(token: &str) -> Self {
        Self(hex::encode(Sha256::digest(token.as_bytes())))
    }

    /// Takes the text that [`as_str`](Self::as_str) gave, without a check.
    #[must_use]
    pub const fn from_stored(id: String) -> Self {
        Self(id)
    }

    /// Returns the id as hexadecimal digits; no token can be computed from it.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}
