//! Passwords as Argon2id hashes (RFC 9106), in the PHC text form.

use argon2::{
    Algorithm, Argon2, Block, Params, Version,
    password_hash::{self, Output, PasswordHash as ParsedHash, SaltString},
};
use rand::RngCore;
use subtle::ConstantTimeEq;

use crate::Confidential;

/// The hash of a password; `$argon2id$...`.
#[derive(Clone, PartialEq, Eq)]
pub struct PasswordHash(String);

/// A password is refused or could not be hashed.
#[derive(Debug, thiserror::Error)]
pub enum PasswordError {
    #[error("a password needs at least {min} characters")]
    TooShort {
        /// The least number of characters.
        min: usize,
    },
    /// Longer than anybody types.
    #[error("a password has at most {max} bytes")]
    TooLong {
        /// The greatest number of bytes.
        max: usize,
    },
    /// The hash function failed.
    #[error("the password could not be hashed: {0}")]
    Hash(argon2::password_hash::Error),
}

/// Requirements of passwords: length, no composition rules (NIST SP 800-63B §5.1.1).
#[derive(Debug, Clone, Copy)]
pub struct PasswordPolicy {
    /// The least number of characters.
    pub characters_min: usize,
}

impl Default for PasswordPolicy {
    fn default() -> Self {
        Self { characters_min: 10 }
    }
}

/// Bound on the work of hashing that a request can cause.
const PASSWORD_BYTES_MAX: usize = 1024;
/// Longest salt of a stored hash.
const SALT_BYTES_MAX: usize = 64;

impl PasswordHash {
    /// Hashes a password that fulfils the policy. Takes some tens of milliseconds of CPU.
    ///
    /// # Errors
    /// [`PasswordError`].
    pub fn of(
        password: &Confidential<String>,
        policy: PasswordPolicy,
    ) -> Result<Self, PasswordError> {
        Self::with_memory(password, policy, &mut HashMemory::default())
    }

    /// Hashes a password in memory that is used again.
    pub(super) fn with_memory(
        password: &Confidential<String>,
        policy: PasswordPolicy,
        memory: &mut HashMemory,
    ) -> Result<Self, PasswordError> {
        let password = password.expose();
        if password.chars().count() < policy.characters_min {
            return Err(PasswordError::TooShort { min: policy.characters_min });
        }
        if password.len() > PASSWORD_BYTES_MAX {
            return Err(PasswordError::TooLong { max: PASSWORD_BYTES_MAX });
        }
        let mut salt = [0_u8; 16];
        rand::rng().fill_bytes(&mut salt);
        let salt = SaltString::encode_b64(&salt).map_err(PasswordError::Hash)?;
        let method = Method {
            algorithm: Algorithm::default(),
            version: Version::default(),
            params: Params::default(),
        };
        let hash = method.hash(password, &salt, Params::DEFAULT_OUTPUT_LEN, memory);
        let phc = ParsedHash {
            algorithm: method.algorithm.ident(),
            version: Some(method.version.into()),
            params: (&method.params).try_into().map_err(PasswordError::Hash)?,
            salt: Some(salt.as_salt()),
            hash: Some(hash.map_err(PasswordError::Hash)?),
        };
        Ok(Self(phc.to_string()))
    }

    /// Takes the text that [`as_str`](Self::as_str) gave; a broken one never verifies.
    #[must_use]
    pub const fn from_stored(hash: String) -> Self {
        Self(hash)
    }

    /// Returns the hash as PHC string: algorithm, parameters, salt and digest.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Returns true when this is the hash of the password. Takes some tens of milliseconds of CPU.
    #[must_use]
    pub fn is_of(&self, password: &Confidential<String>) -> bool {
        self.is_of_with_memory(password, &mut HashMemory::default())
    }

    /// Compares in memory that is used again.
    pub(super) fn is_of_with_memory(
        &self,
        password: &Confidential<String>,
        memory: &mut HashMemory,
    ) -> bool {
        let password = password.expose();
        password.len() <= PASSWORD_BYTES_MAX
            && self.computed_again(password, memory).is_some_and(|(stored, computed)| {
                bool::from(stored.as_bytes().ct_eq(computed.as_bytes()))
            })
    }

