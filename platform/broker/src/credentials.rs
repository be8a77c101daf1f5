//! Who may sign in, and what they may do.

use std::{collections::HashMap, fmt};

use parking_lot::RwLock;
use sha2::{Digest, Sha256};
use subtle::ConstantTimeEq;

use crate::address::{AddressPattern, QueueName};

/// The users of the broker. Asked within the SASL exchange and at every attach, so answers come
/// from memory; they may change at any time. After taking a user away also
/// [disconnect](crate::BrokerHandle::disconnect_user) it.
pub trait Credentials: Send + Sync + 'static {
    /// The user of that name.
    fn user(&self, name: &str) -> Option<BrokerUser>;
}

/// What the broker knows of a user.
#[derive(Debug, Clone, Default)]
pub struct BrokerUser {
    /// Its secrets; several are alive while one is being rotated.
    pub secrets: Vec<SecretHash>,
    /// What it may do.
    pub permissions: Permissions,
}

/// The SHA-256 of a secret. Only for secrets of high entropy (at least 128 random bits), never for
/// passwords that people choose: those need a slow hash.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct SecretHash([u8; 32]);

/// The addresses a user may use.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Permissions {
    /// May receive from these.
    pub consume: Vec<AddressPattern>,
    /// May send to these.
    pub produce: Vec<AddressPattern>,
}

impl SecretHash {
    /// The hash of a secret.
    #[must_use]
    pub fn of(secret: &[u8]) -> Self {
        Self(Sha256::digest(secret).into())
    }

    /// A hash as it was stored.
    #[must_use]
    pub const fn from_bytes(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    /// The hash, to store.
    #[must_use]
    pub const fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

impl fmt::Debug for SecretHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SecretHash(..)")
    }
}

impl BrokerUser {
    /// A user with one secret and no rights.
    #[must_use]
    pub fn with_secret(secret: &[u8]) -> Self {
        Self { secrets: vec![SecretHash::of(secret)], permissions: Permissions::default() }
    }

    /// Adds the right to receive from matching addresses.
    #[must_use]
    pub fn may_consume(mut self, pattern: AddressPattern) -> Self {
        self.permissions.consume.push(pattern);
        self
    }

    /// Adds the right to send to matching addresses.
    #[must_use]
    pub fn may_produce(mut self, pattern: AddressPattern) -> Self {
        self.permissions.produce.push(pattern);
        self
    }
}

impl Permissions {
    /// Whether receiving from the queue is permitted.
    #[must_use]
    pub fn permits_consuming(&self, queue: &QueueName) -> bool {
        self.consume.iter().any(|p| p.matches(queue))
    }

    /// Whether sending to the queue is permitted.
    #[must_use]
    pub fn permits_producing(&self, queue: &QueueName) -> bool {
        self.produce.iter().any(|p| p.matches(queue))
    }
}

/// Whether the secret is one of the user's. Takes the same time for unknown users and wrong
/// secrets.
pub(crate) fn is_authentic(user: Option<&BrokerUser>, secret: &[u8]) -> bool {
    let presented = SecretHash::of(secret);
    let no_secret = [SecretHash([0; 32])];
    let (known, is_known) = user.map_or((&no_secret[..], false), |u| (&u.secrets[..], true));
    let is_equal = known
        .iter()
        .fold(subtle::Choice::from(0), |found, hash| found | hash.0.ct_eq(&presented.0));
    bool::from(is_equal) && is_known
}

/// Users in memory.
#[derive(Debug, Default)]
pub struct CredentialTable {
    users: RwLock<HashMap<String, BrokerUser>>,
}

impl CredentialTable {
    /// A table without users.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds or replaces a user.
    pub fn put(&self, name: impl Into<String>, user: BrokerUser) {
        self.users.write().insert(name.into(), user);
    }

    /// Takes a user away.
    pub fn remove(&self, name: &str) -> Option<BrokerUser> {
        self.users.write().remove(name)
    }

    /// Replaces all users at once.
    pub fn replace(&self, users: HashMap<String, BrokerUser>) {
        *self.users.write() = users;
    }
}

impl Credentials for CredentialTable {
    fn user(&self, name: &str) -> Option<BrokerUser> {
        self.users.read().get(name).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_current_secret_is_authentic() {
        let mut user = BrokerUser::with_secret(b"old");
        user.secrets.push(SecretHash::of(b"new"));
        assert!(is_authentic(Some(&user), b"old"));
        assert!(is_authentic(Some(&user), b"new"));
        assert!(!is_authentic(Some(&user), b""));
        assert!(!is_authentic(Some(&user), b"other"));
        assert!(!is_authentic(None, b"old"));
        assert!(!is_authentic(Some(&BrokerUser::default()), b""));
    }
}
