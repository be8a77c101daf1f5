//! Users of the broker: secrets, permissions, and the table of them.

use std::{collections::HashMap, fmt};

use parking_lot::RwLock;
use sha2::{Digest, Sha256};
use subtle::ConstantTimeEq;

use crate::address::{AddressPattern, QueueName};

/// Source of users. Read within the SASL exchange and at every attach, so an implementation answers
/// from memory. Users may change at any time; after removing one, also call
/// `BrokerHandle::disconnect_user`.
pub trait CredentialSource: Send + Sync + 'static {
    /// Returns the user of that name.
    fn user(&self, name: &str) -> Option<BrokerUser>;
}

/// Account with the addresses that it may write and read.
#[derive(Debug, Clone, Default)]
pub struct BrokerUser {
    /// Valid secrets; more than one while a secret is being rotated.
    pub secrets: Vec<SecretHash>,
    pub permissions: Permissions,
    /// Organisation on whose share the user draws, too; none where that is not known.
    pub organisation: Option<String>,
    /// True for the broker's owner, which has links for all others: their number is bounded for each of
    /// its connections alone.
    pub is_owner: bool,
}

/// SHA-256 of a secret. Only for secrets of high entropy (at least 128 random bits); passwords that
/// people choose need a slow hash.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct SecretHash([u8; 32]);

/// Address patterns that a user may use; none match by default.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Permissions {
    /// Addresses to receive from.
    pub consume: Vec<AddressPattern>,
    /// Addresses to send to.
    pub produce: Vec<AddressPattern>,
}

impl SecretHash {
    /// Returns the SHA-256 of a secret, which is never stored itself.
    #[must_use]
    pub fn of(secret: &[u8]) -> Self {
        Self(Sha256::digest(secret).into())
    }

    /// Returns the hash that [`as_bytes`](Self::as_bytes) gave.
    #[must_use]
    pub const fn from_bytes(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    /// Returns the 32 bytes to store.
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
    /// Returns a user with one secret and no permissions.
    #[must_use]
    pub fn with_secret(secret: &[u8]) -> Self {
        Self { secrets: vec![SecretHash::of(secret)], ..Self::default() }
    }

    /// Lets the user draw on the share of an organisation, too.
    #[must_use]
    pub fn of_organisation(mut self, organisation: impl Into<String>) -> Self {
        self.organisation = Some(organisation.into());
        self
    }

    /// Marks the user as the broker's owner.
    #[must_use]
    pub fn as_owner(mut self) -> Self {
        self.is_owner = true;
        self
    }

    /// Permits receiving from matching addresses.
    #[must_use]
    pub fn may_consume(mut self, pattern: AddressPattern) -> Self {
        self.permissions.consume.push(pattern);
        self
    }

    /// Permits sending to matching addresses.
    #[must_use]
    pub fn may_produce(mut self, pattern: AddressPattern) -> Self {
        self.permissions.produce.push(pattern);
        self
    }
}

impl Permissions {
    /// Returns true if receiving from the queue is permitted.
    #[must_use]
    pub fn permits_consuming(&self, queue: &QueueName) -> bool {
        self.consume.iter().any(|p| p.matches(queue))
    }

    /// Returns true if sending to the queue is permitted.
    #[must_use]
    pub fn permits_producing(&self, queue: &QueueName) -> bool {
        self.produce.iter().any(|p| p.matches(queue))
    }
}

/// Returns true if the secret is one of the user's. Takes the same time for unknown users and wrong
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

/// Table of users in memory, changed while the broker runs.
#[derive(Debug, Default)]
pub struct CredentialTable {
    users: RwLock<HashMap<String, BrokerUser>>,
}

impl CredentialTable {
    /// Returns a table without users.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds or replaces a user.
    pub fn put(&self, name: impl Into<String>, user: BrokerUser) {
        self.users.write().insert(name.into(), user);
    }

    /// Removes a user and returns it.
    pub fn remove(&self, name: &str) -> Option<BrokerUser> {
        self.users.write().remove(name)
    }

    /// Returns all users.
    #[must_use]
    pub fn all(&self) -> HashMap<String, BrokerUser> {
        self.users.read().clone()
    }

    /// Replaces all users at once.
    pub fn replace(&self, users: HashMap<String, BrokerUser>) {
        *self.users.write() = users;
    }
}

impl CredentialSource for CredentialTable {
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
