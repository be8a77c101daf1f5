//! Keys of signed notes, each with the name that its signature lines carry.

use std::{fmt, str::FromStr};

use base64::{Engine as _, engine::general_purpose::STANDARD};
use ed25519_dalek::{Signature, Signer as _, SigningKey, VerifyingKey};
use sha2::{Digest as _, Sha256};

use super::KeyError;
use crate::merkle::Hash;

/// The first bytes of a digest over name and key: a hint, not an identity.
pub(super) type KeyId = [u8; 4];

/// Kind of a key's signatures, by the number in its text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum KeyKind {
    /// Ed25519 over the text: signed-note, "Signature types".
    Ed25519 = 0x01,
    /// Ed25519 over time and text: tlog-cosignature.
    CosignatureV1 = 0x04,
}

impl KeyKind {
    const fn of(byte: u8) -> Option<Self> {
        match byte {
            0x01 => Some(Self::Ed25519),
            0x04 => Some(Self::CosignatureV1),
            _ => None,
        }
    }
}

/// Public half of a key with its name. Its text is `name+id+key`: the id hexadecimal, kind and key
/// in base64.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VerifierKey {
    name: String,
    kind: KeyKind,
    key: VerifyingKey,
}

impl VerifierKey {
    /// Creates a key from its 32 bytes.
    ///
    /// # Errors
    /// [`KeyError`] for a name that no line can carry, and for bytes that are no key or a weak one.
    pub fn new(name: &str, kind: KeyKind, key: &Hash) -> Result<Self, KeyError> {
        if !is_name(name) {
            return Err(KeyError::Name);
        }
        let key = VerifyingKey::from_bytes(key).ok().filter(|key| !key.is_weak());
        Ok(Self { name: name.to_owned(), kind, key: key.ok_or(KeyError::Key)? })
    }

    /// Returns the name in its signature lines.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the kind of its signatures.
    #[must_use]
    pub const fn kind(&self) -> KeyKind {
        self.kind
    }

    /// Returns the 32 bytes of the public key. One key may have several names and kinds.
    #[must_use]
    pub fn public_key(&self) -> &Hash {
        self.key.as_bytes()
    }

    /// Computes the id: the first four bytes of `SHA-256(name || 0A || kind || key)`.
    pub(super) fn id(&self) -> KeyId {
        let digest = Sha256::new()
            .chain_update(&self.name)
            .chain_update([b'\n', self.kind as u8])
            .chain_update(self.key.as_bytes())
            .finalize();
        [digest[0], digest[1], digest[2], digest[3]]
    }

    pub(super) fn is_signed(&self, message: &[u8], signature: &[u8]) -> bool {
        // The strict way: verifiers disagree about the other signatures.
        Signature::from_slice(signature)
            .is_ok_and(|signature| self.key.verify_strict(message, &signature).is_ok())
    }
}

impl fmt::Display for VerifierKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let key = [&[self.kind as u8][..], self.key.as_bytes()].concat();
        write!(f, "{}+{}+{}", self.name, hex::encode(self.id()), STANDARD.encode(key))
    }
}

impl FromStr for VerifierKey {
    type Err = KeyError;

    fn from_str(text: &str) -> Result<Self, KeyError> {
        // The base64 text may have a plus sign, name and id have none.
        let mut parts = text.trim().splitn(3, '+');
        let (Some(name), Some(id), Some(key)) = (parts.next(), parts.next(), parts.next()) else {
            return Err(KeyError::Form);
        };
        let bytes = STANDARD.decode(key).map_err(|_| KeyError::Form)?;
        let (kind, key) = bytes.split_first().ok_or(KeyError::Form)?;
        let kind = KeyKind::of(*kind).ok_or(KeyError::Kind)?;
        let key = Self::new(name, kind, key.try_into().map_err(|_| KeyError::Key)?)?;
        if hex::encode(key.id()) == id { Ok(key) } else { Err(KeyError::Id) }
    }
}

/// Secret half of a key with its name.
#[derive(Clone)]
pub struct NoteKey {
    verifier: VerifierKey,
    key: SigningKey,
}

impl NoteKey {
    /// Gives a key a name and a kind.
    ///
    /// # Errors
    /// [`KeyError::Name`] for a name that no line can carry.
    pub fn new(name: &str, kind: KeyKind, key: SigningKey) -> Result<Self, KeyError> {
        let verifier = VerifierKey::new(name, kind, key.verifying_key().as_bytes())?;
        Ok(Self { verifier, key })
    }

    /// Returns the public half.
    #[must_use]
    pub const fn verifier(&self) -> &VerifierKey {
        &self.verifier
    }

    pub(super) fn sign(&self, message: &[u8]) -> [u8; 64] {
        self.key.sign(message).to_bytes()
    }
}

impl fmt::Debug for NoteKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("NoteKey").field(&self.verifier.name).finish()
    }
}

/// Returns whether a signature line can carry this name.
pub(super) fn is_name(name: &str) -> bool {
    !name.is_empty() && !name.chars().any(|c| c.is_whitespace() || c.is_control() || c == '+')
}