    /// Returns the stored digest and that of a password with the same salt and costs; `None` for a
    /// broken hash.
    fn computed_again(&self, password: &str, memory: &mut HashMemory) -> Option<(Output, Output)> {
        let parsed = ParsedHash::new(&self.0).ok()?;
        let (stored, salt) = (parsed.hash?, SaltString::from_b64(parsed.salt?.as_str()).ok()?);
        let method = Method::of(&parsed).ok()?;
        let computed = method.hash(password, &salt, stored.len(), memory).ok()?;
        Some((stored, computed))
    }
}

/// Memory that Argon2 fills, 19 MiB with the default costs. It is kept for the next hash: given back to
/// the allocator each time, blocks of this size lie about in the arenas of all threads.
#[derive(Default)]
pub(super) struct HashMemory(Vec<Block>);

/// Function and costs of a hash.
struct Method {
    algorithm: Algorithm,
    version: Version,
    params: Params,
}

impl Method {
    fn of(parsed: &ParsedHash<'_>) -> password_hash::Result<Self> {
        Ok(Self {
            algorithm: Algorithm::try_from(parsed.algorithm)?,
            version: parsed.version.map_or(Ok(Version::default()), Version::try_from)?,
            params: Params::try_from(parsed)?,
        })
    }

    fn hash(
        &self,
        password: &str,
        salt: &SaltString,
        output_bytes: usize,
        memory: &mut HashMemory,
    ) -> password_hash::Result<Output> {
        let mut salt_bytes = [0; SALT_BYTES_MAX];
        let salt_bytes = salt.decode_b64(&mut salt_bytes)?;
        let blocks = self.params.block_count();
        if memory.0.len() < blocks {
            memory.0.resize(blocks, Block::default());
        }
        let argon2 = Argon2::new(self.algorithm, self.version, self.params.clone());
        Output::init_with(output_bytes, |output| {
            let memory = memory.0.as_mut_slice();
            argon2
                .hash_password_into_with_memory(password.as_bytes(), salt_bytes, output, memory)
                .map_err(Into::into)
        })
    }
}

impl std::fmt::Debug for PasswordHash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("<password hash>")
    }
}

/// A hash that no password has; compared with where there is no user, so that time does not tell.
const NOBODY: &str = "$argon2id$v=19$m=19456,t=2,p=1$bm9ib2R5bm9ib2R5bm9i$QUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUE";

/// Returns the hash that no password has.
pub(super) fn nobodys_hash() -> PasswordHash {
    PasswordHash(NOBODY.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_right_password_fits() {
        let hash = PasswordHash::of(&"correct horse".into(), PasswordPolicy::default())
            .expect("long enough");
        assert!(hash.is_of(&"correct horse".into()));
        assert!(!hash.is_of(&"correct hors".into()));
        assert!(hash.as_str().starts_with("$argon2id$v=19$"));
        assert!(!format!("{hash:?}").contains("argon2"));
    }

    #[test]
    fn hashes_cost_what_is_recommended() {
        // OWASP Password Storage Cheat Sheet: Argon2id with at least 19 MiB of memory, 2 passes and
        // 1 lane.
        for hash in [
            PasswordHash::of(&"correct horse".into(), PasswordPolicy::default())
                .expect("long enough")
                .0,
            NOBODY.into(),
        ] {
            let parsed = ParsedHash::new(&hash).expect("well-formed");
            assert_eq!((parsed.algorithm.as_str(), parsed.version), ("argon2id", Some(0x13)));
            let cost = |name| parsed.params.get_decimal(name).expect("a parameter");
            assert!(cost("m") >= 19 * 1024 && cost("t") >= 2 && cost("p") >= 1, "{hash}");
        }
        let of = || {
            PasswordHash::of(&"correct horse".into(), PasswordPolicy::default())
                .expect("long enough")
        };
        assert_ne!(of(), of(), "each has a salt of its own");
        let hash = of();
        let parsed = ParsedHash::new(&hash.0).expect("well-formed");
        assert!(parsed.salt.expect("a salt").as_str().len() >= 22, "16 bytes in base64");
    }

    #[test]
    fn short_and_endless_passwords_are_refused() {
        let policy = PasswordPolicy::default();
        assert!(matches!(
            PasswordHash::of(&"short".into(), policy),
            Err(PasswordError::TooShort { min: 10 })
        ));
        assert!(matches!(
            PasswordHash::of(&"x".repeat(2000).into(), policy),
            Err(PasswordError::TooLong { .. })
        ));
    }

    #[test]
    fn the_stand_in_hash_is_well_formed() {
        assert!(
            ParsedHash::new(NOBODY).is_ok(),
            "otherwise unknown users would be told by the time"
        );
    }
}
