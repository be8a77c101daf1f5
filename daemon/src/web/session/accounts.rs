//! Interface of sessions to the store of the daemon.

use std::{fmt, time::SystemTime};

use async_trait::async_trait;
use sha2::{Digest, Sha256};

use super::password::PasswordHash;

/// Users, sessions and second factors in the owner's store.
#[async_trait]
pub trait Accounts: Send + Sync + 'static {
    /// Signed-in user: name, role, and all else that the daemon's handlers decide by.
    type Principal: Clone + Send + Sync + 'static;

    /// Returns the organisation on whose share a user draws; `None` where there is but one, or none.
    fn organisation(_: &Self::Principal) -> Option<&str> {
        None
    }

    /// The hash of a user's password; `None` where there is no such user.
    async fn password_hash(&self, user_name: &str) -> Result<Option<PasswordHash>, AccountsError>;

    /// Returns the user as of now; `None` for an unknown or removed one.
    async fn principal(&self, user_name: &str) -> Result<Option<Self::Principal>, AccountsError>;

    /// Gives a user another password. Of the user's sessions only `kept` goes on.
    async fn set_password(
        &self,
        user_name: &str,
        password: &PasswordHash,
        kept: &SessionId,
    ) -> Result<(), AccountsError>;

    /// Stores a new session; expired ones may be removed on the way.
    async fn put_session(&self, session: &StoredSession) -> Result<(), AccountsError>;

    /// Looks a session up.
    async fn session(&self, id: &SessionId) -> Result<Option<StoredSession>, AccountsError>;

    /// Returns the sessions of a user, those that have ended by time included.
    async fn sessions_of(&self, user_name: &str) -> Result<Vec<StoredSession>, AccountsError>;

    /// Notes that a session was used.
    async fn touch_session(&self, id: &SessionId, at: SystemTime) -> Result<(), AccountsError>;

    /// Forgets a session that `change` ends, or that has ended by time; it is no error if there is none.
    async fn delete_session(
        &self,
        id: &SessionId,
        change: Option<AccountChange<'_>>,
    ) -> Result<(), AccountsError>;

    /// Returns the second factor of a user, also one that is not confirmed yet.
    async fn second_factor(
        &self,
        user_name: &str,
    ) -> Result<Option<StoredSecondFactor>, AccountsError>;

    /// Stores the second factor of a user in place of another.
    async fn put_second_factor(
        &self,
        user_name: &str,
        factor: &StoredSecondFactor,
        change: AccountChange<'_>,
    ) -> Result<(), AccountsError>;

    /// Removes the second factor of a user with recovery codes and passkeys; false if there was none.
    async fn delete_second_factor(
        &self,
        user_name: &str,
        change: AccountChange<'_>,
    ) -> Result<bool, AccountsError>;

    /// Notes that the code of a time step was used; false if this or a later one had been.
    async fn use_time_step(&self, user_name: &str, step: u64) -> Result<bool, AccountsError>;

    /// Uses a recovery code up; false if there is none with this digest.
    async fn use_recovery_code(&self, user_name: &str, digest: &str)
    -> Result<bool, AccountsError>;

    /// Returns the passkeys of a user, the oldest first.
    async fn passkeys(&self, user_name: &str) -> Result<Vec<StoredPasskey>, AccountsError>;

    /// Adds a passkey of a user, with recovery codes in place of others where there are new ones. False where
    /// its credential is stored already, or the user has [`PASSKEYS_MAX`].
    async fn add_passkey(
        &self,
        user_name: &str,
        passkey: &StoredPasskey,
        recovery_digests: Option<&[String]>,
        change: AccountChange<'_>,
    ) -> Result<bool, AccountsError>;

    /// Notes that a passkey was used. False if it was removed or used meanwhile.
    async fn use_passkey(&self, user_name: &str, used: &PasskeyUse) -> Result<bool, AccountsError>;

    /// Removes a passkey of a user, with the recovery codes where it was all of the second factor; false
    /// if there was none.
    async fn delete_passkey(
        &self,
        user_name: &str,
        passkey_id: &str,
        change: AccountChange<'_>,
    ) -> Result<bool, AccountsError>;
}

/// Passkeys of a user at most.
pub const PASSKEYS_MAX: usize = 8;
/// Length of the name by which authenticators know a user.
pub const USER_HANDLE_BYTES: usize = 16;
/// Length of the counter and flags of a passkey, as they are stored.
pub const DYNAMIC_STATE_BYTES: usize = 7;

/// Person and operation that change an account, for the daemon's record of changes.
#[derive(Debug, Clone, Copy)]
pub struct AccountChange<'c> {
    /// Name of the person who does it.
    pub by: &'c str,
    /// Id of the operation in the description of the API.
    pub operation: &'static str,
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
    pub started_at: SystemTime,
    /// Last use, to the minute.
    pub last_used_at: SystemTime,
    pub expires_at: SystemTime,
    /// Address from which the user signed in.
    pub address: String,
    /// Browser as it called itself, of bounded length.
    pub user_agent: String,
}

impl fmt::Debug for StoredSession {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StoredSession").field("user_name", &self.user_name).finish_non_exhaustive()
    }
}

/// Codes of a user's second factor as they are stored. Recovery codes are there for passkeys, too.
#[derive(Debug, Clone, Default)]
pub struct StoredSecondFactor {
    /// The secret in hexadecimal, sealed for [`second_factor_purpose`]; none where it was sealed with a key
    /// that is lost: then no code of the app is right.
    pub sealed_secret: Option<String>,
    /// False until a code of the app has come back, and where passkeys alone are on.
    pub is_confirmed: bool,
    /// Newest time step whose code was used.
    pub last_step: u64,
    /// Digests of the recovery codes that are left.
    pub recovery_digests: Vec<String>,
}

/// Passkey as it is stored. Its key is a public one: nothing of it is secret.
#[derive(Debug, Clone)]
pub struct StoredPasskey {
    /// Name of the passkey in the API.
    pub passkey_id: String,
    /// Name for its owner.
    pub name: String,
    /// Name of the credential at its authenticator, which no other passkey has.
    pub credential_id: Vec<u8>,
    /// Name by which the authenticator knows the user: random, the same for all passkeys of a user.
    pub user_handle: [u8; USER_HANDLE_BYTES],
    /// Ways to the authenticator, as bits of the library `webauthn_rp`.
    pub transports: u8,
    /// Public key and all else that stays, in the encoding of that library.
    pub static_state: Vec<u8>,
    /// Counter and flags, in the encoding of that library.
    pub dynamic_state: [u8; DYNAMIC_STATE_BYTES],
    pub created_at: SystemTime,
    /// Last sign-in with it.
    pub last_used_at: Option<SystemTime>,
}

/// Use of a passkey, with its counter before and after.
#[derive(Debug, Clone)]
pub struct PasskeyUse {
    pub passkey_id: String,
    pub former_state: [u8; DYNAMIC_STATE_BYTES],
    pub dynamic_state: [u8; DYNAMIC_STATE_BYTES],
    pub at: SystemTime,
}

/// Returns the purpose for which the secret of a user's second factor is sealed.
#[must_use]
pub fn second_factor_purpose(user_name: &str) -> String {
    format!("second-factor/{user_name}")
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
